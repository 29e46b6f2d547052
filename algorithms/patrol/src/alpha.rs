//! Maximum width of the zig-zag that the robot can drive in time (cat-map patrol paper, §4, phase 1,
//! and Fig. 6).

use chaotic_maps::Source;
use nalgebra::{Point2, Vector2};
use thiserror::Error;

use crate::awg::{Awg, AwgError};

/// Number of laps for the choice of the width, as in the paper's figures.
pub const LAPS: u32 = 12;

/// Maximum number of laps for the choice of a width.
pub const MAX_LAPS: u32 = 1000;

/// Halvings of the interval by [`alpha_max`]: enough for every bit of the result.
const HALVINGS: u32 = 80;

/// Halvings by [`alpha_max_driven`], where each drives all laps: the result is exact to a millionth of
/// the first interval.
const DRIVEN_HALVINGS: u32 = 20;

/// Reason why no width can be chosen, with the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AlphaError {
    /// The contour takes the whole time, or more.
    #[error(transparent)]
    Awg(#[from] AwgError),
    /// A speed, a margin or a number of laps out of its range.
    #[error("`{field}` is {value}: expected {expected}")]
    Value {
        /// Name of the value.
        field: &'static str,
        /// Actual value.
        value: f64,
        /// Expected value.
        expected: &'static str,
    },
    /// There are no waypoints whose position depends on the width.
    #[error(
        "there are no additional waypoints, so no `alpha` is too large: give `t_max` more seconds than \
         the contour has segments, or move the danger zones onto the contour"
    )]
    NothingInserted,
    /// The robot is too slow even for a zig-zag of width 0.
    #[error(
        "a lap takes the robot {lap_s:.3} s even with nearly no zig-zag, but `t_max` = {t_max} s \
         less the margin leaves {limit_s:.3} s: give it more time or a faster robot"
    )]
    TooSlow {
        /// The slowest lap at the smallest width tried (s).
        lap_s: f64,
        /// Time limit of a lap (s).
        t_max: f64,
        /// The time limit less the margin (s).
        limit_s: f64,
    },
    /// The robot did not finish its laps.
    #[error(
        "the robot does not finish its laps in the simulated drive even with nearly no zig-zag: \
         check its limits and the tolerance at waypoints"
    )]
    NotFinished,
}

/// Lap times of a robot.
///
/// Implemented by closures of this form and by [`TurnThenDrive`].
pub trait LapTimes {
    /// Time of each lap (s), driven in order; each lap begins at the end of the previous one and has
    /// its start as first point. `None` if the robot does not finish them.
    fn lap_times(&mut self, laps: &[Vec<Point2<f64>>]) -> Option<Vec<f64>>;
}

impl<F: FnMut(&[Vec<Point2<f64>>]) -> Option<Vec<f64>>> LapTimes for F {
    fn lap_times(&mut self, laps: &[Vec<Point2<f64>>]) -> Option<Vec<f64>> {
        self(laps)
    }
}

/// A robot that turns on the spot towards each waypoint and then drives straight to it: slower than any
/// robot that turns while driving.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnThenDrive {
    /// Speed (m/s), > 0.
    pub v: f64,
    /// Turning rate (rad/s), > 0.
    pub omega: f64,
}

impl LapTimes for TurnThenDrive {
    fn lap_times(&mut self, laps: &[Vec<Point2<f64>>]) -> Option<Vec<f64>> {
        // The turn from one lap to the next belongs to the later one.
        let mut before: Option<Vector2<f64>> = None;
        let mut times = Vec::with_capacity(laps.len());
        for lap in laps {
            let mut time = 0.0;
            for pair in lap.windows(2) {
                let leg = pair[1] - pair[0];
                if leg.norm() == 0.0 {
                    continue;
                }
                if let Some(before) = before.replace(leg) {
                    let turn = geometry::math::atan2(before.perp(&leg), before.dot(&leg));
                    time += turn.abs() / self.omega;
                }
                time += leg.norm() / self.v;
            }
            times.push(time);
        }
        times.iter().all(|t| t.is_finite()).then_some(times)
    }
}

