//! Attraction to goals.

use geometry::math;
use nalgebra::{Point2, Vector2};

use super::FIELD_SPEED;
use navigation::bearing::Bearings;

/// Each goal pulls with tanh(`SHARPNESS` · distance) (1/m): nearly 1 except at short distances.
const SHARPNESS: f64 = 3.0;

/// A point that attracts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Position (m).
    pub at: Point2<f64>,
    /// Weight among the goals, ≥ 0.
    pub weight: f64,
}

/// The attraction of several goals at a point (m/s).
///
/// The weighted sum of the unit vectors towards the goals gives the direction; the magnitude is
/// [`FIELD_SPEED`]. Goals closer than 1 mm, and goals with invalid coordinates or weight, do not
/// count; without any the attraction is zero.
pub fn attraction(
    at: Point2<f64>,
    goals: impl IntoIterator<Item = Goal>,
    bearings: &Bearings<'_>,
) -> Vector2<f64> {
    let mut pull = Vector2::zeros();
    let mut total = 0.0;
    for goal in goals {
        if !(goal.weight.is_finite() && goal.weight > 0.0) {
            continue;
        }
        let Some(bearing) = bearings.bearing(at, goal.at) else {
            continue;
        };
        pull += bearing.direction * (goal.weight * math::tanh(SHARPNESS * bearing.distance));
        total += goal.weight;
    }
    let norm = pull.norm();
    // Below this the pulls of several goals cancel, and their direction is rounding error.
    if norm.is_finite() && norm > 1e-9 * total {
        pull * (FIELD_SPEED / norm)
    } else {
        Vector2::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORIGIN: Point2<f64> = Point2::new(0.0, 0.0);

    fn goals(goals: &[(f64, f64, f64)]) -> impl Iterator<Item = Goal> {
        goals.iter().map(|&(x, y, weight)| Goal {
            at: Point2::new(x, y),
            weight,
        })
    }

    fn pull(of: &[(f64, f64, f64)]) -> Vector2<f64> {
        attraction(ORIGIN, goals(of), &Bearings::Straight)
    }

    #[test]
    fn one_goal_pulls_with_constant_magnitude() {
        for distance in [0.01, 0.3, 4.0, 1e6] {
            let got = pull(&[(distance, 0.0, 0.3)]);
            assert!((got - Vector2::new(2.0, 0.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn many_goals_pull_towards_where_most_of_their_weight_lies() {
        let got = pull(&[(5.0, 0.0, 1.0), (0.0, 5.0, 3.0)]);
        assert!((math::atan2(got.y, got.x) - math::atan2(3.0, 1.0)).abs() < 1e-9);
    }

    #[test]
    fn cancelling_and_unusable_goals_do_not_pull() {
        assert_eq!(pull(&[]), Vector2::zeros());
        assert_eq!(pull(&[(2.0, 0.0, 1.0), (-2.0, 0.0, 1.0)]), Vector2::zeros());
        assert_eq!(
            pull(&[(f64::NAN, 0.0, 1.0), (1.0, 0.0, f64::NAN)]),
            Vector2::zeros()
        );
        assert_eq!(pull(&[(1.0, 0.0, -1.0), (0.0, 0.0, 1.0)]), Vector2::zeros());
    }
}
