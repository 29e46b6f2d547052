//! Parameters of the Braitenberg vehicle.

use parameters::{Fidelity, Parameters, above, between};

parameters::choice! {
    /// Function from the product of the front cones to a speed.
    pub enum SpeedGain {
        /// Divided by its value in the middle of an open street 1 m wide, so that the robot drives
        /// there at its highest speed.
        #[default]
        Normalised,
        /// Unchanged (the paper's experiments): at most 13 % of the highest speed in a 1 m street.
        Paper,
    }
}

parameters::table! {
    /// Parameters of [`Braitenberg`](crate::Braitenberg).
    #[derive(Copy)]
    pub struct BraitenbergParams {
        /// Function from the product of the front cones to a speed.
        pub speed_gain: SpeedGain = SpeedGain::Normalised,
        /// Turning rate at full asymmetry.
        pub turn_gain: f64 [above(0).unit("rad/s")] = 2.0,
        /// Maximum backward speed, as a fraction of the highest forward speed.
        pub reverse_fraction: f64 [between(0, 1)] = 0.1,
        /// Variant of the vehicle. [`Fidelity::Ours`]: it turns on the spot when it is blocked ahead.
        /// With the unmodified formula of [`Fidelity::Published`] a robot that faces a wall squarely
        /// stops for ever.
        pub fidelity: Fidelity = Fidelity::Ours,
    }
}

impl Parameters for BraitenbergParams {}

impl BraitenbergParams {
    /// Returns the values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            speed_gain: SpeedGain::Paper,
            turn_gain: 1.0,
            reverse_fraction: 1.0,
            fidelity: Fidelity::Published,
        }
    }
}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn both_presets_are_valid_and_differ() {
        check(&BraitenbergParams::default()).unwrap();
        check(&BraitenbergParams::paper()).unwrap();
        assert_ne!(BraitenbergParams::default(), BraitenbergParams::paper());
    }

    #[test]
    fn errors_name_the_field() {
        let bad = BraitenbergParams {
            turn_gain: 0.0,
            ..BraitenbergParams::default()
        };
        assert_eq!(
            check(&bad).unwrap_err().to_string(),
            "`turn_gain` is 0: expected a finite number above 0 (rad/s)"
        );
        let bad = BraitenbergParams {
            reverse_fraction: f64::NAN,
            ..BraitenbergParams::default()
        };
        assert_eq!(check(&bad).unwrap_err().field, "reverse_fraction");
    }

    #[test]
    fn a_table_refuses_unknown_keys() {
        let params: BraitenbergParams = toml::from_str("speed_gain = 'paper'").unwrap();
        assert_eq!(params.speed_gain, SpeedGain::Paper);
        assert!(toml::from_str::<BraitenbergParams>("speed = 1").is_err());
    }
}
