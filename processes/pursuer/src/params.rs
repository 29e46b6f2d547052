//! Parameters of a pursuer.

use guidance::bearing::GoalField;
use guidance::feedback_linearisation::FeedbackParams;
use guidance::navigation::NavParams;
use guidance::params::{ParamsError, finite, not_negative, positive, require, within};
use guidance::potential_field::{
    AttractionParams, ObstacleParams, PerturbationParams, RepulsionParams,
};
use serde::{Deserialize, Serialize};

mod tactics;

pub use tactics::{GoalMethod, GoalParams, MAX_POST_RADIUS, RoleParams};

/// Where knowledge of the opponents comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Knowledge {
    /// From the team's beliefs; an opponent without a belief is unknown.
    #[default]
    Belief,
    /// From the world's state, as if every opponent were always seen.
    Exact,
}

/// What of a belief attracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefGoals {
    /// Every hypothesis, each with its own look-ahead (the paper's): the robot goes where most of
    /// the probability lies.
    #[default]
    Particles,
    /// The mean of the hypotheses. Between two clusters it is where the target certainly is not.
    Mean,
    /// The mean of the heaviest cluster.
    Mode,
}

/// Who chases whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AssignmentMethod {
    /// Each pursuer takes the nearest evader and keeps it until it is caught or has escaped (the
    /// paper's).
    #[default]
    NearestSticky,
    /// All pursuers are matched with all evaders so that the sum of predicted interception times is
    /// least, with the pursuers spread evenly over the evaders; renewed every
    /// [`AssignmentParams::period_s`].
    Interception,
    /// Matched with the evaders as by `Interception`; then those on one evader are matched, at the
    /// least sum of driving times, with places that cut its ways to the exits off, and those for whom
    /// no place is left (one at least) drive at it. See [`crate::cut_off`].
    CutOff,
}

/// Parameters of the assignment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AssignmentParams {
    /// Who chases whom.
    pub method: AssignmentMethod,
    /// What positions of the evaders the assignment goes by.
    pub knowledge: Knowledge,
    /// Simulated time at which the first targets are taken [s], ≥ 0.
    pub delay_s: f64,
    /// Time between two assignments of the interception and cut-off methods [s], > 0.
    pub period_s: f64,
    /// Interception time that a change of target must gain [s], ≥ 0 (interception and cut-off
    /// methods); keeps two pursuers from swapping to and fro.
    pub switch_cost_s: f64,
    /// How far around itself a pursuer blocks a street [m], > 0 (cut-off method).
    pub block_radius: f64,
}

impl Default for AssignmentParams {
    fn default() -> Self {
        Self {
            method: AssignmentMethod::NearestSticky,
            knowledge: Knowledge::Belief,
            delay_s: 1.0,
            period_s: 1.0,
            switch_cost_s: 2.0,
            block_radius: 0.75,
        }
    }
}

/// How far ahead of a target the goal lies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LookAheadParams {
    /// Distance ahead of the target, along its heading, as a fraction of the range to it; ≥ 0.
    pub ratio: f64,
    /// Longest distance ahead [m], ≥ 0.
    pub max: f64,
    /// Whether the goal stays on this side of the first obstacle ahead of the target. The paper's
    /// may lie inside a block or beyond the arena's wall.
    pub stop_at_obstacles: bool,
}

impl Default for LookAheadParams {
    fn default() -> Self {
        Self {
            ratio: 0.7,
            max: 5.0,
            stop_at_obstacles: true,
        }
    }
}

/// Parameters of a [`Pursuer`](crate::Pursuer).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PursuerParams {
    /// Where knowledge of the target's pose comes from.
    pub knowledge: Knowledge,
    /// What of a belief attracts.
    pub belief_goals: BeliefGoals,
    /// Most hypotheses used as goals, ≥ 1; of more, evenly spaced ones are taken.
    pub max_particles: usize,
    /// Who chases whom.
    pub assignment: AssignmentParams,
    /// Who does something else.
    pub roles: RoleParams,
    /// How hypotheses become goals.
    pub goals: GoalParams,
    /// How far ahead of a target the goal lies.
    pub look_ahead: LookAheadParams,
    /// How directions to goals are measured.
    pub goal_field: GoalField,
    /// Attraction to goals.
    pub attraction: AttractionParams,
    /// Repulsion between pursuers, measured straight.
    pub scatter: RepulsionParams,
    /// Weight of each pursuer in the scatter, ≥ 0; 0 for none.
    pub scatter_weight: f64,
    /// Weight in the scatter of the body of each robot that no longer takes part but stands in the
    /// way, ≥ 0.
    pub wreck_weight: f64,
    /// Whether a pursuer repels itself too, as in the paper's experiments: a constant push along
    /// its heading.
    pub scatter_from_self: bool,
    /// Repulsion from obstacles.
    pub obstacle: ObstacleParams,
    /// Gap to another body [m] at which the robot begins to turn aside to pass it, ≥ 0; 0 for
    /// never (the paper).
    pub body_guard: f64,
    /// Push that varies with time.
    pub perturbation: PerturbationParams,
    /// Greatest magnitude of the summed field [m/s], > 0.
    pub field_cap: f64,
    /// From field to command.
    pub feedback: FeedbackParams,
    /// Graph of the ways, for `goal_field = "geodesic"`, the assignment's methods that predict, and
    /// the tactics.
    pub navigation: NavParams,
}

