//! Parameters of the referee.

use navigation::dominance::DominanceParams;
use parameters::{Parameters, at_least};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of a [`Referee`](crate::Referee).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RefereeParams {
    /// Time between two verdicts, rounded to whole ticks; 0 for a verdict in every tick.
    #[schemars(transform = at_least(0).unit("s"))]
    pub period_s: f64,
    /// Time between two pictures of the dominance regions, rounded to whole ticks; 0 for no
    /// pictures.
    #[schemars(transform = at_least(0).unit("s"))]
    pub cells_period_s: f64,
    /// Resolution of the computation.
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

impl Parameters for RefereeParams {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn errors_carry_the_path_of_the_field_and_unknown_keys_are_refused() {
        check(&RefereeParams::default()).unwrap();
        let params: RefereeParams = toml::from_str("dominance = { pitch = -0.1 }").unwrap();
        let error = check(&params).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`dominance.pitch` is -0.1: expected a finite number above 0 (m)"
        );
        assert!(toml::from_str::<RefereeParams>("periods = 1").is_err());
    }
}
