//! Parameters of the reach–avoid evader.

use navigation::dominance::DominanceParams;
use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, not_negative, positive, require, within};
use steering::feedback_linearisation::FeedbackParams;
use steering::potential_field::ObstacleParams;

/// Parameters of an [`Evader`](crate::Evader).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReachAvoidParams {
    /// Time between two plans [s], > 0.
    pub period_s: f64,
    /// Its own speed in its plans, as a fraction of its top speed, in (0, 1]: below 1, since plans
    /// know nothing of the time that turning takes.
    pub speed_fraction: f64,
    /// Distance beyond the capture radius that its plans keep from where pursuers could be [m], ≥ 0.
    pub keep_away: f64,
    /// Without a safe way out: time by which it wants to be anywhere before the pursuers [s], ≥ 0;
    /// more is worth no more.
    pub enough_s: f64,
    /// Without a safe way out: seconds of that time that it gives for being a second's drive nearer
    /// to the exit, ≥ 0.
    pub exit_weight: f64,
    /// How far along its way it looks for the point to head for [m], > 0.
    pub sight: f64,
    /// Distance kept from obstacles beyond the robot's radius, when it cuts corners of its way [m],
    /// ≥ 0.
    pub margin: f64,
    /// How finely plans are computed.
    pub dominance: DominanceParams,
    /// Repulsion from obstacles.
    pub obstacle: ObstacleParams,
    /// Gap to another body [m] at which it begins to turn aside to pass it, ≥ 0; 0 for never.
    pub body_guard: f64,
    /// From field to command.
    pub feedback: FeedbackParams,
}

impl Default for ReachAvoidParams {
    fn default() -> Self {
        Self {
            period_s: 0.25,
            speed_fraction: 0.9,
            keep_away: 0.1,
            enough_s: 6.0,
            exit_weight: 0.5,
            sight: 4.0,
            margin: 0.05,
            dominance: DominanceParams::default(),
            obstacle: ObstacleParams::default(),
            body_guard: 0.3,
            feedback: FeedbackParams::default(),
        }
    }
}

impl ReachAvoidParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path, the value and what was expected, for the first field that is
    /// out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("period_s", self.period_s)?;
        require(
            self.speed_fraction > 0.0 && self.speed_fraction <= 1.0,
            "speed_fraction",
            &self.speed_fraction,
            "a number above 0 and at most 1",
        )?;
        not_negative("keep_away", self.keep_away)?;
        not_negative("enough_s", self.enough_s)?;
        not_negative("exit_weight", self.exit_weight)?;
        positive("sight", self.sight)?;
        not_negative("margin", self.margin)?;
        self.dominance.validate().map_err(within("dominance"))?;
        parameters::check(&self.obstacle).map_err(within("obstacle"))?;
        not_negative("body_guard", self.body_guard)?;
        parameters::check(&self.feedback).map_err(within("feedback"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_carry_the_path_of_the_field_and_unknown_keys_are_refused() {
        ReachAvoidParams::default().validate().unwrap();
        for (text, field) in [
            ("period_s = 0", "period_s"),
            ("speed_fraction = 1.01", "speed_fraction"),
            ("speed_fraction = nan", "speed_fraction"),
            ("enough_s = -1", "enough_s"),
            ("dominance = { pitch = inf }", "dominance.pitch"),
        ] {
            let params: ReachAvoidParams = toml::from_str(text).unwrap();
            assert_eq!(params.validate().unwrap_err().field, field);
        }
        assert!(toml::from_str::<ReachAvoidParams>("periods = 1").is_err());
    }
}
