//! Parameters of a team's tactics: goals and guards of the exits.

use parameters::{Parameters, above, at_least};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum distance of a guard pose from its exit (m); the work per tick grows with its square.
pub const MAX_POST_RADIUS: f64 = 5.0;

/// Position of the goal for a hypothesis of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GoalMethod {
    /// Somewhat ahead of the target, see [`crate::goals::look_ahead`] (the paper's).
    #[default]
    LookAhead,
    /// At the earliest place where this pursuer can meet the target: in its line of sight on the
    /// target's straight course (the Apollonius circle), else on the target's shortest path to the
    /// nearest exit, driven at its highest speed. See [`crate::interception`]. Without a meeting,
    /// the goal is that of the look-ahead.
    Interception,
}

/// Conversion of hypotheses of a target to goals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GoalParams {
    /// Position of the goal for a hypothesis.
    pub method: GoalMethod,
    /// Distance at which a target counts as met: the capture radius of the rules, or less. Used by
    /// all predictions of interceptions for goals and guards.
    #[schemars(transform = at_least(0).unit("m"))]
    pub reach: f64,
}

impl Default for GoalParams {
    fn default() -> Self {
        Self {
            method: GoalMethod::LookAhead,
            reach: 0.3,
        }
    }
}

impl Parameters for GoalParams {}

/// Roles other than chasing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RoleParams {
    /// Number of pursuers that guard the exits instead of chasing; 0 for none. A number above that
    /// of the pursuers means all of them. See [`crate::exit_guard`].
    pub exit_guard: usize,
    /// Distance to an exit's centre at which a target has escaped.
    #[schemars(transform = at_least(0).unit("m"))]
    pub exit_radius: f64,
    /// Maximum distance of a guard from its exit's centre.
    #[schemars(transform = above(0).at_most(MAX_POST_RADIUS).unit("m"))]
    pub post_radius: f64,
    /// Time to spare, at its guard pose and for every target, with which a guard may leave it for a
    /// capture.
    #[schemars(transform = at_least(0).unit("s"))]
    pub margin_s: f64,
}

impl Default for RoleParams {
    fn default() -> Self {
        Self {
            exit_guard: 0,
            exit_radius: 0.5,
            post_radius: 1.0,
            margin_s: 2.0,
        }
    }
}

impl Parameters for RoleParams {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn distant_guard_poses_and_negative_distances_are_rejected() {
        let mut roles = RoleParams::default();
        check(&roles).unwrap();
        roles.post_radius = 5.5;
        assert_eq!(check(&roles).unwrap_err().field, "post_radius");
        let goals = GoalParams {
            reach: -0.1,
            ..GoalParams::default()
        };
        assert_eq!(check(&goals).unwrap_err().field, "reach");
    }
}
