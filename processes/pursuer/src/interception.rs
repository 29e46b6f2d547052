//! First place at which a pursuer can meet its target.
//!
//! A place p is a *meeting* if the pursuer gets within its reach ρ of p no later than the target is
//! there. The result is the earliest meeting on the target's predicted course.
//!
//! **In line of sight** the course is the target's present velocity V, from its place r relative to
//! the pursuer. A pursuer of speed s that drives straight can be within ρ of the target at time t if
//!
//! ```text
//! |r + V t| ≤ s t + ρ,    first at    t = c / (√(b² − a c) − b)
//! a = |V|² − s²    b = r·V − s ρ    c = |r|² − ρ²
//! ```
//!
//! There is none if the root is not real or the denominator not positive. For ρ = 0, the places
//! r + V t over all directions of V are the Apollonius circle of the two speeds (R. Isaacs,
//! *Differential Games*, 1965, §6.7), and driving there is lead pursuit, also known as parallel
//! navigation. The formula counts only if both courses are free.
//!
//! **Out of sight**, or without such a meeting, the course is the target's shortest path to the
//! nearest exit along the streets, driven at its highest speed. The pursuer's time to a place is that
//! of its own shortest path there, less ρ.

use nalgebra::{Point2, Vector2};
use navigation::routes::RouteFinder;
use planner_view::map::PlannerMap;
use planner_view::view::RobotView;

use crate::slots;

/// Speeds below this (m/s) count as standstill.
const STILL: f64 = 1.0e-3;

/// Place and time at which a pursuer meets its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Position of the target then (m).
    pub at: Point2<f64>,
    /// Time from now on (s), ≥ 0.
    pub time_s: f64,
}

/// Known or assumed state of a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Position (m).
    pub at: Point2<f64>,
    /// Current velocity, world frame (m/s).
    pub velocity: Vector2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
}

/// Returns the earliest meeting of a pursuer at `from` (m) with `speed` (m/s) and `reach` (m) with
/// a target that keeps its velocity, without obstacles; `None` if there is none.
pub fn meet_straight(
    from: Point2<f64>,
    speed: f64,
    reach: f64,
    target: &Target,
) -> Option<Meeting> {
    let (line, velocity) = (target.at - from, target.velocity);
    let a = velocity.norm_squared() - speed * speed;
    let b = line.dot(&velocity) - speed * reach;
    let c = line.norm_squared() - reach * reach;
    if c <= 0.0 {
        return Some(Meeting {
            at: target.at,
            time_s: 0.0,
        });
    }
    let root = (b * b - a * c).sqrt();
    let time_s = c / (root - b);
    // Also rejects the NaN of a root that is not real and non-finite numbers.
    (root - b > 0.0 && time_s.is_finite()).then(|| Meeting {
        at: target.at + velocity * time_s,
        time_s,
    })
}

/// Returns the earliest meeting on a path of places (m) with the target's times there (s). `arrival`
/// returns the time until the pursuer is within its reach of a place (s). `None` if it is late
/// everywhere.
///
/// Both times are linear between two places of the path.
pub fn meet_on_way(
    way: &[(Point2<f64>, f64)],
    arrival: impl Fn(Point2<f64>) -> Option<f64>,
) -> Option<Meeting> {
    let mut before: Option<(Point2<f64>, f64, f64)> = None;
    for &(at, passed) in way {
        let Some(arrival) = arrival(at) else {
            before = None;
            continue;
        };
        let late = arrival - passed;
        if late <= 0.0 {
            let Some((from, since, lateness)) = before.filter(|b| b.2.is_finite()) else {
                // A target that stays here is met on arrival.
                let time_s = if passed.is_finite() { passed } else { arrival };
                return Some(Meeting { at, time_s });
            };
            let share = lateness / (lateness - late);
            return Some(Meeting {
                at: from + (at - from) * share,
                time_s: since + (passed - since) * share,
            });
        }
        before = Some((at, passed, late));
    }
    None
}

/// Predicts paths and finds meetings, for the robot of the given route finder.
#[derive(Debug, Clone, Default)]
pub struct Interceptor {
    reach: f64,
    way: Vec<(Point2<f64>, f64)>,
}

impl Interceptor {
    /// Returns an interceptor for which a target within `reach` (m) is met.
    pub fn new(reach: f64) -> Self {
        Self {
            reach,
            way: Vec::new(),
        }
    }

