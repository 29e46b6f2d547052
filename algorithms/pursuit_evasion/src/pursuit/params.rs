//! Parameters of a pursuer.

use avoidance::potential_field::{ObstacleParams, PerturbationParams, RepulsionParams};
use control::feedback_linearisation::FeedbackParams;
use navigation::bearing::GoalField;
use parameters::{Fidelity, Parameters, above, at_least};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Source of information on the opponents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Knowledge {
    /// The team's beliefs; an opponent without a belief is unknown.
    #[default]
    Belief,
    /// The world's state, as if every opponent were always seen.
    Exact,
}

/// Part of a belief that attracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BeliefGoals {
    /// Every hypothesis, each with its own look-ahead (the paper's): the robot drives towards most
    /// of the probability.
    #[default]
    Particles,
    /// The mean of the hypotheses. Between two clusters the target is certainly not there.
    Mean,
    /// The mean of the heaviest cluster.
    Mode,
}

/// Method of assignment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AssignmentMethod {
    /// Each pursuer chases the nearest evader until it is caught or has escaped (the paper's).
    #[default]
    NearestSticky,
    /// All pursuers are matched with all evaders at the minimum sum of driving times, with the
    /// pursuers spread evenly over the evaders. Those on one evader are then
    /// matched, at the minimum sum of driving times, with places that cut off its paths to the
    /// exits. Pursuers without a place (at least one) drive at it. Renewed every
    /// [`AssignmentParams::period_s`]. See [`crate::pursuit::cut_off`].
    CutOff,
}

/// Parameters of the assignment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AssignmentParams {
    /// Assignment of pursuers to evaders.
    pub method: AssignmentMethod,
    /// Source of the evaders' positions for the assignment.
    pub knowledge: Knowledge,
    /// Simulated time of the first assignment.
    #[schemars(transform = at_least(0).unit("s"))]
    pub delay_s: f64,
    /// Time between two assignments of the cut-off method.
    #[schemars(transform = above(0).unit("s"))]
    pub period_s: f64,
    /// Radius around itself in which a pursuer blocks a street (cut-off method).
    #[schemars(transform = above(0).unit("m"))]
    pub block_radius: f64,
}

impl Default for AssignmentParams {
    fn default() -> Self {
        Self {
            method: AssignmentMethod::NearestSticky,
            knowledge: Knowledge::Belief,
            delay_s: 1.0,
            period_s: 1.0,
            block_radius: 0.75,
        }
    }
}

/// Parameters of a [`Pursuer`](super::Pursuer).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PursuerParams {
    /// Source of the target's pose.
    pub knowledge: Knowledge,
    /// Part of a belief that attracts.
    pub belief_goals: BeliefGoals,
    /// Maximum number of hypotheses used as goals; of more, evenly spaced ones are used.
    #[schemars(transform = at_least(1))]
    pub max_particles: usize,
    /// Assignment of pursuers to evaders.
    pub assignment: AssignmentParams,
    /// Distance measure of directions to goals.
    pub goal_field: GoalField,
    /// Repulsion between pursuers, measured straight.
    pub scatter: RepulsionParams,
    /// Weight of each pursuer in the scatter; 0 for none.
    #[schemars(transform = at_least(0))]
    pub scatter_weight: f64,
    /// Weight in the scatter of the body of each robot that no longer takes part but stands in the
    /// way.
    #[schemars(transform = at_least(0))]
    pub wreck_weight: f64,
    /// Variant of the method. [`Fidelity::Published`]: a pursuer repels itself, too, a constant
    /// push along its heading, and the goal ahead of a target may lie inside a block or beyond the
    /// arena's wall.
    pub fidelity: Fidelity,
    /// Repulsion from obstacles.
    pub obstacle: ObstacleParams,
    /// Gap to another body at which the robot begins to turn aside to pass it; 0 for never (the
    /// paper).
    #[schemars(transform = at_least(0).unit("m"))]
    pub body_guard: f64,
    /// Push that varies with time.
    pub perturbation: PerturbationParams,
    /// From field to command.
    pub feedback: FeedbackParams,
}

impl Default for PursuerParams {
    fn default() -> Self {
        Self {
            knowledge: Knowledge::Belief,
            belief_goals: BeliefGoals::Particles,
            max_particles: 30,
            assignment: AssignmentParams::default(),
            goal_field: GoalField::Geodesic,
            scatter: RepulsionParams::default(),
            scatter_weight: 0.5,
            wreck_weight: 0.2,
            fidelity: Fidelity::Ours,
            obstacle: ObstacleParams::default(),
            body_guard: 0.3,
            perturbation: PerturbationParams::default(),
            feedback: FeedbackParams::default(),
        }
    }
}

impl Parameters for PursuerParams {}

impl PursuerParams {
    /// Returns `true` if any of these parameters uses beliefs, so that a perception process must
    /// provide them.
    pub fn needs_beliefs(&self) -> bool {
        self.knowledge == Knowledge::Belief || self.assignment.knowledge == Knowledge::Belief
    }

    /// Returns the values of the chasing-game paper's experiments with exact knowledge (its figure
    /// 2). Set `knowledge` to [`Knowledge::Belief`] for those with a particle filter (figure 3), in
    /// which targets were still chosen by their true positions.
    pub fn paper() -> Self {
        Self {
            knowledge: Knowledge::Exact,
            belief_goals: BeliefGoals::Particles,
            max_particles: 100_000,
            assignment: AssignmentParams {
                knowledge: Knowledge::Exact,
                ..AssignmentParams::default()
            },
            goal_field: GoalField::Straight,
            scatter: RepulsionParams::paper(),
            scatter_weight: 0.5,
            wreck_weight: 0.0,
            fidelity: Fidelity::Published,
            obstacle: ObstacleParams::paper(),
            body_guard: 0.0,
            perturbation: PerturbationParams::paper(),
            feedback: FeedbackParams::paper(),
        }
    }
}

impl Parameters for AssignmentParams {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn both_presets_are_valid_and_differ() {
        check(&PursuerParams::default()).unwrap();
        check(&PursuerParams::paper()).unwrap();
        assert_ne!(PursuerParams::default(), PursuerParams::paper());
    }

    #[test]
    fn errors_carry_the_path_of_the_field() {
        let mut params = PursuerParams::default();
        params.assignment.period_s = 0.0;
        let error = check(&params).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`assignment.period_s` is 0: expected a finite number above 0 (s)"
        );
        let params = PursuerParams {
            max_particles: 0,
            ..PursuerParams::default()
        };
        assert_eq!(check(&params).unwrap_err().field, "max_particles");
    }

    #[test]
    fn a_table_names_options_in_snake_case_and_refuses_unknown_keys() {
        let text = "knowledge = 'exact'\ngoal_field = 'straight'\n\
                    [assignment]\nmethod = 'cut_off'\nperiod_s = 0.5\n";
        let params: PursuerParams = toml::from_str(text).unwrap();
        assert_eq!(params.knowledge, Knowledge::Exact);
        assert_eq!(params.assignment.method, AssignmentMethod::CutOff);
        assert_eq!(params.assignment.delay_s, 1.0);
        assert!(toml::from_str::<PursuerParams>("knowlege = 'exact'").is_err());
        assert!(toml::from_str::<PursuerParams>("[assignment]\nperiod = 1.0").is_err());
    }
}
