//! Computation of speeds from the cones.

use geometry::math;
use geometry::pose::Twist2;
use parameters::{ParamsError, check};
use planner_view::limits::Limits;
use planner_view::steering::Steering;
use planner_view::view::View;

use crate::cones::{Cones, read};
use crate::params::{BraitenbergParams, SpeedGain};

/// Offset of the diagonal readings in the speed's formula (m) (the paper's experiments).
const DIAGONAL_OFFSET: f64 = 0.05;
/// Weight of the diagonal cones in the turning rate (m).
const DIAGONAL_WEIGHT: f64 = 5.0;
/// Weight of the side cones in the turning rate (m).
const SIDE_WEIGHT: f64 = 1.0;
/// Width of the street in which the normalised speed is the highest (m).
const STREET_WIDTH: f64 = 1.0;
/// Free range ahead at which the normalised speed is the highest (m), at most the sensor's range.
const OPEN_RANGE: f64 = 3.0;
/// Range ahead at which the vehicle stops (m).
const STOP_RANGE: f64 = 0.4;
/// Width of a cone (°).
const CONE_WIDTH_DEGREES: f64 = 10.0;
/// Share of a cone's beams that may be shorter than its reading.
const PERCENTILE: f64 = 0.1;
/// Range ahead below which the vehicle counts as blocked (m); above [`STOP_RANGE`], which it would
/// only approach ever more slowly.
const BLOCKED_RANGE: f64 = 0.5;
/// Range ahead above which it no longer counts as blocked (m).
const RELEASED_RANGE: f64 = 0.9;
/// Difference of the free ranges to the left and to the right (m) below which a blocked robot turns
/// to its preferred side.
const UNDECIDED: f64 = 0.1;

/// Braitenberg vehicle.
///
/// Its only state is the side it turns to while it is blocked, so that it does not oscillate.
#[derive(Debug, Clone)]
pub struct Braitenberg {
    params: BraitenbergParams,
    limits: Limits,
    /// +1 to turn left, −1 to turn right when both sides are equal.
    preferred: f64,
    /// Side it turns to, while blocked.
    turning: Option<f64>,
    scratch: Vec<f64>,
}

impl Braitenberg {
    /// Returns a vehicle for a robot with these limits. The seed decides the side to which it turns
    /// when it faces a wall squarely (even: left).
    ///
    /// # Errors
    /// [`ParamsError`] if a parameter is out of range.
    pub fn new(params: BraitenbergParams, limits: Limits, seed: u64) -> Result<Self, ParamsError> {
        check(&params)?;
        let preferred = if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
        Ok(Self {
            params,
            limits,
            preferred,
            turning: None,
            scratch: Vec::new(),
        })
    }

    /// Returns the command of the robot `view.me` for this tick: a function of its scan alone.
    ///
    /// It stands still if it is not listed or no longer takes part, and if its scan does not cover
    /// the view ahead.
    pub fn command(&mut self, view: &View<'_>) -> Steering {
        if view.own().is_none_or(|own| !own.active) {
            return Steering::stop();
        }
        let Some(scan) = &view.scan else {
            return Steering::stop();
        };
        let width = CONE_WIDTH_DEGREES.to_radians();
        let cones = read(scan, width, PERCENTILE, &mut self.scratch);
        let open = OPEN_RANGE.min(scan.range_max);
        let Some(ranges) = Ranges::complete(&cones, open) else {
            return Steering::stop();
        };
        Steering {
            command: self.wire(&ranges, open),
            ..Steering::stop()
        }
    }

    fn wire(&mut self, ranges: &Ranges, open: f64) -> Twist2 {
        let params = self.params;
        let limits = self.limits.restricted(params.reverse_fraction, None);
        if let Some(side) = self.blocked(ranges) {
            return limits.clip(Twist2::new(0.0, side * self.params.turn_gain));
        }
        let product = drive(ranges.front, ranges.front_left, ranges.front_right);
        let drive = match params.speed_gain {
            SpeedGain::Paper => product,
            SpeedGain::Normalised => {
                // The diagonals of a street meet its walls at √2 times half its width.
                let diagonal = STREET_WIDTH * core::f64::consts::FRAC_1_SQRT_2;
                // A sensor with a range below the stopping range cannot drive at all.
                let nominal = self::drive(open.max(STOP_RANGE + 0.1), diagonal, diagonal);
                product / nominal
            }
        };
        // In pairs, so that equal sides cancel exactly.
        let asymmetry = (DIAGONAL_WEIGHT / ranges.front_right
            - DIAGONAL_WEIGHT / ranges.front_left)
            + (SIDE_WEIGHT / ranges.right - SIDE_WEIGHT / ranges.left);
        limits.clip(Twist2::new(
            drive * limits.v_max(),
            params.turn_gain * squash(asymmetry),
        ))
    }

    /// Returns the side to turn to, if the robot is blocked ahead.
    fn blocked(&mut self, ranges: &Ranges) -> Option<f64> {
        if self.params.fidelity.is_published() || ranges.front > RELEASED_RANGE {
            self.turning = None;
        } else if self.turning.is_none() && ranges.front < BLOCKED_RANGE {
            let left = ranges.left + ranges.front_left;
            let right = ranges.right + ranges.front_right;
            self.turning = Some(if (left - right).abs() < UNDECIDED {
                self.preferred
            } else {
                (left - right).signum()
            });
        }
        self.turning
    }
}

