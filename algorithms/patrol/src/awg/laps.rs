//! Endless laps, waypoint by waypoint.

use chaotic_maps::{AnySource, Source};
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};

use super::{Awg, waypoint};

/// Share of the way to the next waypoint below which a robot is at the last one.
const AT_WAYPOINT: f64 = 1e-6;

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
    /// The first waypoint, until it is returned.
    start: Option<Waypoint>,
}

impl<S: Source> Laps<S> {
    pub(super) fn new(awg: Awg, source: S) -> Self {
        Self {
            start: Some(waypoint(0, 0, WaypointKind::Route, awg.start())),
            awg,
            source,
            lap: 0,
            leg: 0,
            given: 0,
        }
    }

    /// The zig-zag that the waypoints come from.
    pub fn awg(&self) -> &Awg {
        &self.awg
    }

    /// The next waypoint.
    pub fn next_waypoint(&mut self) -> Waypoint {
        if let Some(start) = self.start.take() {
            return start;
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

impl Laps<AnySource> {
    /// The waypoints from a time of a round on (s), with a generator at its beginning: first the place on the
    /// contour, with the number of the waypoint before it, then those that are due later. All have the numbers
    /// and positions that they have in a patrol from the start.
    pub fn from_clock(awg: Awg, source: AnySource, clock_s: f64) -> Self {
        let mut laps = Self::new(awg, source);
        let Some((lap, place)) = laps.awg.place_at(clock_s) else {
            return laps;
        };
        let before = place.leg.waypoints_before + u64::from(place.passed);
        let number = laps.awg.first_of_lap(lap) + before - 1;
        let is_corner = place.passed == 0 && place.share < AT_WAYPOINT;
        if number > 0 || !is_corner {
            let (kind, at) = if is_corner {
                (WaypointKind::Route, place.leg.stretch.segment.from)
            } else {
                (WaypointKind::Transit, place.point())
            };
            laps.start = Some(waypoint(number, lap, kind, at));
        }
        (laps.leg, laps.given) = (place.index, place.passed);
        let before = place.leg.steps_before + u64::from(place.passed);
        let steps = u64::from(lap) * laps.awg.steps_per_lap() + before;
        laps.lap = lap;
        laps.source.advance(steps);
        laps
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
