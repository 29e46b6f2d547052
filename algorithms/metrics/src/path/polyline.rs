//! Points along a polyline, by length.

use nalgebra::Point2;

/// A polyline with the length covered up to each of its points.
#[derive(Debug, Clone)]
pub struct Polyline<'a> {
    points: &'a [Point2<f64>],
    covered: Vec<f64>,
}

impl<'a> Polyline<'a> {
    /// Creates a polyline through points (m); points may repeat.
    pub fn new(points: &'a [Point2<f64>]) -> Self {
        let mut sum = 0.0;
        let mut covered = Vec::with_capacity(points.len());
        for (i, point) in points.iter().enumerate() {
            if i > 0 {
                sum += (point - points[i - 1]).norm();
            }
            covered.push(sum);
        }
        Self { points, covered }
    }

    /// Length from the first point to the last (m).
    pub fn length(&self) -> f64 {
        self.covered.last().copied().unwrap_or(0.0)
    }

    /// The point S(share) that divides the length in this ratio; shares below 0 and above 1 are the
    /// ends. `None` without points or for NaN.
    pub fn at(&self, share: f64) -> Option<Point2<f64>> {
        if share.is_nan() {
            return None;
        }
        let wanted = share.clamp(0.0, 1.0) * self.length();
        // The first point at or beyond that length.
        let next = self.covered.partition_point(|&covered| covered < wanted);
        let (Some(&end), Some(&reached)) = (self.points.get(next), self.covered.get(next)) else {
            return self.points.last().copied();
        };
        let Some(previous) = next.checked_sub(1) else {
            return Some(end);
        };
        let (start, before) = (self.points[previous], self.covered[previous]);
        let along = (wanted - before) / (reached - before);
        Some(start + (end - start) * along)
    }
}