/// The paper's squashing function.
fn squash(x: f64) -> f64 {
    math::tanh(x / 2.0)
}

/// Returns the paper's speed as a fraction of the highest, in (−1, 1).
fn drive(front: f64, front_left: f64, front_right: f64) -> f64 {
    squash(front - STOP_RANGE)
        * squash(front_left + DIAGONAL_OFFSET)
        * squash(front_right + DIAGONAL_OFFSET)
}

/// The readings, with gaps filled in (m).
#[derive(Debug, Clone, Copy)]
struct Ranges {
    front: f64,
    front_left: f64,
    front_right: f64,
    left: f64,
    right: f64,
}

impl Ranges {
    /// Fills gaps: a missing side reads as the other side, two missing sides as open, a missing
    /// front as the nearer diagonal. `None` if there is no reading ahead.
    fn complete(cones: &Cones, open: f64) -> Option<Self> {
        let pair = |left: Option<f64>, right: Option<f64>| match (left, right) {
            (Some(left), Some(right)) => (left, right),
            (Some(one), None) | (None, Some(one)) => (one, one),
            (None, None) => (open, open),
        };
        let (front_left, front_right) = pair(cones.front_left, cones.front_right);
        let (left, right) = pair(cones.left, cones.right);
        let diagonal = match (cones.front_left, cones.front_right) {
            (Some(left), Some(right)) => Some(left.min(right)),
            (one, other) => one.or(other),
        };
        let front = cones.front.or(diagonal)?;
        Some(Self {
            front,
            front_left,
            front_right,
            left,
            right,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vehicle(params: BraitenbergParams, seed: u64) -> Braitenberg {
        Braitenberg::new(params, Limits::new(0.9, 0.9, 2.84).unwrap(), seed).unwrap()
    }

    fn street(front: f64) -> Ranges {
        let diagonal = core::f64::consts::FRAC_1_SQRT_2;
        Ranges {
            front,
            front_left: diagonal,
            front_right: diagonal,
            left: 0.5,
            right: 0.5,
        }
    }

    #[test]
    fn the_papers_formula_creeps_along_a_street() {
        let got = vehicle(BraitenbergParams::paper(), 0).wire(&street(3.5), 3.5);
        // 0.131 · tanh(3.1/2) of the highest speed.
        assert!((got.v / 0.9 - 0.131 * 0.914).abs() < 2e-3, "{got:?}");
        assert_eq!(got.omega, 0.0);
    }

    #[test]
    fn the_papers_turn_is_the_papers() {
        let ranges = Ranges {
            front: 2.0,
            front_left: 1.0,
            front_right: 2.0,
            left: 0.5,
            right: 2.0,
        };
        let got = vehicle(BraitenbergParams::paper(), 0).wire(&ranges, 3.5);
        let expected = math::tanh((5.0 / 2.0 + 1.0 / 2.0 - 5.0 / 1.0 - 1.0 / 0.5) / 2.0);
        assert!((got.omega - expected).abs() < 1e-12 && got.omega < -0.9);
    }

    #[test]
    fn ours_drives_at_full_speed_in_the_middle_of_an_open_street() {
        let got = vehicle(BraitenbergParams::default(), 0).wire(&street(3.0), 3.0);
        assert!((got.v - 0.9).abs() < 1e-12, "{got:?}");
        // And slows before a wall.
        let near = vehicle(BraitenbergParams::default(), 0).wire(&street(0.8), 3.0);
        assert!(near.v > 0.0 && near.v < 0.4, "{near:?}");
    }

    #[test]
    fn facing_a_wall_squarely_the_papers_stays_for_ever_and_ours_turns_to_its_side() {
        let wall = Ranges {
            front: 0.35,
            front_left: 0.5,
            front_right: 0.5,
            left: 2.0,
            right: 2.0,
        };
        let paper = vehicle(BraitenbergParams::paper(), 0).wire(&wall, 3.0);
        assert!(paper.v <= 0.0 && paper.omega == 0.0);
        assert_eq!(
            vehicle(BraitenbergParams::default(), 0)
                .wire(&wall, 3.0)
                .omega,
            2.0
        );
        assert_eq!(
            vehicle(BraitenbergParams::default(), 1)
                .wire(&wall, 3.0)
                .omega,
            -2.0
        );
        // A clearly freer side overrides the preference, and is kept until the way is free.
        let mut ours = vehicle(BraitenbergParams::default(), 0);
        let freer_right = Ranges { right: 3.0, ..wall };
        assert_eq!(ours.wire(&freer_right, 3.0).omega, -2.0);
        assert_eq!(ours.wire(&Ranges { left: 3.5, ..wall }, 3.0).omega, -2.0);
        assert!(ours.wire(&street(3.0), 3.0).v > 0.8);
    }

    #[test]
    fn gaps_in_the_field_of_view_do_not_turn_the_robot() {
        let cones = Cones {
            front: Some(2.0),
            front_left: Some(0.7),
            ..Cones::default()
        };
        let ranges = Ranges::complete(&cones, 3.0).unwrap();
        let got = vehicle(BraitenbergParams::default(), 0).wire(&ranges, 3.0);
        assert_eq!(got.omega, 0.0);
        assert!(Ranges::complete(&Cones::default(), 3.0).is_none());
        let only_sides = Cones {
            left: Some(1.0),
            ..Cones::default()
        };
        assert!(Ranges::complete(&only_sides, 3.0).is_none());
    }
}
