//! Parameters of the referee.

use navigation::dominance::DominanceParams;
use parameters::{Parameters, at_least};

parameters::table! {
    /// Parameters of a [`Referee`](crate::Referee).
    #[derive(Copy)]
    pub struct RefereeParams {
        /// Time between two verdicts, rounded to whole ticks; 0 for a verdict in every tick.
        pub period_s: f64 [at_least(0).unit("s")] = 0.25,
        /// Time between two pictures of the dominance regions, rounded to whole ticks; 0 for no
        /// pictures.
        pub cells_period_s: f64 [at_least(0).unit("s")] = 1.0,
        /// Resolution of the computation.
        pub dominance: DominanceParams,
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
