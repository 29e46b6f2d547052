//! Attraction to goals.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};
use sim_backend::math;

use super::PAPER_FIELD_SPEED;
use crate::bearing::Bearings;
use crate::params::{ParamsError, positive};

/// A point that attracts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Where it is [m].
    pub at: Point2<f64>,
    /// How much it counts among the goals, ≥ 0.
    pub weight: f64,
}

/// Parameters of the attraction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttractionParams {
    /// Magnitude of the attraction [m/s], > 0.
    pub speed: f64,
    /// Each goal pulls with tanh(`sharpness` · distance) [1/m], > 0: nearly 1 except close by.
    pub sharpness: f64,
    /// Whether the pull also weakens, with the same tanh, when all goals are close, so that the
    /// robot comes to rest. The paper's does not: its sum is normalised to constant magnitude.
    pub slow_at_goal: bool,
}

impl Default for AttractionParams {
    fn default() -> Self {
        Self {
            speed: PAPER_FIELD_SPEED,
            sharpness: 3.0,
            slow_at_goal: false,
        }
    }
}

impl AttractionParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self::default()
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("speed", self.speed)?;
        positive("sharpness", self.sharpness)
    }
}

/// The attraction of several goals at a point [m/s].
///
/// The weighted sum of the unit vectors towards the goals gives the direction; the magnitude is
/// `speed` (see [`AttractionParams::slow_at_goal`]). Goals closer than 1 mm, and goals whose
/// coordinates or weight cannot be used, do not count; without any the attraction is zero.
pub fn attraction(
    at: Point2<f64>,
    goals: impl IntoIterator<Item = Goal>,
    bearings: &Bearings<'_>,
    params: &AttractionParams,
) -> Vector2<f64> {
    let mut pull = Vector2::zeros();
    let mut total = 0.0;
    for goal in goals {
        if !(goal.weight.is_finite() && goal.weight > 0.0) {
            continue;
        }
        let Some(bearing) = bearings.of(at, goal.at) else {
            continue;
        };
        pull += bearing.direction * (goal.weight * math::tanh(params.sharpness * bearing.distance));
        total += goal.weight;
    }
    let norm = pull.norm();
    // Below this the pulls of several goals cancel, and their direction is rounding error.
    if !norm.is_finite() || norm <= 1e-9 * total {
        return Vector2::zeros();
    }
    let magnitude = if params.slow_at_goal {
        params.speed * (norm / total).min(1.0)
    } else {
        params.speed
    };
    pull * (magnitude / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORIGIN: Point2<f64> = Point2::new(0.0, 0.0);

    fn pull(goals: &[(f64, f64, f64)], params: &AttractionParams) -> Vector2<f64> {
        let goals = goals.iter().map(|&(x, y, weight)| Goal {
            at: Point2::new(x, y),
            weight,
        });
        attraction(ORIGIN, goals, &Bearings::Straight, params)
    }

    #[test]
    fn one_goal_pulls_with_constant_magnitude() {
        let params = AttractionParams::default();
        for distance in [0.01, 0.3, 4.0, 1e6] {
            let got = pull(&[(distance, 0.0, 0.3)], &params);
            assert!((got - Vector2::new(2.0, 0.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn slowing_weakens_the_pull_near_the_goal_only() {
        let params = AttractionParams {
            slow_at_goal: true,
            ..AttractionParams::default()
        };
        assert!(pull(&[(0.02, 0.0, 1.0)], &params).norm() < 0.13);
        assert!(pull(&[(3.0, 0.0, 1.0)], &params).norm() > 1.999);
    }

    #[test]
    fn many_goals_pull_towards_where_most_of_their_weight_lies() {
        let params = AttractionParams::default();
        let got = pull(&[(5.0, 0.0, 1.0), (0.0, 5.0, 3.0)], &params);
        assert!((math::atan2(got.y, got.x) - math::atan2(3.0, 1.0)).abs() < 1e-9);
    }

    #[test]
    fn cancelling_and_unusable_goals_do_not_pull() {
        let params = AttractionParams::default();
        assert_eq!(pull(&[], &params), Vector2::zeros());
        assert_eq!(
            pull(&[(2.0, 0.0, 1.0), (-2.0, 0.0, 1.0)], &params),
            Vector2::zeros()
        );
        assert_eq!(
            pull(&[(f64::NAN, 0.0, 1.0), (1.0, 0.0, f64::NAN)], &params),
            Vector2::zeros()
        );
        assert_eq!(
            pull(&[(1.0, 0.0, -1.0), (0.0, 0.0, 1.0)], &params),
            Vector2::zeros()
        );
    }
}
