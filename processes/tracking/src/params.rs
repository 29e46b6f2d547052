//! Parameters of sensors and filters, with defaults, the paper's preset and validation.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A parameter out of its range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{field} = {value}: expected {expected}")]
pub struct ParamsError {
    /// Path of the field, such as `filter.particles`.
    pub field: &'static str,
    /// The offending value.
    pub value: f64,
    /// What was expected.
    pub expected: &'static str,
}

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

/// Sample size that follows the spread of the belief (KLD sampling, Fox 2003).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AdaptiveSize {
    /// Fewest particles, ≥ 1.
    pub least: usize,
    /// Most particles, ≥ `least`.
    pub most: usize,
    /// Side of a histogram bin in x and y [m], > 0.
    pub bin: f64,
    /// Histogram bins per turn of heading, ≥ 1.
    pub heading_bins: u32,
    /// Bound on the Kullback–Leibler divergence to the true distribution, > 0.
    pub divergence: f64,
    /// Quantile of the standard normal distribution at the wanted confidence (2.33 for 99 %).
    pub quantile: f64,
}

impl Default for AdaptiveSize {
    fn default() -> Self {
        Self {
            least: 100,
            most: 2000,
            bin: 0.25,
            heading_bins: 8,
            divergence: 0.05,
            quantile: 2.33,
        }
    }
}

/// The particle filter of one opponent (chasing-game paper, section III.D).
///
/// Random walks are given per √s, rates per second: the belief does not depend on the tick rate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FilterParams {
    /// Number of particles, 1…1 000 000 (the first tick's number if `adaptive` is given).
    pub particles: usize,
    /// Lets the number of particles follow the spread of the belief; fixed if absent.
    pub adaptive: Option<AdaptiveSize>,
    /// Random walk of the speed hypothesis [largest speed per √s], ≥ 0.
    pub speed_walk: f64,
    /// Random walk of the turning-rate hypothesis [largest turning rate per √s], ≥ 0.
    pub turn_walk: f64,
    /// Rate at which the speed hypothesis returns to `cruise_speed` [1/s], ≥ 0; 0 for a pure random
    /// walk, as the paper's. Who flees, or chases, does not stroll.
    pub cruise_rate: f64,
    /// Speed to which hypotheses return [largest speed], in [0, 1].
    pub cruise_speed: f64,
    /// Rate at which the turning-rate hypothesis returns to 0 [1/s], ≥ 0; 0 for a pure random walk,
    /// as the paper's, which lets hypotheses circle in place while the opponent drives on.
    pub straighten_rate: f64,
    /// Whether an unseen hypothesis that would drive into an obstacle turns away from it (true) or is
    /// ruled out (false, as in the paper: then those that hardly move outlive the others).
    pub turn_at_walls: bool,
    /// Factor on the speeds that are hypothesised; 1 is the opponent's real range. The original
    /// program multiplied by the speed twice: 0.2 reproduces that.
    pub speed_scale: f64,
    /// Whether a hypothesis that walks beyond the end of its range bounces back (true) or stays there
    /// (false; how many are at the end then depends on the tick rate).
    pub reflect: bool,
    /// How far hypotheses walk on beyond the largest speed and the largest turning rates, as a share
    /// of the range of speeds and of the turning rates to one side, ≥ 0. They move at the limit
    /// meanwhile: robots often do.
    pub saturation: f64,
    /// Rate at which a particle jumps to a nearby pose [1/s], ≥ 0.
    pub teleport_rate: f64,
    /// Largest jump in x and in y [m], ≥ 0.
    pub teleport_distance: f64,
    /// Largest jump of the heading [rad], ≥ 0.
    pub teleport_turn: f64,
    /// How often per second the factor 1 − V of an unseen opponent is applied [1/s], ≥ 0; 20 is
    /// once per tick of the experiments.
    pub clearing_rate: f64,
    /// Measurement noise below which all particles take the measured position [m], ≥ 0.
    pub snap_below: f64,
    /// Width of the likelihood that is applied before snapping [distance (angle) covered per tick at
    /// the largest speed (turning rate)], ≥ 0. It keeps the hypotheses that predicted the
    /// measurement, which is how headings are learned; 0 weighs all particles alike.
    pub snap_width: f64,
    /// Mean likelihood (1 for a perfect fit) below which the belief is given up and built anew, in
    /// [0, 1). A correct belief falls below it by bad luck with this probability per tick. At 0 it
    /// is given up only when no particle is possible.
    pub lost_below: f64,
    /// Distance added to what the opponent can have covered unseen when the belief is built anew
    /// around the last place where it was seen [m], ≥ 0.
    pub recovery_margin: f64,
    /// Effective sample size, as a share of the particles, below which they are resampled; from 1
    /// on at every tick.
    pub resample_below: f64,
    /// Whether the visibility of unseen particles is taken from a per-cell memo; pays from some
    /// 10 000 particles on. See [`crate::memo`].
    pub memo: bool,
}

