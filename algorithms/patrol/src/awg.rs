//! Additional waypoints generation (AWG): turns a contour into a zig-zag that differs on every lap
//! (cat-map patrol paper, §3.4, §3.5 and §4).
//!
//! A point (X, Y) of a generator in the unit square becomes a waypoint in a square of side α that
//! moves along the segment at the speed v of an unprotected patrol (Eq. 2, 7 and 9): after j seconds
//!
//! `Q = P_i + v·j·u + α·(X·f + (Y − ½)·f⊥)`
//!
//! with `u` the direction of the segment and `f` that of the square. Where v < α, the path often goes
//! back: no waypoint determines the next one.

mod clock;
mod error;
mod laps;
mod mode;

use chaotic_maps::Source;
use metrics::track::Track;
use nalgebra::{Point2, Vector2};
use planner_view::waypoint::{Waypoint, WaypointKind};

use crate::contour::Contour;
use crate::danger::{DangerZones, Stretch};

pub use clock::Place;
pub use error::AwgError;
pub use laps::Laps;
pub use mode::{Frame, Mode, Preset, Rounding};

/// Maximum time of a lap (s): every second is a waypoint, and a lap is planned at once.
pub const MAX_T_MAX: f64 = 1e6;

/// Protects lengths that are an exact multiple of the speed from rounding.
const RATIO_GUARD: f64 = 1e-9;

/// Parameters of a zig-zag, besides the contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AwgParams {
    /// Time limit of a lap (s), > 0 and ≤ [`MAX_T_MAX`] (the paper's `t_max`).
    pub t_max: f64,
    /// Width of the zig-zag (m), > 0: waypoints lie within half of it on either side (α).
    pub alpha: f64,
    /// Rounding of the numbers of waypoints, and orientation of the square.
    pub mode: Mode,
}

/// A leg of a lap: a stretch of the contour with its additional waypoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// The stretch.
    pub stretch: Stretch,
    /// Direction of the square's first axis (f), unit.
    pub facing: Vector2<f64>,
    /// Number of additional waypoints (`M_i`); 0 without a threat.
    pub inserted: u32,
    /// Steps of the generator that the lap takes before this leg.
    pub steps_before: u64,
    /// Waypoints of the lap before this leg's own.
    pub waypoints_before: u64,
}

impl Leg {
    /// Time between two waypoints of the leg (s), if all are visited in time, for an unprotected
    /// patrol of `v` (m/s): [`metrics::path::seconds_per_waypoint`].
    pub fn seconds_per_waypoint(&self, v: f64) -> f64 {
        let length = self.stretch.segment.length;
        metrics::path::seconds_per_waypoint(length, u64::from(self.inserted), v)
    }

    /// Number of waypoints of the leg: the additional ones and its end.
    pub fn waypoints(&self) -> u64 {
        u64::from(self.inserted) + 1
    }

    fn new(stretch: Stretch, v: f64, mode: Mode, before: Option<&Self>) -> Self {
        let segment = &stretch.segment;
        let inserted = if stretch.threatened {
            let count = segment.length / v - 1.0 + mode.rounding.shift() + RATIO_GUARD;
            count.floor().max(0.0) as u32
        } else {
            0
        };
        Self {
            stretch,
            facing: mode.frame.facing(segment.along),
            inserted,
            steps_before: before.map_or(0, |b| b.steps_before + u64::from(b.inserted)),
            waypoints_before: before.map_or(0, |b| b.waypoints_before + b.waypoints()),
        }
    }

    /// Position of the `j`th additional waypoint for the generator's point `[x, y]`.
    fn point(&self, j: u32, [x, y]: [f64; 2], v: f64, alpha: f64) -> Point2<f64> {
        self.nominal(j, v) + self.offset([x, y]) * alpha
    }

    /// Position of an unprotected patrol after `j` seconds on the leg.
    pub(crate) fn nominal(&self, j: u32, v: f64) -> Point2<f64> {
        self.stretch.segment.from + self.stretch.segment.along * (v * f64::from(j))
    }

    /// Offset from that position, in units of α.
    pub(crate) fn offset(&self, [x, y]: [f64; 2]) -> Vector2<f64> {
        let f = self.facing;
        f * x + Vector2::new(-f.y, f.x) * (y - 0.5)
    }
}

