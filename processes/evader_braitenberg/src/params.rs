//! Parameters of the Braitenberg vehicle.

use guidance::params::{ParamsError, fraction, positive, require};
use serde::{Deserialize, Serialize};

/// How the product of the front cones becomes a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpeedGain {
    /// Divided by its value in the middle of an open street of `street_width`, so that the robot
    /// drives there at its highest speed.
    #[default]
    Normalised,
    /// As it is (the paper's experiments): at most 13 % of the highest speed in a 1 m street.
    Paper,
}

/// Parameters of [`Braitenberg`](crate::Braitenberg).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BraitenbergParams {
    /// How the product of the front cones becomes a speed.
    pub speed_gain: SpeedGain,
    /// Width of the street in which the normalised speed is the highest [m], > 0.
    pub street_width: f64,
    /// Free range ahead at which the normalised speed is the highest [m], above `stop_range`;
    /// lowered to the sensor's own longest range.
    pub open_range: f64,
    /// Range ahead at which the vehicle stops [m], ≥ 0.
    pub stop_range: f64,
    /// Width of a cone [rad], > 0.
    pub cone_width: f64,
    /// Which share of a cone's beams may be shorter than its reading, in [0, 1].
    pub percentile: f64,
    /// Turning rate at full asymmetry [rad/s], > 0.
    pub turn_gain: f64,
    /// Backward speed allowed, as a fraction of the highest forward speed, in [0, 1].
    pub reverse_fraction: f64,
    /// Whether the vehicle turns on the spot when it is blocked ahead. With the bare formula a
    /// robot that faces a wall squarely neither drives nor turns, for ever.
    pub break_deadlock: bool,
    /// Range ahead below which it counts as blocked [m]; above `stop_range`, which it would only
    /// approach ever more slowly.
    pub blocked_range: f64,
    /// Range ahead above which it no longer counts as blocked [m], above `blocked_range`.
    pub released_range: f64,
}

impl Default for BraitenbergParams {
    fn default() -> Self {
        Self {
            speed_gain: SpeedGain::Normalised,
            street_width: 1.0,
            open_range: 3.0,
            stop_range: 0.4,
            cone_width: 10.0_f64.to_radians(),
            percentile: 0.1,
            turn_gain: 2.0,
            reverse_fraction: 0.1,
            break_deadlock: true,
            blocked_range: 0.5,
            released_range: 0.9,
        }
    }
}

impl BraitenbergParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            speed_gain: SpeedGain::Paper,
            turn_gain: 1.0,
            reverse_fraction: 1.0,
            break_deadlock: false,
            ..Self::default()
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("street_width", self.street_width)?;
        guidance::params::not_negative("stop_range", self.stop_range)?;
        let above = |field, value: f64, below: f64, expected| {
            require(value.is_finite() && value > below, field, &value, expected)
        };
        above(
            "open_range",
            self.open_range,
            self.stop_range,
            "a finite number above stop_range",
        )?;
        positive("cone_width", self.cone_width)?;
        fraction("percentile", self.percentile)?;
        positive("turn_gain", self.turn_gain)?;
        fraction("reverse_fraction", self.reverse_fraction)?;
        let expected = "a finite number above stop_range";
        above(
            "blocked_range",
            self.blocked_range,
            self.stop_range,
            expected,
        )?;
        let expected = "a finite number above blocked_range";
        above(
            "released_range",
            self.released_range,
            self.blocked_range,
            expected,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_presets_are_valid_and_differ() {
        BraitenbergParams::default().validate().unwrap();
        BraitenbergParams::paper().validate().unwrap();
        assert_ne!(BraitenbergParams::default(), BraitenbergParams::paper());
    }

    #[test]
    fn errors_name_the_field() {
        let bad = BraitenbergParams {
            blocked_range: 0.4,
            ..BraitenbergParams::default()
        };
        assert_eq!(
            bad.validate().unwrap_err().to_string(),
            "blocked_range = 0.4: expected a finite number above stop_range"
        );
        let bad = BraitenbergParams {
            percentile: f64::NAN,
            ..BraitenbergParams::default()
        };
        assert_eq!(bad.validate().unwrap_err().field, "percentile");
    }

    #[test]
    fn a_table_refuses_unknown_keys() {
        let params: BraitenbergParams = toml::from_str("speed_gain = 'paper'").unwrap();
        assert_eq!(params.speed_gain, SpeedGain::Paper);
        assert!(toml::from_str::<BraitenbergParams>("speed = 1").is_err());
    }
}
