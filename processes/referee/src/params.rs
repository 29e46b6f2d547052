//! Parameters of the referee.

use navigation::dominance::DominanceParams;
use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, not_negative, within};

/// Parameters of a [`Referee`](crate::Referee).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RefereeParams {
    /// Time between two verdicts [s], ≥ 0, rounded to whole ticks; 0 for a verdict in every tick.
    pub period_s: f64,
    /// Time between two pictures of who reaches what first [s], ≥ 0, rounded to whole ticks; 0 for
    /// no pictures.
    pub cells_period_s: f64,
    /// How finely it is computed.
    pub dominance: DominanceParams,
}

impl Default for RefereeParams {
    fn default() -> Self {
        Self {
            period_s: 0.25,
            cells_period_s: 1.0,
            dominance: DominanceParams::default(),
        }
    }
}

impl RefereeParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        not_negative("period_s", self.period_s)?;
        not_negative("cells_period_s", self.cells_period_s)?;
        self.dominance.validate().map_err(within("dominance"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_carry_the_path_of_the_field_and_unknown_keys_are_refused() {
        RefereeParams::default().validate().unwrap();
        let params: RefereeParams = toml::from_str("dominance = { pitch = -0.1 }").unwrap();
        let error = params.validate().unwrap_err();
        assert_eq!(
            error.to_string(),
            "`dominance.pitch` is -0.1, but must be a finite number above 0"
        );
        assert!(toml::from_str::<RefereeParams>("periods = 1").is_err());
    }
}