/// A contour with all data of its zig-zag that do not depend on the key.
#[derive(Debug, Clone, PartialEq)]
pub struct Awg {
    params: AwgParams,
    v: f64,
    length: f64,
    /// Share of the paper's time that the clock of the waypoints uses.
    tempo: f64,
    start: Point2<f64>,
    forward: Vec<Leg>,
    /// The legs of the return; empty for a closed contour.
    backward: Vec<Leg>,
}

impl Awg {
    /// Prepares a zig-zag about the threatened parts of a contour.
    ///
    /// # Errors
    /// [`AwgError`] for a time or a width out of its range, or a zone without an area.
    pub fn new(
        contour: &Contour,
        zones: &DangerZones,
        params: AwgParams,
    ) -> Result<Self, AwgError> {
        let AwgParams { t_max, alpha, mode } = params;
        if !(t_max > 0.0 && t_max <= MAX_T_MAX) {
            return Err(AwgError::TMax { value: t_max });
        }
        if !(alpha > 0.0 && alpha.is_finite()) {
            return Err(AwgError::Alpha { value: alpha });
        }
        let length = contour.length();
        let v = length / t_max;
        if !(v.is_normal()) {
            return Err(AwgError::Speed { length, t_max });
        }
        let stretches = zones.cut(contour)?;
        let forward = legs(stretches.iter().copied(), v, mode);
        let backward = if contour.is_closed() {
            Vec::new()
        } else {
            let back = stretches.iter().rev().map(|stretch| Stretch {
                segment: stretch.segment.reversed(),
                ..*stretch
            });
            legs(back, v, mode)
        };
        let start = contour
            .segments()
            .first()
            .map_or_else(Point2::origin, |s| s.from);
        Ok(Self {
            params,
            v,
            length,
            tempo: 1.0,
            start,
            forward,
            backward,
        })
    }

    /// The same contour with another width (m).
    ///
    /// # Errors
    /// [`AwgError::Alpha`] unless it is a finite number above 0.
    pub fn with_alpha(mut self, alpha: f64) -> Result<Self, AwgError> {
        if !(alpha > 0.0 && alpha.is_finite()) {
            return Err(AwgError::Alpha { value: alpha });
        }
        self.params.alpha = alpha;
        Ok(self)
    }

    /// Checks that a robot of this maximum speed (m/s) can drive the contour in the time at all.
    ///
    /// # Errors
    /// [`AwgError::TooShort`], which contains the minimum time.
    pub fn check_speed(&self, v_max: f64) -> Result<(), AwgError> {
        // Not `v > v_max`: a speed of NaN must fail as well.
        if self.v <= v_max {
            return Ok(());
        }
        Err(AwgError::TooShort {
            t_max: self.params.t_max,
            length: self.length,
            v_max,
            least: self.length / v_max,
        })
    }

    /// The parameters.
    pub fn params(&self) -> AwgParams {
        self.params
    }

    /// Speed of an unprotected patrol (m/s) (v; paper, Eq. 9).
    pub fn v(&self) -> f64 {
        self.v
    }

    /// Length of the contour (m).
    pub fn contour_length(&self) -> f64 {
        self.length
    }

    /// Start of the first lap (m).
    pub fn start(&self) -> Point2<f64> {
        self.start
    }

    /// The legs of a lap, in order; at least one.
    pub fn legs(&self, lap: u32) -> &[Leg] {
        if lap % 2 == 1 && !self.backward.is_empty() {
            &self.backward
        } else {
            &self.forward
        }
    }

    /// Steps of the generator that a lap takes: the sum of all `M_i`.
    pub fn steps_per_lap(&self) -> u64 {
        let last = self.forward.last();
        last.map_or(0, |leg| leg.steps_before + u64::from(leg.inserted))
    }

    /// Waypoints per lap, the start not counted: it is the end of the lap before.
    pub fn waypoints_per_lap(&self) -> u64 {
        let last = self.forward.last();
        last.map_or(0, |leg| leg.waypoints_before + leg.waypoints())
    }

    /// The same with a faster clock: each lap takes this share of its time, > 0 and ≤ 1.
    ///
    /// # Errors
    /// [`AwgError::Tempo`] for any other value.
    pub fn with_tempo(mut self, tempo: f64) -> Result<Self, AwgError> {
        if !(tempo > 0.0 && tempo <= 1.0) {
            return Err(AwgError::Tempo { value: tempo });
        }
        self.tempo = tempo;
        Ok(self)
    }

