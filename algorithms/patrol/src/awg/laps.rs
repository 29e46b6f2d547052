//! Endless laps, waypoint by waypoint.

use chaotic_maps::Source;
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};

use super::{Awg, waypoint};

/// All waypoints of a patrol in order; never ends.
///
/// The first is the start of the contour, number 0. The generator continues over segments and laps,
/// so that no two laps are alike.
#[derive(Debug, Clone)]
pub struct Laps<S> {
    awg: Awg,
    source: S,
    lap: u32,
    leg: usize,
    /// Number of waypoints of the leg returned so far.
    given: u32,
    started: bool,
}

impl<S: Source> Laps<S> {
    pub(super) fn new(awg: Awg, source: S) -> Self {
        Self {
            awg,
            source,
            lap: 0,
            leg: 0,
            given: 0,
            started: false,
        }
    }

    /// The zig-zag that the waypoints come from.
    pub fn awg(&self) -> &Awg {
        &self.awg
    }

    /// The next waypoint.
    pub fn next_waypoint(&mut self) -> Waypoint {
        if !self.started {
            self.started = true;
            let start = self.awg.start();
            return waypoint(0, 0, WaypointKind::Route, start);
        }
        let legs = self.awg.legs(self.lap);
        if self.leg >= legs.len() {
            // Laps beyond the 136 years of one per second all count as the last.
            self.lap = self.lap.saturating_add(1);
            self.leg = 0;
        }
        let Some(&leg) = self.awg.legs(self.lap).get(self.leg) else {
            // A contour has at least one segment, and a lap at least one leg.
            return waypoint(0, self.lap, WaypointKind::Route, self.awg.start());
        };
        self.given += 1;
        let waypoint = self
            .awg
            .waypoint_of_leg(self.lap, &leg, self.given, &mut self.source);
        if waypoint.kind == WaypointKind::Route {
            self.given = 0;
            self.leg += 1;
        }
        waypoint
    }

    /// The next waypoint that is not an additional one inside a known obstacle (paper, end of §4);
    /// the skipped ones are appended to `dropped`. The generator takes their steps as well, so that
    /// an ally with the key but without the map can compute the others.
    ///
    /// `inside` returns `true` for a point (m) in an obstacle, enlarged by the robot's clearance.
    pub fn next_outside(
        &mut self,
        inside: impl Fn(Point2<f64>) -> bool,
        dropped: &mut Vec<Waypoint>,
    ) -> Waypoint {
        loop {
            let waypoint = self.next_waypoint();
            // Waypoints of the route are never skipped, so the loop ends.
            if waypoint.kind != WaypointKind::Inserted || !inside(waypoint.point) {
                return waypoint;
            }
            dropped.push(waypoint);
        }
    }
}

impl<S: Source> Iterator for Laps<S> {
    type Item = Waypoint;

    fn next(&mut self) -> Option<Waypoint> {
        Some(self.next_waypoint())
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (usize::MAX, None)
    }
}
