//! Site of an exit to be guarded: its entries and guard poses.
//!
//! A target has escaped when it comes within a radius of the exit's centre, so it has to pass one
//! of the *entries* on that circle. A guard is in time for an entry e if it has e in its reach
//! before the target can be there. The *lateness* of a guard at q is the maximum over all entries,
//!
//! ```text
//! J(q) = max over e of  (|q − e| − ρ) / s − T(e)
//! ```
//!
//! with its reach ρ, its speed s, and the minimum time T(e) that the targets need to e. The depth
//! of an entry inside the reach counts as time in hand, so that the guard does not stand at the
//! edge of its range. J(q) < 0 means that e lies in the guard's part of a Voronoi diagram of
//! arrival times, for every entry that the targets may choose. The best guard pose has the least J:
//! between the threat and the exit when the targets are near, in the middle of the entries when
//! they are far.

use core::f64::consts::TAU;

use geometry::math;
use nalgebra::{Point2, Vector2};
use planner_view::map::PlannerMap;

/// Number of points on the circle that represent the entries.
const ENTRIES: u32 = 24;

/// Distance between two candidate guard poses (m).
const GUARD_POSE_PITCH: f64 = 0.1;

/// Gap between the bodies of two guards at their guard poses (m).
const GUARD_POSE_GAP: f64 = 0.2;

/// Time that represents "never" (s), small enough to keep differences of a nanosecond.
pub const NEVER_S: f64 = 1.0e6;

/// Surroundings of one exit.
#[derive(Debug, Clone)]
pub struct ExitSite {
    slot: usize,
    exit: Point2<f64>,
    radius: f64,
    robot_radius: f64,
    entries: Vec<Point2<f64>>,
    /// Directions of the entries from the exit's centre (rad).
    bearings: Vec<f64>,
    guard_poses: Vec<Point2<f64>>,
}

impl ExitSite {
    /// Returns the surroundings of an exit (m). A target within `exit_radius` (m) of it has
    /// escaped; guards of `robot_radius` (m) stand within `post_radius` (m) of it. `slot` is the
    /// slot of its paths in the guards' route finders.
    ///
    /// A straight free line connects every entry and guard pose with the exit.
    pub fn new(
        map: &PlannerMap,
        slot: usize,
        exit: Point2<f64>,
        robot_radius: f64,
        exit_radius: f64,
        post_radius: f64,
    ) -> Self {
        let open = |place: &Point2<f64>| map.line_is_clear(exit, *place, robot_radius);
        let mut entries: Vec<_> = (0..ENTRIES)
            .map(|number| {
                let (sin, cos) = math::sincos(f64::from(number) * (TAU / f64::from(ENTRIES)));
                exit + Vector2::new(cos, sin) * exit_radius
            })
            .filter(open)
            .collect();
        if entries.is_empty() {
            entries.push(exit);
        }
        let steps = (post_radius / GUARD_POSE_PITCH).floor() as i32;
        let mut guard_poses: Vec<_> = (-steps..=steps)
            .flat_map(|row| (-steps..=steps).map(move |col| (col, row)))
            .map(|(col, row)| Vector2::new(f64::from(col), f64::from(row)) * GUARD_POSE_PITCH)
            .filter(|offset| offset.norm() <= post_radius)
            .map(|offset| exit + offset)
            .filter(open)
            .collect();
        if guard_poses.is_empty() {
            guard_poses.push(exit);
        }
        let bearings = entries.iter().map(|entry| bearing(entry - exit)).collect();
        Self {
            slot,
            exit,
            radius: exit_radius,
            robot_radius,
            entries,
            bearings,
            guard_poses,
        }
    }

    /// Returns the slot of the exit's paths in a route finder.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// The exit's centre (m).
    pub fn exit(&self) -> Point2<f64> {
        self.exit
    }

    /// Returns the entries of targets (m), never empty.
    pub fn entries(&self) -> &[Point2<f64>] {
        &self.entries
    }

    /// Returns the possible places of a guard (m), never empty.
    pub fn guard_poses(&self) -> &[Point2<f64>] {
        &self.guard_poses
    }

