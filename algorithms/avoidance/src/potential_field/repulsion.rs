//! Repulsion from other robots.

use geometry::math;
use nalgebra::{Point2, Vector2};
use parameters::{Fidelity, Parameters, above};

use navigation::bearing::Bearings;

/// Maximum factor of a repulsor's weight at short distances.
const NEAR_GAIN: f64 = 8.0;

/// Sideways part of the push, as a fraction: the robot swirls past (clockwise) instead of driving straight
/// away.
const SWIRL: f64 = 0.1;

/// A point that repels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repulsor {
    /// Position (m).
    pub at: Point2<f64>,
    /// Strength of the repulsion, ≥ 0.
    pub weight: f64,
}

parameters::choice! {
    /// Decrease of a repulsion with distance d.
    pub enum Falloff {
        /// (`reach`/d)², at most 8: strong at short distances, a quarter at twice the reach.
        #[default]
        InverseSquare,
        /// 1 up to `reach`, then 1/(d − `reach` + 1) (the paper's): four pursuers anywhere within reach always
        /// outweigh an exit, even a close one.
        Plateau,
    }
}

parameters::table! {
    /// Parameters of the repulsion.
    #[derive(Copy)]
    pub struct RepulsionParams {
        /// Decrease with distance.
        pub falloff: Falloff = Falloff::InverseSquare,
        /// Reference distance of the decrease.
        pub reach: f64 [above(0).unit("m")] = 1.0,
        /// Magnitude that the sum approaches but never exceeds.
        pub speed: f64 [above(0).unit("m/s")] = 2.0,
        /// Variant of the sum. [`Fidelity::Published`] multiplies it again by the mean weight of the
        /// repulsors: weights then count twice, and adding a weak repulsor weakens the others.
        pub fidelity: Fidelity = Fidelity::Ours,
    }
}

impl Parameters for RepulsionParams {}

impl RepulsionParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            falloff: Falloff::Plateau,
            reach: 5.0,
            speed: 2.0,
            fidelity: Fidelity::Published,
        }
    }

    /// The factor of the decrease at a distance (m) ≥ 0.
    pub fn strength(&self, distance: f64) -> f64 {
        match self.falloff {
            Falloff::InverseSquare => {
                let ratio = self.reach / distance;
                (ratio * ratio).min(NEAR_GAIN)
            }
            Falloff::Plateau => 1.0 / (distance - self.reach + 1.0).max(1.0),
        }
    }
}

/// The repulsion of several points at a point (m/s).
///
/// Every repulsor pushes away along its bearing, turned slightly to the side, with its weight and the strength
/// of its distance; the sum saturates at `speed` with a tanh. Repulsors closer than 1 mm have no direction and
/// do not count; neither do repulsors with invalid numbers.
pub fn repulsion(
    at: Point2<f64>,
    repulsors: impl IntoIterator<Item = Repulsor>,
    bearings: &Bearings<'_>,
    params: &RepulsionParams,
) -> Vector2<f64> {
    let mut push = Vector2::zeros();
    let (mut total, mut count) = (0.0, 0_u32);
    for repulsor in repulsors {
        if !(repulsor.weight.is_finite() && repulsor.weight > 0.0) {
            continue;
        }
        let Some(bearing) = bearings.bearing(at, repulsor.at) else {
            continue;
        };
        let away = -bearing.direction;
        let turned = (away + Vector2::new(away.y, -away.x) * SWIRL) / (1.0 + SWIRL);
        push += turned * (repulsor.weight * params.strength(bearing.distance));
        total += repulsor.weight;
        count += 1;
    }
    let norm = push.norm();
    if !norm.is_finite() || norm < 1e-12 {
        return Vector2::zeros();
    }
    let mut magnitude = params.speed * math::tanh(norm / params.speed);
    if params.fidelity.is_published() {
        magnitude *= total / f64::from(count);
    }
    push * (magnitude / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(repulsors: &[(f64, f64, f64)], params: &RepulsionParams) -> Vector2<f64> {
        let repulsors = repulsors.iter().map(|&(x, y, weight)| Repulsor {
            at: Point2::new(x, y),
            weight,
        });
        repulsion(
            Point2::new(0.0, 0.0),
            repulsors,
            &Bearings::Straight,
            params,
        )
    }

    #[test]
    fn the_push_is_away_and_swirls_clockwise() {
        let got = push(&[(1.0, 0.0, 1.0)], &RepulsionParams::default());
        assert!(got.x < 0.0);
        // The push is along −x; clockwise of it is +y.
        assert!(got.y > 0.0 && got.y < 0.2 * got.x.abs());
    }

    #[test]
    fn ours_weakens_with_distance_where_the_papers_is_constant() {
        let (ours, paper) = (RepulsionParams::default(), RepulsionParams::paper());
        assert!(ours.strength(0.5) > ours.strength(1.0) && ours.strength(1.0) > ours.strength(4.0));
        assert_eq!(paper.strength(0.5), paper.strength(4.9));
        assert!((paper.strength(7.0) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn weights_count_twice_in_the_published_program_only() {
        let once = RepulsionParams {
            fidelity: Fidelity::Ours,
            ..RepulsionParams::paper()
        };
        let twice = RepulsionParams::paper();
        let repulsors = [(1.0, 0.0, 0.5)];
        assert!((push(&repulsors, &twice) - push(&repulsors, &once) * 0.5).norm() < 1e-12);
    }

    #[test]
    fn the_push_never_exceeds_its_speed_and_ignores_what_it_cannot_use() {
        let params = RepulsionParams::default();
        let crowd = [(0.1, 0.0, 9.0); 20];
        assert!(push(&crowd, &params).norm() <= params.speed);
        assert_eq!(push(&[], &params), Vector2::zeros());
        let junk = [
            (f64::NAN, 0.0, 1.0),
            (0.0, 0.0, 1.0),
            (1.0, 0.0, f64::NAN),
            (1.0, 0.0, 0.0),
        ];
        assert_eq!(push(&junk, &params), Vector2::zeros());
        assert_eq!(
            push(&[(1.0, 0.0, 0.0)], &RepulsionParams::paper()),
            Vector2::zeros()
        );
    }
}