impl Default for PursuerParams {
    fn default() -> Self {
        Self {
            knowledge: Knowledge::Belief,
            belief_goals: BeliefGoals::Particles,
            max_particles: 30,
            assignment: AssignmentParams::default(),
            roles: RoleParams::default(),
            goals: GoalParams::default(),
            look_ahead: LookAheadParams::default(),
            goal_field: GoalField::Geodesic,
            attraction: AttractionParams::default(),
            scatter: RepulsionParams::default(),
            scatter_weight: 0.5,
            wreck_weight: 0.2,
            scatter_from_self: false,
            obstacle: ObstacleParams::default(),
            body_guard: 0.3,
            perturbation: PerturbationParams::default(),
            field_cap: 2.0,
            feedback: FeedbackParams::default(),
            navigation: NavParams::default(),
        }
    }
}

impl PursuerParams {
    /// Whether anything in these parameters goes by beliefs, so that a perception process must
    /// provide them.
    pub fn needs_beliefs(&self) -> bool {
        self.knowledge == Knowledge::Belief || self.assignment.knowledge == Knowledge::Belief
    }

    /// The values of the chasing-game paper's experiments with exact knowledge (its figure 2); set
    /// `knowledge` to [`Knowledge::Belief`] for those with a particle filter (figure 3), in which
    /// targets were still chosen by their true positions.
    pub fn paper() -> Self {
        Self {
            knowledge: Knowledge::Exact,
            belief_goals: BeliefGoals::Particles,
            max_particles: 100_000,
            assignment: AssignmentParams {
                knowledge: Knowledge::Exact,
                ..AssignmentParams::default()
            },
            roles: RoleParams::default(),
            goals: GoalParams::default(),
            look_ahead: LookAheadParams {
                stop_at_obstacles: false,
                ..LookAheadParams::default()
            },
            goal_field: GoalField::Straight,
            attraction: AttractionParams::paper(),
            scatter: RepulsionParams::paper(),
            scatter_weight: 0.5,
            wreck_weight: 0.0,
            scatter_from_self: true,
            obstacle: ObstacleParams::paper(),
            body_guard: 0.0,
            perturbation: PerturbationParams::paper(),
            field_cap: 2.0,
            feedback: FeedbackParams::paper(),
            navigation: NavParams::default(),
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path, the value and what was expected, for the first field that is
    /// out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        require(
            self.max_particles >= 1,
            "max_particles",
            &self.max_particles,
            "at least 1",
        )?;
        self.assignment.validate().map_err(within("assignment"))?;
        self.roles.validate().map_err(within("roles"))?;
        self.goals.validate().map_err(within("goals"))?;
        self.look_ahead.validate().map_err(within("look_ahead"))?;
        self.attraction.validate().map_err(within("attraction"))?;
        self.scatter.validate().map_err(within("scatter"))?;
        not_negative("scatter_weight", self.scatter_weight)?;
        not_negative("wreck_weight", self.wreck_weight)?;
        self.obstacle.validate().map_err(within("obstacle"))?;
        self.perturbation
            .validate()
            .map_err(within("perturbation"))?;
        positive("field_cap", self.field_cap)?;
        self.feedback.validate().map_err(within("feedback"))?;
        self.navigation.validate().map_err(within("navigation"))
    }
}

impl AssignmentParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        not_negative("delay_s", self.delay_s)?;
        positive("period_s", self.period_s)?;
        not_negative("switch_cost_s", self.switch_cost_s)?;
        positive("block_radius", self.block_radius)
    }
}

impl LookAheadParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        finite("ratio", self.ratio)?;
        not_negative("ratio", self.ratio)?;
        not_negative("max", self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_presets_are_valid_and_differ() {
        PursuerParams::default().validate().unwrap();
        PursuerParams::paper().validate().unwrap();
        assert_ne!(PursuerParams::default(), PursuerParams::paper());
    }

    #[test]
    fn errors_carry_the_path_of_the_field() {
        let mut params = PursuerParams::default();
        params.assignment.period_s = 0.0;
        let error = params.validate().unwrap_err();
        assert_eq!(
            error.to_string(),
            "assignment.period_s = 0: expected a finite number above 0"
        );
        let params = PursuerParams {
            max_particles: 0,
            ..PursuerParams::default()
        };
        assert_eq!(params.validate().unwrap_err().field, "max_particles");
    }

    #[test]
    fn a_table_names_options_in_snake_case_and_refuses_unknown_keys() {
        let text = "knowledge = 'exact'\ngoal_field = 'straight'\n\
                    [assignment]\nmethod = 'interception'\nperiod_s = 0.5\n\
                    [goals]\nmethod = 'interception'\n[roles]\nexit_guard = 2\n";
        let params: PursuerParams = toml::from_str(text).unwrap();
        assert_eq!(params.knowledge, Knowledge::Exact);
        assert_eq!(params.assignment.method, AssignmentMethod::Interception);
        assert_eq!(params.assignment.delay_s, 1.0);
        assert_eq!(params.goals.method, GoalMethod::Interception);
        assert_eq!(params.roles.exit_guard, 2);
        let cut_off: AssignmentParams = toml::from_str("method = 'cut_off'").unwrap();
        assert_eq!(cut_off.method, AssignmentMethod::CutOff);
        assert!(toml::from_str::<PursuerParams>("knowlege = 'exact'").is_err());
        assert!(toml::from_str::<PursuerParams>("[look_ahead]\nration = 1.0").is_err());
    }
}
