//! The turns of a driven path.

use nalgebra::Point2;

/// Distance from a driven path within which it counts as straight (m): about the radius of a small
/// robot, far below the legs of a zig-zag.
pub const STRAIGHT_WITHIN: f64 = 0.1;

/// The corners of a path: the smallest set of its points whose polyline stays within `tolerance` (m)
/// of the path (Ramer 1972, Douglas and Peucker 1973). First and last point are always included.
pub fn corners(path: &[Point2<f64>], tolerance: f64) -> Vec<Point2<f64>> {
    let Some(end) = path.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut keep = vec![false; path.len()];
    let mut open = vec![(0, end)];
    for index in [0, end] {
        if let Some(kept) = keep.get_mut(index) {
            *kept = true;
        }
    }
    while let Some((first, last)) = open.pop() {
        let (Some(&a), Some(&b)) = (path.get(first), path.get(last)) else {
            continue;
        };
        let mut farthest = (0.0, first);
        for (index, p) in path.iter().enumerate().take(last).skip(first + 1) {
            let distance = from_segment(*p, a, b);
            if distance > farthest.0 {
                farthest = (distance, index);
            }
        }
        let (distance, index) = farthest;
        if distance > tolerance {
            if let Some(kept) = keep.get_mut(index) {
                *kept = true;
            }
            open.extend([(first, index), (index, last)]);
        }
    }
    let kept = path.iter().zip(&keep).filter(|(_, keep)| **keep);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of a point from a segment (m).
fn from_segment(p: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (along, to) = (b - a, p - a);
    let squared = along.norm_squared();
    let part = if squared > 0.0 {
        (to.dot(&along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to - along * part).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square() -> Vec<Point2<f64>> {
        [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]
            .map(Point2::from)
            .to_vec()
    }

    #[test]
    fn a_path_with_a_corner_has_three_corners() {
        let driven: Vec<_> = (0..=80)
            .map(|step| {
                let s = 0.1 * f64::from(step);
                Point2::new(s.min(4.0), (s - 4.0).max(0.0))
            })
            .collect();
        assert_eq!(corners(&driven, STRAIGHT_WITHIN), square());
        assert!(corners(&[], 0.1).is_empty());
        assert_eq!(corners(&square()[..1], 0.1).len(), 1);
    }

    proptest! {
        #[test]
        fn a_path_stays_near_its_corners(
            coordinates in prop::collection::vec((-5.0..5.0, -5.0..5.0), 2..60),
            tolerance in 0.01..2.0,
        ) {
            let path: Vec<_> = coordinates.iter().map(|&(x, y)| Point2::new(x, y)).collect();
            let kept = corners(&path, tolerance);
            prop_assert_eq!(kept.first(), path.first());
            prop_assert_eq!(kept.last(), path.last());
            for p in &path {
                let near = kept
                    .windows(2)
                    .any(|leg| from_segment(*p, leg[0], leg[1]) <= tolerance + 1e-12);
                prop_assert!(near);
            }
        }
    }
}
