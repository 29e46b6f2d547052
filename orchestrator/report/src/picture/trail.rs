//! The trail of a robot, in bounded memory and few points.

use geometry::math;

/// Maximum number of points of a trail while a log is read.
const MAX_POINTS: usize = 8192;
/// Minimum distance between two points of a trail (m).
const MIN_STEP: f64 = 0.002;

/// A point of a trail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailPoint {
    /// x (m).
    pub x: f64,
    /// y (m).
    pub y: f64,
    /// Simulated time (s).
    pub time_s: f64,
}

impl TrailPoint {
    fn distance(&self, other: &Self) -> f64 {
        math::hypot(self.x - other.x, self.y - other.y)
    }
}

/// Past positions of a robot, oldest first.
///
/// A trail has a fixed maximum number of points. When it is full, it is simplified to at most half of
/// them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trail {
    points: Vec<TrailPoint>,
    last: Option<TrailPoint>,
}

impl Trail {
    /// Appends a point.
    pub fn push(&mut self, point: TrailPoint) {
        self.last = Some(point);
        let moved = self
            .points
            .last()
            .is_none_or(|last| last.distance(&point) >= MIN_STEP);
        if !moved {
            return;
        }
        let mut tolerance = MIN_STEP;
        while self.points.len() >= MAX_POINTS {
            let simple = simplify(&self.points, tolerance);
            if simple.len() <= MAX_POINTS / 2 {
                self.points = simple;
            }
            tolerance *= 2.0;
        }
        self.points.push(point);
    }

    /// Returns the points, the latest included; none for a robot without states.
    pub fn points(&self) -> Vec<TrailPoint> {
        let mut points = self.points.clone();
        if let Some(last) = self.last
            && points.last() != Some(&last)
        {
            points.push(last);
        }
        points
    }
}

/// Simplifies a line to the points that keep it within `tolerance` (m) of the original
/// (Douglas–Peucker, without recursion).
pub fn simplify(points: &[TrailPoint], tolerance: f64) -> Vec<TrailPoint> {
    let Some(end) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[end] = true;
    let mut open = vec![(0, end)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|i| (i, off_line(&points[i], &points[from], &points[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((at, distance)) = farthest
            && distance > tolerance
        {
            keep[at] = true;
            open.push((from, at));
            open.push((at, to));
        }
    }
    let kept = points.iter().zip(keep).filter(|&(_, keep)| keep);
    kept.map(|(&point, _)| point).collect()
}

/// Returns the distance of a point from the segment between two others (m).
fn off_line(p: &TrailPoint, a: &TrailPoint, b: &TrailPoint) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let (px, py) = (p.x - a.x, p.y - a.y);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 {
        ((px * dx + py * dy) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    math::hypot(px - along * dx, py - along * dy)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point(x: f64, y: f64) -> TrailPoint {
        TrailPoint { x, y, time_s: 0.0 }
    }

    #[test]
    fn a_trail_of_a_million_states_stays_small_and_keeps_both_ends() {
        let mut trail = Trail::default();
        for i in 0..1_000_000 {
            trail.push(point(f64::from(i), 0.0));
        }
        let points = trail.points();
        assert!(points.len() <= MAX_POINTS + 1, "{}", points.len());
        assert_eq!(points[0], point(0.0, 0.0));
        assert_eq!(points[points.len() - 1], point(999_999.0, 0.0));
    }

    #[test]
    fn a_long_trail_keeps_the_corners_of_its_legs() {
        // 1000 legs of 1 m in 40 states each: five times as many states as points.
        let mut trail = Trail::default();
        let corner = |leg: i32| [f64::from(leg % 2), 0.01 * f64::from(leg)];
        for leg in 0..1000 {
            let (from, to) = (corner(leg), corner(leg + 1));
            for step in 0..40 {
                let part = f64::from(step) / 40.0;
                let at = [0, 1].map(|i| from[i] + part * (to[i] - from[i]));
                trail.push(point(at[0], at[1]));
            }
        }
        let points = trail.points();
        assert!(points.len() <= MAX_POINTS + 1);
        for leg in 0..1000 {
            let [x, y] = corner(leg);
            let is_near = |p: &TrailPoint| p.distance(&point(x, y)) < 0.01;
            assert!(points.iter().any(is_near), "corner {leg} is lost");
        }
    }

    #[test]
    fn a_robot_at_rest_adds_one_point() {
        let mut trail = Trail::default();
        for _ in 0..100 {
            trail.push(point(1.0, 2.0));
        }
        assert_eq!(trail.points(), [point(1.0, 2.0)]);
        assert!(Trail::default().points().is_empty());
    }

    #[test]
    fn corners_are_kept_and_points_on_a_straight_line_removed() {
        let line: Vec<_> = (0..=10)
            .map(|i| point(f64::from(i), 0.0))
            .chain((1..=10).map(|i| point(10.0, f64::from(i))))
            .collect();
        let kept = simplify(&line, 0.01);
        assert_eq!(kept, [point(0.0, 0.0), point(10.0, 0.0), point(10.0, 10.0)]);
        assert!(simplify(&[], 0.01).is_empty());
        assert_eq!(simplify(&line[..1], 0.01), line[..1]);
    }

    proptest! {
        #[test]
        fn every_point_stays_within_the_tolerance(
            line in prop::collection::vec((-5.0..5.0, -5.0..5.0), 2..60),
            tolerance in 0.01..2.0,
        ) {
            let line: Vec<_> = line.into_iter().map(|(x, y)| point(x, y)).collect();
            let kept = simplify(&line, tolerance);
            for p in &line {
                let near = kept
                    .windows(2)
                    .map(|w| off_line(p, &w[0], &w[1]))
                    .fold(f64::INFINITY, f64::min);
                prop_assert!(near <= tolerance + 1e-9, "{p:?} is {near} away");
            }
        }
    }
}