    /// Returns the earliest meeting of `own` with a target that runs for one of `exits` (m); `None`
    /// if `own` is late everywhere.
    ///
    /// `finder` must have been prepared for the map.
    pub fn meeting(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        own: &RobotView,
        exits: impl IntoIterator<Item = Point2<f64>>,
        target: &Target,
    ) -> Option<Meeting> {
        self.in_sight(map, own, target).or_else(|| {
            self.predict(map, finder, exits, target.at, target.v_max);
            let here = own.pose.position();
            let places = self.way.iter().map(|&(place, _)| place);
            let routes = finder.lengths(map, slots::ARRIVAL, here, places)?;
            meet_on_way(&self.way, |place| {
                Some(self.time_for(routes.distance_to(place)?, own))
            })
        })
    }

    /// Returns the time after which a pursuer is within its reach of a place at this driving
    /// distance (m), from now on (s).
    pub fn time_for(&self, distance: f64, pursuer: &RobotView) -> f64 {
        (distance - self.reach).max(0.0) / pursuer.v_max
    }

    /// Returns the straight meeting, if the pursuer sees the target and both courses are free.
    fn in_sight(&self, map: &PlannerMap, own: &RobotView, target: &Target) -> Option<Meeting> {
        let here = own.pose.position();
        if !map.line_is_clear(here, target.at, 0.0) {
            return None;
        }
        let meeting = meet_straight(here, own.v_max, self.reach, target)?;
        let free = map.line_is_clear(target.at, meeting.at, 0.0)
            && map.line_is_clear(here, meeting.at, 0.0);
        free.then_some(meeting)
    }

