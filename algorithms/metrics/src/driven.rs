//! The driven path of a robot: position over time, error from the reference, and turns.

use nalgebra::Point2;

/// Distance from a driven path within which it counts as straight (m): about the radius of a small
/// robot, far below the legs of a zig-zag.
pub const STRAIGHT_WITHIN: f64 = 0.1;

/// Positions of a robot at increasing times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track {
    times: Vec<f64>,
    points: Vec<Point2<f64>>,
}

impl Track {
    /// Adds the position of the robot at a time (s). Values that are not finite, or not later than
    /// the last one, are left out.
    pub fn push(&mut self, time_s: f64, at: Point2<f64>) {
        let later = self.times.last().is_none_or(|&last| time_s > last);
        if later && time_s.is_finite() && at.x.is_finite() && at.y.is_finite() {
            self.times.push(time_s);
            self.points.push(at);
        }
    }

    /// The points, in order of time (m).
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The position of the robot at a time (s), interpolated linearly; before the first point the
    /// first, after the last one the last. `None` without points.
    pub fn at(&self, time_s: f64) -> Option<Point2<f64>> {
        let after = self.times.partition_point(|&t| t <= time_s);
        let Some((&to, &end)) = self.times.get(after).zip(self.points.get(after)) else {
            return self.points.last().copied();
        };
        let Some(before) = after.checked_sub(1) else {
            return Some(end);
        };
        let (from, start) = self.times.get(before).zip(self.points.get(before))?;
        Some(start + (end - start) * ((time_s - from) / (to - from)))
    }

    /// The points from one time to another (s), including the positions at these times.
    pub fn between(&self, from_s: f64, to_s: f64) -> Vec<Point2<f64>> {
        let first = self.times.partition_point(|&t| t <= from_s);
        let last = self.times.partition_point(|&t| t < to_s).max(first);
        let within = self.points.get(first..last).unwrap_or_default();
        let ends = (self.at(from_s), self.at(to_s));
        let mut points = Vec::with_capacity(within.len() + 2);
        points.extend(ends.0);
        points.extend_from_slice(within);
        points.extend(ends.1);
        points
    }

    /// Mean distance (m) between the robot and an unprotected one, at `n` equal steps of time from
    /// `from_s` to `to_s` (s): the driven lap against its `reference` (cat-map patrol paper, Eq.
    /// 11). `None` without points or steps.
    pub fn mae_time(
        &self,
        reference: &crate::path::Polyline<'_>,
        from_s: f64,
        to_s: f64,
        n: usize,
    ) -> Option<f64> {
        let mut sum = 0.0;
        for l in 1..=n {
            let share = l as f64 / n as f64;
            let there = self.at(from_s + (to_s - from_s) * share)?;
            sum += (there - reference.at(share)?).norm();
        }
        (n > 0).then(|| sum / n as f64)
    }
}

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
    use crate::path::Polyline;
    use proptest::prelude::*;

    fn square() -> Vec<Point2<f64>> {
        [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]
            .map(Point2::from)
            .to_vec()
    }

    fn track(offset: f64) -> Track {
        let mut track = Track::default();
        for step in 0..=80_i32 {
            let s = 0.1 * f64::from(step);
            let at = if s <= 4.0 {
                Point2::new(s, offset)
            } else {
                Point2::new(4.0, s - 4.0 + offset)
            };
            track.push(s, at);
        }
        track
    }

    #[test]
    fn a_lap_driven_along_its_reference_has_no_error_and_one_beside_it_the_offset() {
        let reference = square();
        let reference = Polyline::new(&reference);
        assert!(track(0.0).mae_time(&reference, 0.0, 8.0, 120).unwrap() < 1e-12);
        let beside = track(0.25).mae_time(&reference, 0.0, 8.0, 120).unwrap();
        assert!((beside - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_path_with_a_corner_has_three_corners() {
        let driven = track(0.0);
        assert_eq!(corners(driven.points(), STRAIGHT_WITHIN), square());
        assert!(corners(&[], 0.1).is_empty());
        assert_eq!(corners(&square()[..1], 0.1).len(), 1);
    }

    #[test]
    fn places_before_and_after_a_track_are_its_ends() {
        let driven = track(0.0);
        assert_eq!(driven.at(-1.0), Some(Point2::new(0.0, 0.0)));
        assert_eq!(driven.at(99.0), driven.points().last().copied());
        assert_eq!(Track::default().at(0.0), None);
        assert_eq!(driven.between(0.05, 0.25).len(), 4);
    }

    #[test]
    fn points_not_finite_or_not_later_are_left_out() {
        let mut track = Track::default();
        track.push(1.0, Point2::new(0.0, 0.0));
        track.push(1.0, Point2::new(1.0, 0.0));
        track.push(0.5, Point2::new(1.0, 0.0));
        track.push(f64::NAN, Point2::new(1.0, 0.0));
        track.push(2.0, Point2::new(f64::INFINITY, 0.0));
        assert_eq!(track.points().len(), 1);
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
