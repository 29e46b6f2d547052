//! A time-variant field, so that no place remains a minimum for long.

use core::f64::consts::TAU;

use geometry::math;
use nalgebra::Vector2;
use parameters::{Parameters, at_least};

/// Period of the rotation (s).
const PERIOD: f64 = 7.0;

parameters::table! {
    /// Parameters of the time-variant perturbation (chasing-game paper, §I-C: fields are time-variant
    /// to leave local minima; the paper does not give the method).
    #[derive(Copy)]
    pub struct PerturbationParams {
        /// Magnitude of the rotating push; 0 for none.
        pub amplitude: f64 [at_least(0).unit("m/s")] = 0.1,
    }
}

impl Parameters for PerturbationParams {}

impl PerturbationParams {
    /// The experiments of the chasing-game paper: they contain no time-variant field.
    pub fn paper() -> Self {
        Self { amplitude: 0.0 }
    }
}

/// A slowly rotating push whose phase differs between robots and seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perturbation {
    params: PerturbationParams,
    phase: f64,
}

impl Perturbation {
    /// Creates a perturbation with a phase derived from a seed; neighbouring seeds get phases far
    /// apart (the fractional parts of multiples of the golden ratio).
    pub fn new(params: PerturbationParams, seed: u64) -> Self {
        let scattered = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        // The upper 53 bits fit a double exactly.
        let share = (scattered >> 11) as f64 / (1_u64 << 53) as f64;
        Self {
            params,
            phase: TAU * share,
        }
    }

    /// The push at a time (s): `amplitude` in a slowly rotating direction. Zero at a time that is
    /// not finite.
    pub fn at(&self, time_s: f64) -> Vector2<f64> {
        if self.params.amplitude == 0.0 || !time_s.is_finite() {
            return Vector2::zeros();
        }
        let turns = time_s / PERIOD;
        let (sin, cos) = math::sincos(TAU * (turns - turns.floor()) + self.phase);
        Vector2::new(cos, sin) * self.params.amplitude
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_push_turns_and_averages_out() {
        let push = Perturbation::new(PerturbationParams { amplitude: 0.5 }, 3);
        let quarter = 0.25 * PERIOD;
        let mut sum = Vector2::zeros();
        for turn in 0..4 {
            let now = push.at(f64::from(turn) * quarter);
            assert!((now.norm() - 0.5).abs() < 1e-12);
            sum += now;
        }
        assert!(sum.norm() < 1e-12);
        assert!((push.at(quarter).dot(&push.at(0.0))).abs() < 1e-12);
    }

    #[test]
    fn neighbouring_seeds_push_in_different_directions() {
        let params = PerturbationParams::default();
        let directions: Vec<_> = (0..4)
            .map(|s| Perturbation::new(params, s).at(0.0))
            .collect();
        for (i, a) in directions.iter().enumerate() {
            for b in &directions[..i] {
                assert!((a - b).norm() > 0.05);
            }
        }
    }

    #[test]
    fn the_paper_preset_and_nan_times_give_no_push() {
        assert_eq!(
            Perturbation::new(PerturbationParams::paper(), 1).at(2.0),
            Vector2::zeros()
        );
        let ours = Perturbation::new(PerturbationParams::default(), 1);
        assert_eq!(ours.at(f64::NAN), Vector2::zeros());
    }
}
