//! Additional waypoints where obstacles are small, fictive obstacles along large ones: the
//! combination that the cat-map patrol paper suggests (§5.2 and §6) without giving a method.
//!
//! Along a large obstacle most additional waypoints are skipped, and the zig-zag with them. The
//! choice is therefore made for each leg, by the share of waypoints that are, or would be, skipped:
//!
//! - *known* obstacles: the share of the zig-zag's area that lies in them, on a fixed lattice, so
//!   that the choice does not depend on the key;
//! - *unknown* ones: the share of the leg's additional waypoints that the robot skipped the last
//!   time. After some laps the leg is tried again: obstacles may disappear.
//!
//! The generator takes its steps on every leg, regardless of the choice: the visited waypoints are
//! those that an ally predicts.

use chaotic_maps::Source;
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, at_least, between, check};
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointOutcome};

use crate::awg::{Awg, Laps, Leg};
use crate::room::square;

/// Minimum number of waypoints for a share.
const MIN_WAYPOINTS: u32 = 3;

/// Method of protection of a leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// By additional waypoints.
    Waypoints,
    /// By fictive obstacles.
    FictiveObstacles,
}

parameters::table! {
    /// Parameters of [`MixedLaps`].
    #[derive(Copy)]
    pub struct MixedParams {
        /// Share of skipped waypoints above which a leg gets fictive obstacles.
        pub dropped_share: f64 [between(0, 1)] = 0.35,
        /// Number of laps after which a leg whose waypoints were unreachable gets them again.
        pub retry_laps: u32 [at_least(1)] = 4,
    }
}

impl Parameters for MixedParams {}

/// Share of a leg's zig-zag inside obstacles, 0 to 1; 0 for a leg without additional waypoints.
///
/// `inside` returns `true` for a point (m) in an obstacle, enlarged by the robot's clearance.
pub fn share_inside(awg: &Awg, leg: &Leg, inside: impl Fn(Point2<f64>) -> bool) -> f64 {
    let (mut found, mut all) = (0_u32, 0_u32);
    for j in 1..=leg.inserted {
        for place in square(leg, leg.nominal(j, awg.v()), awg.params().alpha) {
            all += 1;
            found += u32::from(inside(place));
        }
    }
    f64::from(found) / f64::from(all.max(1))
}

/// Outcomes of a leg's additional waypoints.
#[derive(Debug, Clone, Copy, Default)]
struct Record {
    ended: u32,
    dropped: u32,
    /// The lap from which the leg gets waypoints again.
    retry_from: Option<u32>,
}

/// Endless laps, each leg protected by the suitable method.
#[derive(Debug, Clone)]
pub struct MixedLaps<S> {
    params: MixedParams,
    laps: Laps<S>,
    /// Outcomes by stretch of the first lap.
    records: Vec<Record>,
    /// The leg of the last waypoint and its method.
    chosen: Option<(u32, usize, Method)>,
}

impl<S: Source> MixedLaps<S> {
    /// Creates laps without any outcomes.
    ///
    /// # Errors
    /// [`ParamsError`] naming the parameter that is out of range.
    pub fn new(params: MixedParams, laps: Laps<S>) -> Result<Self, ParamsError> {
        check(&params)?;
        let records = vec![Record::default(); laps.awg().legs(0).len()];
        Ok(Self {
            params,
            laps,
            records,
            chosen: None,
        })
    }

    /// The zig-zag that the waypoints come from.
    pub fn awg(&self) -> &Awg {
        self.laps.awg()
    }

    /// The next waypoint to visit, and the method of protection on the path to it. On legs with
    /// fictive obstacles only the waypoints of the route remain.
    ///
    /// `inside` returns `true` for a point (m) in a known obstacle, enlarged by the robot's
    /// clearance.
    pub fn next_waypoint(&mut self, inside: impl Fn(Point2<f64>) -> bool) -> (Waypoint, Method) {
        loop {
            let waypoint = self.laps.next_waypoint();
            let method = self.method(&waypoint, &inside);
            let skipped =
                waypoint.kind == WaypointKind::Inserted && method == Method::FictiveObstacles;
            if !skipped {
                return (waypoint, method);
            }
        }
    }

    /// Records the outcome of a waypoint.
    pub fn report(&mut self, waypoint: &Waypoint, outcome: WaypointOutcome) {
        if waypoint.kind != WaypointKind::Inserted {
            return;
        }
        let Some((lap, leg)) = self.leg(waypoint) else {
            return;
        };
        let stretch = self.stretch(lap, leg);
        if let Some(record) = self.records.get_mut(stretch) {
            record.ended += 1;
            record.dropped += u32::from(outcome != WaypointOutcome::Reached);
        }
    }

    fn leg(&self, waypoint: &Waypoint) -> Option<(u32, usize)> {
        let (_, leg, _) = self.awg().place(waypoint.number)?;
        Some((waypoint.lap, leg))
    }

    /// Index of the stretch of the first lap that a leg belongs to: on the return the order is
    /// reversed.
    fn stretch(&self, lap: u32, leg: usize) -> usize {
        let awg = self.laps.awg();
        let ahead = core::ptr::eq(awg.legs(lap), awg.legs(0));
        if ahead {
            leg
        } else {
            self.records.len().saturating_sub(leg + 1)
        }
    }

    fn method(&mut self, waypoint: &Waypoint, inside: impl Fn(Point2<f64>) -> bool) -> Method {
        let Some((lap, leg)) = self.leg(waypoint) else {
            return Method::Waypoints;
        };
        if let Some((of_lap, of_leg, method)) = self.chosen
            && (of_lap, of_leg) == (lap, leg)
        {
            return method;
        }
        let method = self.choose(lap, leg, inside);
        self.chosen = Some((lap, leg, method));
        method
    }

    fn choose(&mut self, lap: u32, leg: usize, inside: impl Fn(Point2<f64>) -> bool) -> Method {
        let stretch = self.stretch(lap, leg);
        let awg = self.laps.awg();
        let (Some(leg), Some(record)) = (awg.legs(lap).get(leg), self.records.get_mut(stretch))
        else {
            return Method::Waypoints;
        };
        if leg.inserted == 0 {
            return Method::Waypoints;
        }
        if share_inside(awg, leg, inside) > self.params.dropped_share {
            return Method::FictiveObstacles;
        }
        if let Some(retry_from) = record.retry_from {
            if lap < retry_from {
                return Method::FictiveObstacles;
            }
            *record = Record::default();
        }
        let share = f64::from(record.dropped) / f64::from(record.ended.max(1));
        let enough = record.ended >= MIN_WAYPOINTS.min(leg.inserted);
        let failed = enough && share > self.params.dropped_share;
        *record = Record::default();
        if failed {
            record.retry_from = Some(lap.saturating_add(self.params.retry_laps));
            return Method::FictiveObstacles;
        }
        Method::Waypoints
    }
}

#[cfg(test)]
mod tests;
