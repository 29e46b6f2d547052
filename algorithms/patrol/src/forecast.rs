//! Forecast of a robot's position, for an ally that has the key (cat-map patrol paper, §3.1 and §4).
//!
//! Every waypoint is available at once, however far ahead, because the generators jump. There are two
//! measures of progress. On the waypoint clock each additional one takes a second (or
//! slightly less, so that laps end in time: [`Awg::with_tempo`]). By the distance driven, the
//! forecast fits a robot at its own speed. The clock starts when the robot leaves the start of the
//! contour. A robot that keeps to the clock is at the forecast position, except that a leg may be
//! longer than it can drive in its second: then it is late until it has caught up.

use chaotic_maps::AnySource;
use nalgebra::Point2;
use planner_view::waypoint::{Waypoint, WaypointKind};
use thiserror::Error;

use crate::awg::{Awg, waypoint};

/// Maximum number of steps of a generator without jumps.
const MAX_SINGLE_STEPS: u64 = 1_000_000_000;

/// Reason why there is no forecast.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ForecastError {
    /// An invalid time or distance.
    #[error("`{field}` is {value}: expected a finite number of at least 0")]
    Value {
        /// Name of the value.
        field: &'static str,
        /// Actual value.
        value: f64,
    },
    /// Too far ahead.
    #[error(
        "too far ahead: {what} is above the maximum of {most}; use an earlier time or a key of another \
         kind"
    )]
    TooFar {
        /// The requested quantity.
        what: String,
        /// Its maximum.
        most: u64,
    },
}

/// Forecast position of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForecastPosition {
    /// Position (m).
    pub point: Point2<f64>,
    /// The last waypoint.
    pub from: Waypoint,
    /// The next waypoint.
    pub to: Waypoint,
}

/// Forecast of a patrol.
#[derive(Debug, Clone)]
pub struct Forecast {
    awg: Awg,
    source: AnySource,
    jumps: bool,
}

impl Forecast {
    /// Creates the forecast of a patrol whose generator is at its beginning.
    pub fn new(awg: Awg, source: AnySource) -> Self {
        let jumps = matches!(
            source,
            AnySource::CatP(_)
                | AnySource::Cat64(_)
                | AnySource::CatF64(_)
                | AnySource::ChebP(_)
                | AnySource::Keyed(_)
        );
        Self { awg, source, jumps }
    }

    /// The zig-zag of the patrol.
    pub fn awg(&self) -> &Awg {
        &self.awg
    }

    /// Time of a lap on the waypoint clock (s), the same for all laps; [`Awg::lap_time`].
    pub fn lap_time(&self) -> f64 {
        self.awg.lap_time()
    }

    /// The waypoint with this number; 0 is the start.
    ///
    /// # Errors
    /// [`ForecastError::TooFar`] beyond 2³² laps, or for a generator that cannot jump so far.
    pub fn waypoint(&self, number: u64) -> Result<Waypoint, ForecastError> {
        let Some((lap, leg, j)) = self.awg.place(number) else {
            let start = self.awg.start();
            return Ok(waypoint(0, 0, WaypointKind::Route, start));
        };
        let lap =
            u32::try_from(lap).map_err(|_| too_far(format!("lap {lap}"), u64::from(u32::MAX)))?;
        let leg = &self.awg.legs(lap)[leg];
        let mut source = self.source_at(lap, leg.steps_before + u64::from(j) - 1)?;
        Ok(self.awg.waypoint_of_leg(lap, leg, j, &mut source))
    }

    /// The waypoints of a lap, in order; its start is the last one of the previous lap.
    ///
    /// # Errors
    /// As [`Self::waypoint`].
    pub fn lap(&self, lap: u32) -> Result<Vec<Waypoint>, ForecastError> {
        let mut source = self.source_at(lap, 0)?;
        let mut waypoints = Vec::with_capacity(self.awg.waypoints_per_lap() as usize);
        self.awg.lap_into(lap, &mut source, &mut waypoints);
        Ok(waypoints)
    }

    /// The position of the robot `t` (s) after it left the start of the contour, on the clock of the
    /// waypoints ([`Awg::due_s`]).
    ///
    /// # Errors
    /// [`ForecastError`] for a time that is invalid or too far ahead.
    pub fn at_time(&self, t: f64) -> Result<ForecastPosition, ForecastError> {
        check("t", t)?;
        let lap_time = self.lap_time();
        let laps = (t / lap_time).floor();
        if laps >= f64::from(u32::MAX) {
            return Err(too_far(format!("lap {laps}"), u64::from(u32::MAX)));
        }
        let lap = laps as u32;
        let rest = (t - laps * lap_time).max(0.0);
        let Some(place) = self.awg.place_in_lap(lap, rest) else {
            let start = self.waypoint(0)?;
            return Ok(between(start, start, 0.0));
        };
        // The last waypoint is the previous one, of this leg or of the last.
        let before = place.leg.waypoints_before + u64::from(place.passed);
        let number = self.awg.first_of_lap(lap) + before - 1;
        let (from, to) = (self.waypoint(number)?, self.waypoint(number + 1)?);
        Ok(between(from, to, place.share))
    }

    /// The generator before a step of a lap.
    fn source_at(&self, lap: u32, step: u64) -> Result<AnySource, ForecastError> {
        let steps = u64::from(lap)
            .checked_mul(self.awg.steps_per_lap())
            .and_then(|before| before.checked_add(step))
            .ok_or_else(|| too_far(format!("lap {lap}"), u64::MAX))?;
        if !self.jumps && steps > MAX_SINGLE_STEPS {
            return Err(too_far(
                format!("step {steps} of a generator that cannot jump"),
                MAX_SINGLE_STEPS,
            ));
        }
        let mut source = self.source.clone();
        source.advance(steps);
        Ok(source)
    }
}

fn check(field: &'static str, value: f64) -> Result<(), ForecastError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(ForecastError::Value { field, value })
    }
}

fn too_far(what: String, most: u64) -> ForecastError {
    ForecastError::TooFar { what, most }
}

fn between(from: Waypoint, to: Waypoint, share: f64) -> ForecastPosition {
    ForecastPosition {
        point: from.point + (to.point - from.point) * share,
        from,
        to,
    }
}

#[cfg(test)]
mod tests;
