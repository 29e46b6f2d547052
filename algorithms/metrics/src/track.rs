//! Positions over time: of a robot that drove, or of a lap in the time of its patrol.

use nalgebra::Point2;

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

    /// Time of the first point and of the last (s); `None` without points.
    pub fn span(&self) -> Option<[f64; 2]> {
        Some([*self.times.first()?, *self.times.last()?])
    }

    /// The same points in the opposite order, from time 0.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let end_s = self.times.last().copied().unwrap_or(0.0);
        Self {
            times: self
                .times
                .iter()
                .rev()
                .map(|time_s| end_s - time_s)
                .collect(),
            points: self.points.iter().rev().copied().collect(),
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
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