impl Default for FilterParams {
    fn default() -> Self {
        Self {
            particles: 400,
            adaptive: None,
            speed_walk: 0.65,
            turn_walk: 1.0,
            cruise_rate: 0.5,
            cruise_speed: 1.0,
            straighten_rate: 8.0,
            turn_at_walls: true,
            speed_scale: 1.0,
            reflect: true,
            saturation: 0.25,
            teleport_rate: 0.25,
            teleport_distance: 1.0,
            teleport_turn: 0.5,
            clearing_rate: 20.0,
            snap_below: 0.01,
            snap_width: 0.15,
            lost_below: 1e-4,
            recovery_margin: 0.5,
            resample_below: 1.0,
            memo: false,
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
    /// steps of ±25 % of the largest speed and ±40 % of the largest turning rate per 0.05 s,
    /// hypotheses that stay at their limits, equal weights before snapping.
    ///
    /// The programming errors of the original are not part of it: hypothesised speeds reach the
    /// real limit (see [`FilterParams::speed_scale`]), and weights that are all zero are recovered
    /// from.
    pub fn paper() -> Self {
        Self {
            sensor: SensorParams {
                heading: HeadingModel::Exact,
                ..SensorParams::default()
            },
            filter: FilterParams {
                particles: 30,
                cruise_rate: 0.0,
                straighten_rate: 0.0,
                turn_at_walls: false,
                // Half-widths of uniform steps at 20 Hz: √(20/3) times as much per √s.
                speed_walk: 0.25 * 2.581_988_897_471_611,
                turn_walk: 0.4 * 2.581_988_897_471_611,
                reflect: false,
                saturation: 0.0,
                snap_width: 0.0,
                lost_below: 0.0,
                ..FilterParams::default()
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
        let unit = 0.0..=1.0;
        check("sensor.unseen_below", self.unseen_below, "0 to 1", |v| {
            unit.contains(&v)
        })?;
        check(
            "sensor.exact_above",
            self.exact_above,
            "sensor.unseen_below to 1",
            |v| (self.unseen_below..=1.0).contains(&v),
        )?;
        check(
            "sensor.sigma_gain",
            self.sigma_gain,
            "a length > 0 [m]",
            positive,
        )?;
        if let HeadingModel::Noisy { sigma } = self.heading {
            check(
                "sensor.heading.noisy.sigma",
                sigma,
                "an angle > 0 [rad]",
                positive,
            )?;
        }
        if let Some(range) = self.range {
            check("sensor.range", range, "a length > 0 [m]", positive)?;
        }
        if let Some(angle) = self.field_of_view {
            check(
                "sensor.field_of_view",
                angle,
                "an angle in (0, 2π] [rad]",
                |v| v > 0.0 && v <= core::f64::consts::TAU,
            )?;
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
        let count = |n: usize| (1..=MOST_PARTICLES).contains(&n);
        let n = self.particles;
        check("filter.particles", n as f64, "1 to 1000000", |_| count(n))?;
        for (field, value) in [
            ("filter.speed_walk", self.speed_walk),
            ("filter.turn_walk", self.turn_walk),
            ("filter.cruise_rate", self.cruise_rate),
            ("filter.straighten_rate", self.straighten_rate),
            ("filter.speed_scale", self.speed_scale),
            ("filter.teleport_rate", self.teleport_rate),
            ("filter.teleport_distance", self.teleport_distance),
            ("filter.teleport_turn", self.teleport_turn),
            ("filter.clearing_rate", self.clearing_rate),
            ("filter.saturation", self.saturation),
            ("filter.snap_below", self.snap_below),
            ("filter.snap_width", self.snap_width),
            ("filter.recovery_margin", self.recovery_margin),
            ("filter.resample_below", self.resample_below),
        ] {
            check(field, value, "a finite number ≥ 0", |v| {
                v >= 0.0 && v.is_finite()
            })?;
        }
        check("filter.cruise_speed", self.cruise_speed, "0 to 1", |v| {
            (0.0..=1.0).contains(&v)
        })?;
        check(
            "filter.lost_below",
            self.lost_below,
            "at least 0 and below 1",
            |v| (0.0..1.0).contains(&v),
        )?;
        if let Some(a) = &self.adaptive {
            check(
                "filter.adaptive.least",
                a.least as f64,
                "1 to 1000000",
                |_| count(a.least),
            )?;
            check(
                "filter.adaptive.most",
                a.most as f64,
                "filter.adaptive.least to 1000000",
                |_| (a.least..=MOST_PARTICLES).contains(&a.most),
            )?;
            check("filter.adaptive.bin", a.bin, "a length > 0 [m]", positive)?;
            check(
                "filter.adaptive.heading_bins",
                f64::from(a.heading_bins),
                "1 to 1024",
                |_| (1..=1024).contains(&a.heading_bins),
            )?;
            check(
                "filter.adaptive.divergence",
                a.divergence,
                "a number > 0",
                positive,
            )?;
            check(
                "filter.adaptive.quantile",
                a.quantile,
                "a number > 0",
                positive,
            )?;
        }
        Ok(())
    }
}

fn positive(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

fn check(
    field: &'static str,
    value: f64,
    expected: &'static str,
    ok: impl Fn(f64) -> bool,
) -> Result<(), ParamsError> {
    if ok(value) {
        Ok(())
    } else {
        Err(ParamsError {
            field,
            value,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_and_the_papers_preset_are_valid() {
        assert_eq!(PerceptionParams::default().validate(), Ok(()));
        assert_eq!(PerceptionParams::paper().validate(), Ok(()));
        let adaptive = FilterParams {
            adaptive: Some(AdaptiveSize::default()),
            ..FilterParams::default()
        };
        assert_eq!(adaptive.validate(), Ok(()));
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
            "filter.particles = 0: expected 1 to 1000000"
        );
        assert_eq!(
            bad(|p| p.sensor.range = Some(-2.0)),
            "sensor.range = -2: expected a length > 0 [m]"
        );
        assert!(bad(|p| p.sensor.exact_above = 0.0).starts_with("sensor.exact_above = 0:"));
        assert!(bad(|p| p.sensor.field_of_view = Some(7.0)).contains("(0, 2π]"));
        assert!(bad(|p| p.filter.teleport_rate = f64::NAN).contains("teleport_rate = NaN"));
        assert!(bad(|p| p.filter.lost_below = 1.0).contains("lost_below"));
        assert!(bad(|p| p.sensor.heading = HeadingModel::Noisy { sigma: 0.0 }).contains("noisy"));
        assert!(
            bad(|p| p.filter.adaptive = Some(AdaptiveSize {
                most: 5,
                ..AdaptiveSize::default()
            }))
            .contains("filter.adaptive.most = 5")
        );
    }
}
