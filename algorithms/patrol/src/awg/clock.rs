//! The clock of the waypoints: due times, and the place of an unprotected patrol at a time.

use nalgebra::{Point2, Vector2};

use super::{Awg, Leg};
use crate::contour::Contour;

/// A place of an unprotected patrol on the clock of the waypoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place<'a> {
    /// Its leg.
    pub leg: &'a Leg,
    /// Index of the leg in [`Awg::legs`].
    pub index: usize,
    /// Waypoints of the leg behind it: fewer than [`Leg::waypoints`].
    pub passed: u32,
    /// Share of the time from the last waypoint to the next one, 0 to 1.
    pub share: f64,
}

impl Place<'_> {
    /// Its position on the contour (m).
    pub fn point(&self) -> Point2<f64> {
        let segment = &self.leg.stretch.segment;
        let share = (f64::from(self.passed) + self.share) / self.leg.waypoints() as f64;
        segment.from + segment.along * (segment.length * share)
    }
}

impl Awg {
    /// Time between two waypoints of a leg (s), if all are visited in time:
    /// [`Leg::seconds_per_waypoint`], the paper's, unless the clock runs faster
    /// ([`Self::with_tempo`]).
    pub fn seconds_per_waypoint(&self, leg: &Leg) -> f64 {
        self.tempo * leg.seconds_per_waypoint(self.v)
    }

    /// Time of a whole leg (s), if all its waypoints are visited in time.
    pub(crate) fn leg_seconds(&self, leg: &Leg) -> f64 {
        self.seconds_per_waypoint(leg) * leg.waypoints() as f64
    }

    /// Time of a lap on the waypoint clock (s), the same for all laps.
    pub fn lap_time(&self) -> f64 {
        self.forward.iter().map(|leg| self.leg_seconds(leg)).sum()
    }

    /// Due time of a waypoint by that clock (s); the start, number 0, is due at 0.
    pub fn due_s(&self, number: u64) -> f64 {
        let Some((lap, index, j)) = self.place(number) else {
            return 0.0;
        };
        let legs = self.legs((lap % 2) as u32);
        let before = legs.iter().take(index);
        let begun: f64 = before.map(|leg| self.leg_seconds(leg)).sum();
        let within = legs
            .get(index)
            .map_or(0.0, |leg| self.seconds_per_waypoint(leg) * f64::from(j));
        lap as f64 * self.lap_time() + begun + within
    }

    /// Time until an unprotected patrol returns to its start in the same direction (s): a lap, or two of an
    /// open contour.
    pub fn round_s(&self) -> f64 {
        let laps = if self.backward.is_empty() { 1.0 } else { 2.0 };
        laps * self.lap_time()
    }

    /// The place at a time after the start of a lap (s), of at most [`Self::lap_time`].
    pub(crate) fn place_in_lap(&self, lap: u32, time_s: f64) -> Option<Place<'_>> {
        let mut begun = 0.0;
        let mut found: Option<(usize, &Leg, f64)> = None;
        for (index, leg) in self.legs(lap).iter().enumerate() {
            if time_s >= begun {
                found = Some((index, leg, begun));
            }
            begun += self.leg_seconds(leg);
        }
        let (index, leg, begun) = found?;
        let waypoints = (time_s - begun) / self.seconds_per_waypoint(leg);
        let passed = waypoints.floor().min((leg.waypoints() - 1) as f64);
        Some(Place {
            leg,
            index,
            passed: passed as u32,
            share: (waypoints - passed).clamp(0.0, 1.0),
        })
    }

    /// The place of an unprotected patrol at a time of a round (s), and its lap: 0, or 1 on the return of an
    /// open contour.
    pub(crate) fn place_at(&self, clock_s: f64) -> Option<(u32, Place<'_>)> {
        let clock_s = clock_s.rem_euclid(self.round_s());
        let lap = u32::from(clock_s >= self.lap_time());
        let within = clock_s - f64::from(lap) * self.lap_time();
        Some((lap, self.place_in_lap(lap, within.max(0.0))?))
    }

    /// The position of an unprotected patrol at a time of a round (s); the start for a time that is not finite
    /// (m).
    pub fn nominal_at(&self, clock_s: f64) -> Point2<f64> {
        self.place_at(clock_s)
            .map_or(self.start, |(_, place)| place.point())
    }

    /// The time of a round (s) at which an unprotected patrol is nearest to a point (m). Of an open contour only
    /// the legs count that lead in the direction of the heading (rad).
    pub fn nearest_s(&self, at: Point2<f64>, heading: f64) -> f64 {
        let (sin, cos) = geometry::math::sincos(heading);
        let ahead = Vector2::new(cos, sin);
        let (mut least, mut nearest_s, mut begun) = (f64::INFINITY, 0.0, 0.0);
        for leg in self.forward.iter().chain(&self.backward) {
            let segment = &leg.stretch.segment;
            let seconds = self.leg_seconds(leg);
            let along = (at - segment.from).dot(&segment.along);
            let share = (along / segment.length).clamp(0.0, 1.0);
            let foot = segment.from + segment.along * (segment.length * share);
            let distance = (at - foot).norm();
            let leads = self.backward.is_empty() || segment.along.dot(&ahead) >= 0.0;
            if leads && distance < least {
                (least, nearest_s) = (distance, begun + seconds * share);
            }
            begun += seconds;
        }
        nearest_s.rem_euclid(self.round_s())
    }

    /// Time of a round at which the waypoint of the contour with this index is due (s); 0 for an index that it
    /// does not have.
    pub fn corner_s(&self, contour: &Contour, index: usize) -> f64 {
        let (mut next, mut begun) = (0, 0.0);
        for leg in &self.forward {
            // Between the waypoints of the contour, legs also end at the borders of danger zones.
            if contour.points().get(next) == Some(&leg.stretch.segment.from) {
                if next == index {
                    return begun;
                }
                next += 1;
            }
            begun += self.leg_seconds(leg);
        }
        if next == index {
            begun.rem_euclid(self.round_s())
        } else {
            0.0
        }
    }
}