/// The width (m) at which the mean length of the first `laps` laps is exactly the distance that a robot
/// of speed `v_robot` (m/s) drives in the time, with turns that take no time (`α_max`; paper, Eq. 8).
/// The width of `awg` is ignored; `source` must be at its beginning.
///
/// The result is exact: the length of a lap is a convex function of the width, minimal at 0.
///
/// # Errors
/// [`AlphaError`] if the robot is too slow for the contour, if there are no waypoints to spread, or
/// for a value out of its range.
pub fn alpha_max(
    awg: &Awg,
    v_robot: f64,
    laps: u32,
    source: &mut impl Source,
) -> Result<f64, AlphaError> {
    check_laps(laps)?;
    check_speed(v_robot)?;
    awg.check_speed(v_robot)?;
    let trial = LapFamily::new(awg, laps, source)?;
    let wanted = v_robot * awg.params().t_max;
    let mut high = 1.0;
    while trial.mean_length(high) < wanted {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if trial.mean_length(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(low)
}

/// The largest width (m), found by halving, at which each of the first `laps` laps takes the robot at
/// most `t_max`·(1 − `margin`), including turns. The laps have been driven at the returned width.
///
/// `v_max` (m/s) is the robot's maximum speed, from which the search starts; the rest is as for
/// [`alpha_max`].
///
/// # Errors
/// [`AlphaError`], also if the robot is too slow for a zig-zag of any width.
pub fn alpha_max_driven(
    awg: &Awg,
    v_max: f64,
    margin: f64,
    laps: u32,
    source: &mut impl Source,
    robot: &mut impl LapTimes,
) -> Result<f64, AlphaError> {
    let mut search = Search::new(awg, v_max, margin, laps, source, robot)?;
    for _ in 0..DRIVEN_HALVINGS {
        let middle = 0.5 * (search.low + search.high);
        if search
            .slowest(middle)
            .is_some_and(|lap_s| lap_s <= search.limit_s)
        {
            search.low = middle;
        } else {
            search.high = middle;
        }
    }
    Ok(search.low)
}

/// Returns `true` if [`alpha_max_driven`] would find a width: the laps are driven once, with nearly no
/// zig-zag.
///
/// # Errors
/// As for [`alpha_max_driven`].
pub fn check_driven(
    awg: &Awg,
    v_max: f64,
    margin: f64,
    laps: u32,
    source: &mut impl Source,
    robot: &mut impl LapTimes,
) -> Result<(), AlphaError> {
    Search::new(awg, v_max, margin, laps, source, robot).map(drop)
}

/// The interval of the width.
struct Search<'r, R> {
    trial: LapFamily,
    robot: &'r mut R,
    /// Maximum time of a lap (s).
    limit_s: f64,
    /// A width that has been driven in time (m).
    low: f64,
    /// A width that is too large (m).
    high: f64,
}

impl<'r, R: LapTimes> Search<'r, R> {
    fn new(
        awg: &Awg,
        v_max: f64,
        margin: f64,
        laps: u32,
        source: &mut impl Source,
        robot: &'r mut R,
    ) -> Result<Self, AlphaError> {
        check_laps(laps)?;
        check_speed(v_max)?;
        if !(0.0..1.0).contains(&margin) {
            return Err(AlphaError::Value {
                field: "margin",
                value: margin,
                expected: "a share of at least 0 and below 1",
            });
        }
        awg.check_speed(v_max)?;
        let trial = LapFamily::new(awg, laps, source)?;
        let t_max = awg.params().t_max;
        let limit_s = t_max * (1.0 - margin);
        // A robot that rounds its corners drives less than the path's length: twice the width of that
        // bound is always too large.
        let mut high = 2.0 * v_max / awg.v();
        while trial.mean_length(high) < 2.0 * v_max * t_max {
            high *= 2.0;
        }
        let mut search = Self {
            trial,
            robot,
            limit_s,
            low: high * 1e-6,
            high,
        };
        match search.slowest(search.low) {
            Some(lap_s) if lap_s <= limit_s => Ok(search),
            Some(lap_s) => Err(AlphaError::TooSlow {
                lap_s,
                t_max,
                limit_s,
            }),
            None => Err(AlphaError::NotFinished),
        }
    }

    /// Time of the slowest lap at a width (s); `None` if the robot does not finish.
    fn slowest(&mut self, alpha: f64) -> Option<f64> {
        let times = self.robot.lap_times(&self.trial.paths(alpha))?;
        Some(times.into_iter().fold(0.0, f64::max))
    }
}

fn check_laps(laps: u32) -> Result<(), AlphaError> {
    if (1..=MAX_LAPS).contains(&laps) {
        return Ok(());
    }
    Err(AlphaError::Value {
        field: "laps",
        value: f64::from(laps),
        expected: "a number from 1 to 1000",
    })
}

fn check_speed(v: f64) -> Result<(), AlphaError> {
    if v > 0.0 && v.is_finite() {
        return Ok(());
    }
    Err(AlphaError::Value {
        field: "v_max",
        value: v,
        expected: "a finite number above 0 (m/s)",
    })
}

/// Laps as functions of the width: every waypoint is a point plus α times an offset.
struct LapFamily {
    laps: Vec<Vec<(Point2<f64>, Vector2<f64>)>>,
}

impl LapFamily {
    fn new(awg: &Awg, laps: u32, source: &mut impl Source) -> Result<Self, AlphaError> {
        if awg.steps_per_lap() == 0 {
            return Err(AlphaError::NothingInserted);
        }
        let laps = (0..laps)
            .map(|lap| {
                let mut points = Vec::with_capacity(awg.waypoints_per_lap() as usize + 1);
                for leg in awg.legs(lap) {
                    let segment = &leg.stretch.segment;
                    if points.is_empty() {
                        points.push((segment.from, Vector2::zeros()));
                    }
                    points.extend((1..=leg.inserted).map(|j| {
                        let offset = leg.offset(source.next_unit());
                        (leg.nominal(j, awg.v()), offset)
                    }));
                    points.push((segment.to, Vector2::zeros()));
                }
                points
            })
            .collect();
        Ok(Self { laps })
    }

    fn paths(&self, alpha: f64) -> Vec<Vec<Point2<f64>>> {
        let at = |&(point, offset): &(Point2<f64>, Vector2<f64>)| point + offset * alpha;
        self.laps
            .iter()
            .map(|lap| lap.iter().map(at).collect())
            .collect()
    }

    fn mean_length(&self, alpha: f64) -> f64 {
        let mut sum = 0.0;
        for lap in &self.laps {
            for pair in lap.windows(2) {
                let offset = pair[1].0 - pair[0].0;
                sum += (offset + (pair[1].1 - pair[0].1) * alpha).norm();
            }
        }
        sum / self.laps.len() as f64
    }
}

#[cfg(test)]
mod tests;
