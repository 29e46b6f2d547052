//! Laps without end, waypoint by waypoint.

use chaotic_maps::Source;
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};

use super::{Awg, waypoint};

/// All waypoints of a patrol, one after the other; never ends.
///
/// The first is the start of the contour, number 0. The generator goes on over segments and laps,
/// so that no two laps are alike.
#[derive(Debug, Clone)]
pub struct Laps<S> {
    awg: Awg,
    source: S,
    lap: u32,
    leg: usize,
    /// Waypoints of the leg that have been given out.
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

    /// What the waypoints come from.
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
            // A contour has a segment, and so has a lap a leg.
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

    /// The next waypoint that is not an additional one inside an obstacle that the robot knows
    /// (paper, end of §4); those left out on the way are appended to `dropped`. The generator takes
    /// their steps all the same, so that who has the key but not the map foresees the others.
    ///
    /// `inside` tells whether a point (m) lies in an obstacle, enlarged as the robot wants it.
    pub fn next_outside(
        &mut self,
        inside: impl Fn(Point2<f64>) -> bool,
        dropped: &mut Vec<Waypoint>,
    ) -> Waypoint {
        loop {
            let waypoint = self.next_waypoint();
            // Waypoints of the route are never left out, so that this ends.
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