    /// Returns the lengths of the shortest paths from `from` (m) to each entry through no other
    /// entry (m), without obstacles: straight, or by a tangent to the circle of the entries and
    /// along it; 0 inside the circle.
    pub fn approaches(&self, from: Point2<f64>) -> impl Iterator<Item = f64> {
        let line = from - self.exit;
        let far = line.norm();
        let direction = bearing(line);
        let seen = math::acos((self.radius / far).min(1.0));
        let tangent = (far * far - self.radius * self.radius).max(0.0).sqrt();
        let entries = self.entries.iter().zip(&self.bearings);
        entries.map(move |(entry, &ray)| {
            let turn = math::angle_difference(ray, direction).abs();
            if far <= self.radius {
                0.0
            } else if turn <= seen {
                (from - entry).norm()
            } else {
                tangent + self.radius * (turn - seen)
            }
        })
    }

    /// Returns the worst lateness of a guard that is at each entry at these times (s), negative if
    /// early; `times` and `deadlines` (s) are in the order of the entries.
    pub fn lateness(times: &[f64], deadlines: &[f64]) -> f64 {
        times
            .iter()
            .zip(deadlines)
            .map(|(time, deadline)| time - deadline)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the guard pose with the least lateness for a guard of this speed (m/s) and reach
    /// (m). For each entry, `deadlines` are the times at which targets may be there (s), and `covered`
    /// those at which other guards can (s). `others` are the guard poses of the other guards (m).
    ///
    /// Of equal guard poses the one where the guard alone is less late, then the one nearer to the
    /// exit, then the first.
    pub fn best_guard_pose(
        &self,
        speed: f64,
        reach: f64,
        deadlines: &[f64],
        covered: &[f64],
        others: &[Point2<f64>],
    ) -> Point2<f64> {
        let room = 2.0 * self.robot_radius + GUARD_POSE_GAP;
        let mut best = (self.exit, [f64::INFINITY; 3]);
        for &guard_pose in &self.guard_poses {
            if others
                .iter()
                .any(|other| (guard_pose - other).norm() < room)
            {
                continue;
            }
            let (mut alone, mut together) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            for ((&entry, &deadline), &covered) in self.entries.iter().zip(deadlines).zip(covered) {
                let time = straight_time(guard_pose, entry, speed, reach);
                alone = alone.max(time - deadline);
                together = together.max(time.min(covered) - deadline);
            }
            let value = [together, alone, (guard_pose - self.exit).norm()];
            if value.partial_cmp(&best.1) == Some(core::cmp::Ordering::Less) {
                best = (guard_pose, value);
            }
        }
        best.0
    }
}

/// Returns the time at which a guard has a place in its reach (s), driving straight. Negative for a
/// place inside its reach, at most [`NEVER_S`].
pub fn straight_time(from: Point2<f64>, to: Point2<f64>, speed: f64, reach: f64) -> f64 {
    guard_time((to - from).norm(), speed, reach)
}

/// Returns the time at which a guard has a place at this distance (m) in its reach (s), see
/// [`straight_time`].
pub fn guard_time(distance: f64, speed: f64, reach: f64) -> f64 {
    let time = (distance - reach) / speed;
    if speed > 0.0 && !time.is_nan() {
        time.clamp(-NEVER_S, NEVER_S)
    } else {
        NEVER_S
    }
}

/// Direction of a vector (rad).
fn bearing(of: Vector2<f64>) -> f64 {
    math::atan2(of.y, of.x)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    /// An exit of radius 0.5 m in the open, with entries in these directions.
    fn site_with(directions: &[f64]) -> ExitSite {
        let exit = Point2::new(9.0, 0.0);
        let entries: Vec<_> = directions
            .iter()
            .map(|&direction| {
                let (sin, cos) = math::sincos(direction);
                exit + Vector2::new(cos, sin) * 0.5
            })
            .collect();
        let guard_poses = (-10..=10)
            .flat_map(|i| (-10..=10).map(move |j| (i, j)))
            .map(|(i, j)| exit + Vector2::new(f64::from(i), f64::from(j)) * 0.1)
            .collect();
        ExitSite {
            slot: 0,
            exit,
            radius: 0.5,
            robot_radius: 0.1,
            bearings: entries.iter().map(|entry| bearing(entry - exit)).collect(),
            entries,
            guard_poses,
        }
    }

    fn site() -> ExitSite {
        let directions: Vec<_> = (0..24).map(|i| f64::from(i) * TAU / 24.0).collect();
        site_with(&directions)
    }

    fn deadlines(site: &ExitSite, from: Point2<f64>, speed: f64) -> Vec<f64> {
        site.approaches(from).map(|length| length / speed).collect()
    }

    #[test]
    fn a_way_to_the_far_side_goes_round_the_circle() {
        let from = Point2::new(7.0, 0.0);
        let seen = math::acos(0.25);
        let site = site_with(&[PI, 0.0, PI - seen + 1e-9, PI - seen - 1e-9]);
        let lengths: Vec<_> = site.approaches(from).collect();
        assert!((lengths[0] - 1.5).abs() < 1e-12);
        let expected = (4.0_f64 - 0.25).sqrt() + 0.5 * (PI - seen);
        assert!((lengths[1] - expected).abs() < 1e-12);
        // No jump where the entry gets out of sight.
        assert!((lengths[2] - lengths[3]).abs() < 1e-6);
        let inside = site.approaches(Point2::new(9.2, 0.1));
        assert_eq!(inside.collect::<Vec<_>>(), [0.0; 4]);
    }

    #[test]
    fn the_guard_pose_lies_between_a_near_threat_and_the_exit_and_in_the_middle_for_a_far_one() {
        let site = site();
        let never = [NEVER_S; 24];
        for angle in [0.3, 1.8, 2.9, 4.0, 5.5] {
            let (sin, cos) = math::sincos(angle);
            let direction = Vector2::new(cos, sin);
            let from = site.exit() + direction * 1.2;
            let near = deadlines(&site, from, 0.45);
            let guard_pose = site.best_guard_pose(0.3, 0.3, &near, &never, &[]);
            let off = guard_pose - site.exit();
            assert!(off.dot(&direction) > 0.1, "{guard_pose} for {from}");
            assert!(off.dot(&direction) < 1.2);
            let across = off - direction * off.dot(&direction);
            assert!(across.norm() < 0.15, "{guard_pose} for {from}");
        }
        let far = [40.0; 24];
        let guard_pose = site.best_guard_pose(0.3, 0.3, &far, &never, &[]);
        assert!((guard_pose - site.exit()).norm() < 0.05, "{guard_pose}");
    }

    #[test]
    fn the_best_guard_pose_has_the_least_lateness() {
        let site = site();
        let never = [NEVER_S; 24];
        let deadlines = deadlines(&site, Point2::new(7.6, 0.9), 0.6);
        let lateness = |guard_pose: Point2<f64>| {
            let times: Vec<_> = site
                .entries()
                .iter()
                .map(|&entry| straight_time(guard_pose, entry, 0.3, 0.3))
                .collect();
            ExitSite::lateness(&times, &deadlines)
        };
        let best = lateness(site.best_guard_pose(0.3, 0.3, &deadlines, &never, &[]));
        for guard_pose in site.guard_poses() {
            assert!(lateness(*guard_pose) >= best - 1e-12);
        }
    }

    #[test]
    fn a_second_guard_stands_apart_and_helps() {
        let site = site();
        let never = [NEVER_S; 24];
        let far = [20.0; 24];
        let first = site.best_guard_pose(0.3, 0.1, &far, &never, &[]);
        let times = |guard_pose| {
            let entries = site.entries().iter();
            entries
                .map(|e| straight_time(guard_pose, *e, 0.3, 0.1))
                .collect::<Vec<_>>()
        };
        let covered = times(first);
        let second = site.best_guard_pose(0.3, 0.1, &far, &covered, &[first]);
        assert!((second - first).norm() >= 0.4);
        let both: Vec<_> = covered
            .iter()
            .zip(times(second))
            .map(|(a, b)| a.min(b))
            .collect();
        assert!(ExitSite::lateness(&both, &far) <= ExitSite::lateness(&covered, &far));
    }

    #[test]
    fn a_guard_without_speed_has_a_guard_pose() {
        let site = site();
        let never = [NEVER_S; 24];
        for speed in [0.0, f64::NAN] {
            let guard_pose = site.best_guard_pose(speed, 0.3, &[1.0; 24], &never, &[]);
            assert!(guard_pose.x.is_finite());
        }
    }
}