    /// Returns the shortest path of a target at `at` (m) to its nearest exit: places (m) with its
    /// times there (s) at its highest speed `v_max` (m/s). Without a path or speed, the target
    /// stays.
    ///
    /// `finder` must have been prepared for the map.
    pub fn predict(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        exits: impl IntoIterator<Item = Point2<f64>>,
        at: Point2<f64>,
        v_max: f64,
    ) -> &[(Point2<f64>, f64)] {
        self.way.clear();
        if v_max >= STILL {
            let mut nearest: Option<(f64, usize, Point2<f64>)> = None;
            for (number, exit) in exits.into_iter().take(slots::MAX_EXITS).enumerate() {
                let slot = slots::EXITS + number;
                let length = finder
                    .routes(map, slot, exit, [at])
                    .and_then(|routes| routes.distance_to(at));
                if let Some(length) = length
                    && nearest.is_none_or(|found| length < found.0)
                {
                    nearest = Some((length, slot, exit));
                }
            }
            if let Some((_, slot, exit)) = nearest
                && let Some(routes) = finder.routes(map, slot, exit, [at])
            {
                routes.way_to(at, &mut self.way);
            }
        }
        // The root of the tree is the exit; the target drives towards it.
        let whole = self.way.last().map_or(0.0, |last| last.1);
        self.way.reverse();
        for (_, length) in &mut self.way {
            *length = (whole - *length) / v_max;
        }
        match self.way.first_mut() {
            Some(first) => first.0 = at,
            None => self.way.push((at, f64::INFINITY)),
        }
        &self.way
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn target(x: f64, y: f64, vx: f64, vy: f64) -> Target {
        Target {
            at: Point2::new(x, y),
            velocity: Vector2::new(vx, vy),
            v_max: 1.0,
        }
    }

    /// Returns the time after which a pursuer that always drives at its target gets within `reach`
    /// (s), if within `limit`.
    fn pure_chase(speed: f64, reach: f64, target: &Target, limit: f64) -> Option<f64> {
        let (mut from, mut at) = (Point2::origin(), target.at);
        let dt = 0.002;
        let mut time = 0.0;
        while time < limit {
            let line = at - from;
            if line.norm() <= reach {
                return Some(time);
            }
            from += line / line.norm() * speed * dt;
            at += target.velocity * dt;
            time += dt;
        }
        None
    }

    #[test]
    fn a_target_that_stands_is_met_where_it_is() {
        let meeting = meet_straight(Point2::origin(), 0.5, 0.3, &target(3.0, 4.0, 0.0, 0.0));
        let meeting = meeting.unwrap();
        assert!((meeting.at - Point2::new(3.0, 4.0)).norm() < 1e-12);
        assert!((meeting.time_s - 4.7 / 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_faster_target_is_met_only_if_it_comes_by() {
        let from = Point2::origin();
        // The target passes at 1 m: the pursuer just meets it at the angle whose sine is the ratio
        // of the speeds.
        assert!(meet_straight(from, 0.5, 0.0, &target(-2.0, 1.0, 1.0, 0.0)).is_some());
        assert!(meet_straight(from, 0.5, 0.0, &target(0.0, 1.0, 1.0, 0.0)).is_none());
        assert!(meet_straight(from, 0.5, 0.0, &target(2.0, 0.0, 1.0, 0.0)).is_none());
        // Equal speeds: a meeting half-way if head-on, none if the target drives away.
        let half_way = meet_straight(from, 1.0, 0.0, &target(4.0, 0.0, -1.0, 0.0)).unwrap();
        assert!((half_way.at.x - 2.0).abs() < 1e-12);
        assert!(meet_straight(from, 1.0, 0.0, &target(4.0, 0.0, 1.0, 0.0)).is_none());
    }

    #[test]
    fn a_target_within_reach_is_met_now_and_strange_numbers_meet_no_target() {
        let now = meet_straight(Point2::origin(), 0.0, 0.3, &target(0.2, 0.0, 9.0, 0.0));
        assert_eq!(now.unwrap().time_s, 0.0);
        for strange in [f64::NAN, f64::INFINITY] {
            let from = Point2::origin();
            assert!(meet_straight(from, 0.3, 0.0, &target(strange, 0.0, 0.0, 0.0)).is_none());
            assert!(meet_straight(from, 0.3, 0.0, &target(1.0, 0.0, strange, 0.0)).is_none());
        }
        let nan = meet_straight(Point2::origin(), f64::NAN, 0.3, &target(1.0, 0.0, 0.1, 0.0));
        assert!(nan.is_none());
    }

    #[test]
    fn on_a_way_the_meeting_lies_where_both_are_there_at_once() {
        // The target drives along x at 1 m/s, the pursuer waits at x = 5 and drives at 0.5 m/s.
        let way: Vec<_> = (0..=10)
            .map(|i| (Point2::new(f64::from(i), 0.0), f64::from(i)))
            .collect();
        let meeting = meet_on_way(&way, |p| Some((p.x - 5.0).abs() / 0.5)).unwrap();
        assert!((meeting.at.x - 10.0 / 3.0).abs() < 1e-12);
        assert!((meeting.time_s - 10.0 / 3.0).abs() < 1e-12);
        assert_eq!(meet_on_way(&way, |p| Some(100.0 + p.x)), None);
        assert_eq!(meet_on_way(&way, |_| None), None);
        assert_eq!(meet_on_way(&way, |_| Some(f64::NAN)), None);
        // A place without a path to it is left out.
        let gap = meet_on_way(&way, |p| (p.x > 4.5).then_some((p.x - 5.0).abs())).unwrap();
        assert_eq!((gap.at.x, gap.time_s), (5.0, 5.0));
    }

    #[test]
    fn a_target_that_stays_is_met_on_arrival() {
        let stays = [(Point2::new(1.0, 1.0), f64::INFINITY)];
        let meeting = meet_on_way(&stays, |_| Some(7.0)).unwrap();
        assert_eq!(meeting.time_s, 7.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn both_are_at_the_meeting_in_time_and_nowhere_earlier(
            x in -8.0_f64..8.0,
            y in -8.0_f64..8.0,
            vx in -1.0_f64..1.0,
            vy in -1.0_f64..1.0,
            speed in 0.1_f64..1.0,
            reach in 0.0_f64..0.5,
        ) {
            let target = target(x, y, vx, vy);
            let from = Point2::origin();
            let lag = |t: f64| (target.at + target.velocity * t - from).norm() - reach - speed * t;
            match meet_straight(from, speed, reach, &target) {
                Some(meeting) => {
                    let there = target.at + target.velocity * meeting.time_s;
                    prop_assert!((there - meeting.at).norm() < 1e-9);
                    prop_assert!(lag(meeting.time_s).abs() < 1e-6 * (1.0 + meeting.time_s) || meeting.time_s == 0.0);
                    // Within reach from the start, or not before.
                    for share in 0..100 {
                        let t = meeting.time_s * f64::from(share) / 100.0;
                        let not_yet = lag(t) > -1e-6 * (1.0 + t);
                        prop_assert!(not_yet || meeting.time_s == 0.0, "{t} of {meeting:?}");
                    }
                }
                None => {
                    for t in 0..1000 {
                        prop_assert!(lag(f64::from(t) * 0.1) > 0.0);
                    }
                }
            }
        }

        #[test]
        fn a_pure_chase_is_never_earlier(
            x in 0.5_f64..5.0,
            y in -5.0_f64..5.0,
            angle in 0.0_f64..core::f64::consts::TAU,
            ratio in 0.0_f64..1.5,
        ) {
            let speed = 0.5;
            let (sin, cos) = geometry::math::sincos(angle);
            let target = target(x, y, ratio * speed * cos, ratio * speed * sin);
            if let Some(chased) = pure_chase(speed, 0.3, &target, 60.0) {
                let meeting = meet_straight(Point2::origin(), speed, 0.3, &target);
                let time = meeting.map(|meeting| meeting.time_s);
                prop_assert!(time.is_some_and(|time| time <= chased + 0.01), "{time:?} {chased}");
            }
        }
    }
}
