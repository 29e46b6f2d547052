//! Parameters of sensors and filters, with defaults, the paper's preset and validation.

use serde::{Deserialize, Serialize};
use sim_backend::params::{Fidelity, ParamsError, fraction, not_negative, positive, require};

/// What the sensor tells about an opponent's heading.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum HeadingModel {
    /// Nothing: the heading is inferred from the motion.
    #[default]
    None,
    /// The true heading.
    Exact,
    /// The true heading plus Gaussian noise.
    Noisy {
        /// Standard deviation [rad], > 0.
        sigma: f64,
    },
}

/// The line-of-sight sensor (chasing-game paper, section III.C).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorParams {
    /// Visibility below which an opponent is unseen, 0…1.
    pub unseen_below: f64,
    /// Visibility above which the position is measured exactly, `unseen_below`…1.
    pub exact_above: f64,
    /// Factor g of the noise σ = g·(1/V − 1) of x and of y [m], > 0.
    pub sigma_gain: f64,
    /// What is measured of the heading.
    pub heading: HeadingModel,
    /// Largest distance at which an observer sees [m], > 0; unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle of an observer's field of view, centred on its heading [rad], in (0, 2π];
    /// all round if absent.
    pub field_of_view: Option<f64>,
}

impl Default for SensorParams {
    fn default() -> Self {
        Self {
            unseen_below: 1e-3,
            exact_above: 0.999,
            sigma_gain: 1.0,
            heading: HeadingModel::None,
            range: None,
            field_of_view: None,
        }
    }
}

/// The particle filter of one opponent (chasing-game paper, section III.D).
///
/// Random walks are given per √s, rates per second: the belief does not depend on the tick rate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FilterParams {
    /// Number of particles, 1…1 000 000.
    pub particles: usize,
    /// Random walk of the speed hypothesis [largest speed per √s], ≥ 0.
    pub speed_walk: f64,
    /// Random walk of the turning-rate hypothesis [largest turning rate per √s], ≥ 0.
    pub turn_walk: f64,
    /// Rate at which the speed hypothesis returns to the largest speed [1/s], ≥ 0; 0 for a pure
    /// random walk, as the paper's. Who flees, or chases, does not stroll.
    pub cruise_rate: f64,
    /// Rate at which the turning-rate hypothesis returns to 0 [1/s], ≥ 0; 0 for a pure random walk,
    /// as the paper's, which lets hypotheses circle in place while the opponent drives on.
    pub straighten_rate: f64,
    /// Whether an unseen hypothesis that would drive into an obstacle turns away from it (true) or is
    /// ruled out (false, as in the paper: then those that hardly move outlive the others).
    pub turn_at_walls: bool,
    /// [`Fidelity::Published`]: walks that stay at the ends of their ranges, equal weights before
    /// snapping, and a belief that is given up only when no particle is possible.
    pub fidelity: Fidelity,
}

impl Default for FilterParams {
    fn default() -> Self {
        Self {
            particles: 400,
            speed_walk: 0.65,
            turn_walk: 1.0,
            cruise_rate: 0.5,
            straighten_rate: 8.0,
            turn_at_walls: true,
            fidelity: Fidelity::Ours,
        }
    }
}

/// All parameters of perception.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PerceptionParams {
    /// The sensor.
    pub sensor: SensorParams,
    /// The particle filters.
    pub filter: FilterParams,
}

impl PerceptionParams {
    /// The experiments' parameters: 30 particles, the exact heading in every sighting, uniform
    /// steps of ±25 % of the largest speed and ±40 % of the largest turning rate per 0.05 s, and
    /// the published program's traits.
    ///
    /// The programming errors of the original are not part of it: hypothesised speeds reach the
    /// real limit, and weights that are all zero are recovered from.
    pub fn paper() -> Self {
        Self {
            sensor: SensorParams {
                heading: HeadingModel::Exact,
                ..SensorParams::default()
            },
            filter: FilterParams {
                particles: 30,
                // Half-widths of uniform steps at 20 Hz: √(20/3) times as much per √s.
                speed_walk: 0.25 * 2.581_988_897_471_611,
                turn_walk: 0.4 * 2.581_988_897_471_611,
                cruise_rate: 0.0,
                straighten_rate: 0.0,
                turn_at_walls: false,
                fidelity: Fidelity::Published,
            },
        }
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`ParamsError`] with the first field out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.sensor.validate()?;
        self.filter.validate()
    }
}

impl SensorParams {
    fn validate(&self) -> Result<(), ParamsError> {
        fraction("sensor.unseen_below", self.unseen_below)?;
        require(
            (self.unseen_below..=1.0).contains(&self.exact_above),
            "sensor.exact_above",
            &self.exact_above,
            "between sensor.unseen_below and 1",
        )?;
        positive("sensor.sigma_gain", self.sigma_gain)?;
        if let HeadingModel::Noisy { sigma } = self.heading {
            positive("sensor.heading.noisy.sigma", sigma)?;
        }
        if let Some(range) = self.range {
            positive("sensor.range", range)?;
        }
        if let Some(angle) = self.field_of_view {
            let expected = "an angle in (0, 2π] [rad]";
            let ok = angle > 0.0 && angle <= core::f64::consts::TAU;
            require(ok, "sensor.field_of_view", &angle, expected)?;
        }
        Ok(())
    }
}

/// Most particles of a filter.
pub const MOST_PARTICLES: usize = 1_000_000;

impl FilterParams {
    /// Checks every range.
    ///
    /// # Errors
    /// [`ParamsError`] with the first field out of range, as a path from `filter`.
    pub fn validate(&self) -> Result<(), ParamsError> {
        let ok = (1..=MOST_PARTICLES).contains(&self.particles);
        require(ok, "filter.particles", &self.particles, "1 to 1000000")?;
        not_negative("filter.speed_walk", self.speed_walk)?;
        not_negative("filter.turn_walk", self.turn_walk)?;
        not_negative("filter.cruise_rate", self.cruise_rate)?;
        not_negative("filter.straighten_rate", self.straighten_rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_and_the_papers_preset_are_valid() {
        assert_eq!(PerceptionParams::default().validate(), Ok(()));
        assert_eq!(PerceptionParams::paper().validate(), Ok(()));
    }

    #[test]
    fn a_bad_value_is_named_with_what_was_expected() {
        let bad = |change: fn(&mut PerceptionParams)| {
            let mut params = PerceptionParams::default();
            change(&mut params);
            params.validate().unwrap_err().to_string()
        };
        assert_eq!(
            bad(|p| p.filter.particles = 0),
            "`filter.particles` is 0, but must be 1 to 1000000"
        );
        assert_eq!(
            bad(|p| p.sensor.range = Some(-2.0)),
            "`sensor.range` is -2, but must be a finite number above 0"
        );
        assert!(bad(|p| p.sensor.exact_above = 0.0).starts_with("`sensor.exact_above` is 0,"));
        assert!(bad(|p| p.sensor.field_of_view = Some(7.0)).contains("(0, 2π]"));
        assert!(bad(|p| p.filter.turn_walk = f64::NAN).contains("`filter.turn_walk` is NaN"));
        assert!(bad(|p| p.sensor.heading = HeadingModel::Noisy { sigma: 0.0 }).contains("noisy"));
    }
}
