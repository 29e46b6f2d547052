//! Parameters of the reach–avoid evader.

use avoidance::potential_field::ObstacleParams;
use control::feedback_linearisation::FeedbackParams;
use navigation::dominance::DominanceParams;
use parameters::{Parameters, above, at_least};

parameters::table! {
    /// Parameters of an [`Evader`](crate::Evader).
    #[derive(Copy)]
    pub struct ReachAvoidParams {
        /// Time between two plans.
        pub period_s: f64 [above(0).unit("s")] = 0.25,
        /// Without a safe way out: its own speed in its plans, as a fraction of its top speed: below 1,
        /// since these plans ignore the time that turning takes.
        pub speed_fraction: f64 [above(0).at_most(1)] = 0.9,
        /// Without a safe way out: distance beyond the capture radius that its plans keep from where
        /// pursuers could be.
        pub avoid_radius: f64 [at_least(0).unit("m")] = 0.1,
        /// Without a safe way out: maximum useful lead over the pursuers at a place.
        pub enough_s: f64 [at_least(0).unit("s")] = 6.0,
        /// Without a safe way out: lead (s) that it gives up for being a second's drive nearer to the
        /// exit.
        pub exit_weight: f64 [at_least(0)] = 0.5,
        /// Without a safe way out: largest distance along its path to the point that it heads for.
        pub sight: f64 [above(0).unit("m")] = 4.0,
        /// Without a safe way out: distance kept from obstacles beyond the robot's radius where the path
        /// is cut short at corners.
        pub margin: f64 [at_least(0).unit("m")] = 0.05,
        /// Resolution of the plans.
        pub dominance: DominanceParams,
        /// Repulsion from obstacles.
        pub obstacle: ObstacleParams,
        /// Gap to another body at which it begins to turn aside to pass it; 0 for never.
        pub body_guard: f64 [at_least(0).unit("m")] = 0.3,
        /// Conversion of the field to a command.
        pub feedback: FeedbackParams,
    }
}

impl Parameters for ReachAvoidParams {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn errors_carry_the_path_of_the_field_and_unknown_keys_are_refused() {
        check(&ReachAvoidParams::default()).unwrap();
        for (text, field) in [
            ("period_s = 0", "period_s"),
            ("speed_fraction = 1.01", "speed_fraction"),
            ("speed_fraction = nan", "speed_fraction"),
            ("enough_s = -1", "enough_s"),
            ("dominance = { pitch = inf }", "dominance.pitch"),
        ] {
            let params: ReachAvoidParams = toml::from_str(text).unwrap();
            assert_eq!(check(&params).unwrap_err().field, field);
        }
        assert!(toml::from_str::<ReachAvoidParams>("periods = 1").is_err());
    }
}
