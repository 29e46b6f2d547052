//! Parameters of the potential-field evader.

use avoidance::potential_field::{ObstacleParams, PerturbationParams, RepulsionParams};
use control::feedback_linearisation::FeedbackParams;
use navigation::bearing::GoalField;
use parameters::{Parameters, above, at_least};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Extra cost of paths that pass the Police (`goal_field = "geodesic"` only).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ThreatParams {
    /// Extra cost per metre of path at distance `reach` from a pursuer, falling with the square of
    /// the distance; 0 for none.
    #[schemars(transform = at_least(0))]
    pub gain: f64,
    /// Distance at which `gain` applies.
    #[schemars(transform = above(0).unit("m"))]
    pub reach: f64,
    /// Time between two searches for a better path past the Police.
    #[schemars(transform = above(0).unit("s"))]
    pub period_s: f64,
}

impl Default for ThreatParams {
    fn default() -> Self {
        Self {
            gain: 3.0,
            reach: 1.5,
            period_s: 0.5,
        }
    }
}

/// Parameters of an [`Evader`](super::Evader).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EvaderParams {
    /// Measure of the path to the exit.
    pub goal_field: GoalField,
    /// Extra cost of paths that pass the Police.
    pub threat: ThreatParams,
    /// Repulsion from other robots.
    pub avoid: RepulsionParams,
    /// Measure of directions and distances to those robots: along paths, the distance of a pursuer
    /// behind a block is the length of its path, and its push comes from the corner around which it
    /// would come.
    pub avoid_field: GoalField,
    /// Weight of each pursuer.
    #[schemars(transform = at_least(0))]
    pub police_weight: f64,
    /// Weight of each teammate.
    #[schemars(transform = at_least(0))]
    pub teammate_weight: f64,
    /// Weight of the body of each robot that no longer takes part but blocks the path.
    #[schemars(transform = at_least(0))]
    pub wreck_weight: f64,
    /// Repulsion from obstacles.
    pub obstacle: ObstacleParams,
    /// Gap to another body at which the robot begins to turn aside to pass it; 0 to disable (the
    /// paper).
    #[schemars(transform = at_least(0).unit("m"))]
    pub body_guard: f64,
    /// Time-variant push.
    pub perturbation: PerturbationParams,
    /// Conversion of the field to a command.
    pub feedback: FeedbackParams,
}

impl Default for EvaderParams {
    fn default() -> Self {
        Self {
            goal_field: GoalField::Geodesic,
            threat: ThreatParams::default(),
            // Above the attraction at short distances, so that no exit attracts an evader to a
            // pursuer.
            avoid: RepulsionParams {
                reach: 1.0,
                speed: 4.0,
                ..RepulsionParams::default()
            },
            avoid_field: GoalField::Geodesic,
            police_weight: 1.5,
            teammate_weight: 0.3,
            wreck_weight: 0.2,
            obstacle: ObstacleParams::default(),
            body_guard: 0.3,
            perturbation: PerturbationParams::default(),
            feedback: FeedbackParams::default(),
        }
    }
}

impl Parameters for EvaderParams {}

impl EvaderParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            goal_field: GoalField::Straight,
            threat: ThreatParams {
                gain: 0.0,
                ..ThreatParams::default()
            },
            avoid: RepulsionParams::paper(),
            avoid_field: GoalField::Straight,
            police_weight: 1.5,
            teammate_weight: 0.8,
            wreck_weight: 0.0,
            obstacle: ObstacleParams::paper(),
            body_guard: 0.0,
            perturbation: PerturbationParams::paper(),
            feedback: FeedbackParams::paper(),
        }
    }
}

impl Parameters for ThreatParams {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn both_presets_are_valid_and_differ() {
        check(&EvaderParams::default()).unwrap();
        check(&EvaderParams::paper()).unwrap();
        assert_ne!(EvaderParams::default(), EvaderParams::paper());
    }

    #[test]
    fn errors_carry_the_path_of_the_field() {
        let mut params = EvaderParams::default();
        params.avoid.reach = f64::NAN;
        let error = check(&params).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`avoid.reach` is NaN: expected a finite number above 0 (m)"
        );
    }

    #[test]
    fn a_table_may_set_single_values_and_refuses_unknown_keys() {
        let params: EvaderParams =
            toml::from_str("police_weight = 2\n[avoid]\nfalloff = 'plateau'\n").unwrap();
        assert_eq!(params.police_weight, 2.0);
        assert_eq!(
            params.teammate_weight,
            EvaderParams::default().teammate_weight
        );
        assert!(toml::from_str::<EvaderParams>("police_wait = 2").is_err());
        assert!(toml::from_str::<EvaderParams>("[threat]\nrange = 2").is_err());
    }
}
