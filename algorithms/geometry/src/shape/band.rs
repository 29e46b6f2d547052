//! Extent of a convex piece within a band along an axis.

use super::Convex;

impl Convex {
    /// Minimum and maximum coordinate across `axis` (0: x, 1: y) of the part of the piece whose
    /// coordinate along `axis` lies between `low` and `high` (m), ends included. For axis 1 this is
    /// the extent of the piece along x between two heights. `None` if no part of it lies there.
    pub fn extent_in_band(&self, axis: usize, low: f64, high: f64) -> Option<(f64, f64)> {
        let across = 1 - axis.min(1);
        let axis = 1 - across;
        match self {
            Self::Disc { center, radius } => {
                let off = (low - center[axis]).max(center[axis] - high).max(0.0);
                let half = (radius * radius - off * off).sqrt();
                // A root of a negative number is NaN: the band misses the disc.
                (low <= high && half >= 0.0).then(|| (center[across] - half, center[across] + half))
            }
            Self::Box(aabb) => (low <= high && aabb.min[axis] <= high && aabb.max[axis] >= low)
                .then(|| (aabb.min[across], aabb.max[across])),
            Self::Polygon(edges) => {
                let mut extent: Option<(f64, f64)> = None;
                for edge in edges {
                    let (start, end) = (edge.start, edge.start + edge.along * edge.length);
                    let rise = end[axis] - start[axis];
                    let at = |level: f64| ((level - start[axis]) / rise).clamp(0.0, 1.0);
                    if start[axis].min(end[axis]) > high || start[axis].max(end[axis]) < low {
                        continue;
                    }
                    let ends = if rise == 0.0 {
                        [0.0, 1.0]
                    } else {
                        [at(low), at(high)]
                    };
                    for part in ends {
                        let value = start[across] + (end[across] - start[across]) * part;
                        let (least, most) = extent.unwrap_or((value, value));
                        extent = Some((least.min(value), most.max(value)));
                    }
                }
                extent.filter(|_| low <= high)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;

    #[test]
    fn a_band_cuts_discs_boxes_and_polygons() {
        let disc = Convex::disc(Point2::new(1.0, 2.0), 0.5);
        assert_eq!(disc.extent_in_band(1, 1.9, 2.1), Some((0.5, 1.5)));
        let (low, high) = disc.extent_in_band(1, 2.3, 9.0).unwrap();
        assert!((low - 0.6).abs() < 1e-12 && (high - 1.4).abs() < 1e-12);
        assert_eq!(disc.extent_in_band(1, 2.6, 3.0), None);
        let rectangle = Convex::rectangle(Point2::new(0.0, 0.0), [1.0, 2.0], 0.0);
        assert_eq!(rectangle.extent_in_band(1, -9.0, 9.0), Some((-1.0, 1.0)));
        assert_eq!(rectangle.extent_in_band(0, 1.0, 1.0), Some((-2.0, 2.0)));
        assert_eq!(rectangle.extent_in_band(0, 1.1, 1.2), None);
        let triangle = Convex::polygon(&[
            Point2::new(0.0, 0.0),
            Point2::new(4.0, 0.0),
            Point2::new(0.0, 4.0),
        ]);
        assert_eq!(triangle.extent_in_band(1, 1.0, 2.0), Some((0.0, 3.0)));
        assert_eq!(triangle.extent_in_band(1, 0.0, 0.0), Some((0.0, 4.0)));
        assert_eq!(triangle.extent_in_band(0, 3.0, 9.0), Some((0.0, 1.0)));
        assert_eq!(triangle.extent_in_band(1, 4.5, 5.0), None);
        assert_eq!(triangle.extent_in_band(1, 2.0, 1.0), None);
    }
}