    /// All laps from the first, with a generator at its beginning.
    pub fn laps<S: Source>(self, source: S) -> Laps<S> {
        Laps::new(self, source)
    }

    /// Appends the waypoints of a lap after its start. The generator must be where the lap begins;
    /// it takes [`Self::steps_per_lap`] steps.
    pub fn lap_into(&self, lap: u32, source: &mut impl Source, out: &mut Vec<Waypoint>) {
        let first = self.first_of_lap(lap);
        for leg in self.legs(lap) {
            let mut number = first + leg.waypoints_before;
            for j in 1..=leg.inserted {
                let point = leg.point(j, source.next_unit(), self.v, self.params.alpha);
                out.push(waypoint(number, lap, WaypointKind::Inserted, point));
                number += 1;
            }
            let end = leg.stretch.segment.to;
            out.push(waypoint(number, lap, WaypointKind::Route, end));
        }
    }

    /// A lap with its start and the times of its waypoints since then. Otherwise as [`Self::lap_into`].
    #[cfg(test)]
    pub(crate) fn lap_track(&self, lap: u32, source: &mut impl Source) -> Track {
        let mut waypoints = Vec::with_capacity(self.waypoints_per_lap() as usize);
        self.lap_into(lap, source, &mut waypoints);
        self.track(lap, &waypoints)
    }

    /// The track of a lap with these waypoints, which [`Self::lap_into`] has made.
    pub fn track(&self, lap: u32, waypoints: &[Waypoint]) -> Track {
        let legs = self.legs(lap);
        let start = legs
            .first()
            .map_or(self.start, |leg| leg.stretch.segment.from);
        let mut track = Track::default();
        track.push(0.0, start);
        let mut begun = 0.0;
        let mut rest = waypoints.iter();
        for leg in legs {
            for j in 1..=leg.waypoints() {
                if let Some(waypoint) = rest.next() {
                    let due = begun + self.seconds_per_waypoint(leg) * j as f64;
                    track.push(due, waypoint.point);
                }
            }
            begun += self.leg_seconds(leg);
        }
        track
    }

    /// The lap (from 0), the index in its [`Self::legs`] and the waypoint of that leg (from 1) with
    /// this number; `None` for the start, number 0.
    pub fn place(&self, number: u64) -> Option<(u64, usize, u32)> {
        let index = number.checked_sub(1)?;
        let (lap, within) = (
            index / self.waypoints_per_lap(),
            index % self.waypoints_per_lap(),
        );
        let legs = self.legs((lap % 2) as u32);
        let leg = legs
            .partition_point(|leg| leg.waypoints_before <= within)
            .checked_sub(1)?;
        Some((lap, leg, (within - legs[leg].waypoints_before) as u32 + 1))
    }

    /// Number of the first waypoint of a lap; number 0 is the start of the patrol.
    pub(crate) fn first_of_lap(&self, lap: u32) -> u64 {
        1 + u64::from(lap) * self.waypoints_per_lap()
    }

    /// The `j`th waypoint of a leg, from 1; the one after the additional ones is its end. Only an
    /// additional one takes a step of the generator.
    pub(crate) fn waypoint_of_leg(
        &self,
        lap: u32,
        leg: &Leg,
        j: u32,
        source: &mut impl Source,
    ) -> Waypoint {
        let number = self.first_of_lap(lap) + leg.waypoints_before + u64::from(j) - 1;
        if j <= leg.inserted {
            let point = leg.point(j, source.next_unit(), self.v, self.params.alpha);
            waypoint(number, lap, WaypointKind::Inserted, point)
        } else {
            waypoint(number, lap, WaypointKind::Route, leg.stretch.segment.to)
        }
    }
}

pub(crate) fn waypoint(number: u64, lap: u32, kind: WaypointKind, point: Point2<f64>) -> Waypoint {
    Waypoint {
        number,
        lap,
        kind,
        point,
    }
}

fn legs(stretches: impl Iterator<Item = Stretch>, v: f64, mode: Mode) -> Vec<Leg> {
    let mut legs: Vec<Leg> = Vec::with_capacity(stretches.size_hint().0);
    for stretch in stretches {
        let leg = Leg::new(stretch, v, mode, legs.last());
        legs.push(leg);
    }
    legs
}

#[cfg(test)]
pub(crate) mod tests;
