//! Parameters of sensors and filters, with defaults, the paper's preset and validation.

use core::f64::consts::TAU;

use geometry::pose::Pose2;
use parameters::{Fidelity, Parameters, ParamsError, above, at_least, between, require, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::motion_limits::MotionLimits;

/// Measurement of an opponent's heading.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum HeadingModel {
    /// None: the heading is inferred from the motion.
    #[default]
    None,
    /// The true heading.
    Exact,
    /// The true heading plus Gaussian noise.
    Noisy {
        /// Standard deviation.
        #[schemars(transform = above(0).unit("rad"))]
        sigma: f64,
    },
}

parameters::table! {
    /// The line-of-sight sensor (chasing-game paper, section III.C).
    pub struct SensorParams {
        /// Visibility below which an opponent is unseen.
        pub unseen_below: f64 [between(0, 1)] = 1e-3,
        /// Visibility above which the position is measured exactly, at least `unseen_below`.
        pub exact_above: f64 [between(0, 1)] = 0.999,
        /// Factor g of the noise σ = g·(1/V − 1) of x and of y.
        pub sigma_gain: f64 [above(0).unit("m")] = 1.0,
        /// Measurement of the heading.
        pub heading: HeadingModel = HeadingModel::None,
        /// Maximum range of an observer; unlimited if absent.
        pub range: Option<f64> [above(0).unit("m")],
        /// Full opening angle of an observer's field of view, centred on its heading; all round if absent.
        pub field_of_view: Option<f64> [above(0).at_most(TAU).unit("rad")],
    }
}

parameters::choice! {
    /// Knowledge of an opponent before the first sighting.
    pub enum StartKnowledge {
        /// Its start pose: all particles begin there (the paper's).
        #[default]
        Known,
        /// Nothing: the particles begin uniformly over the free space that no observer sees in the first tick.
        Unknown,
    }
}

parameters::table! {
    /// The particle filter of one opponent (chasing-game paper, section III.D).
    ///
    /// Random walks are given per √s, rates per second: the belief does not depend on the tick rate.
    pub struct FilterParams {
        /// Number of particles.
        pub particles: usize [between(1, MAX_PARTICLES)] = 400,
        /// Knowledge of the opponent's start.
        pub start: StartKnowledge = StartKnowledge::Known,
        /// Random walk of the speed hypothesis.
        pub speed_walk: f64 [at_least(0).unit("largest speed per √s")] = 0.65,
        /// Random walk of the turning-rate hypothesis.
        pub turn_walk: f64 [at_least(0).unit("largest turning rate per √s")] = 1.0,
        /// Rate at which the speed hypothesis returns to the maximum speed; 0 for a pure random walk, as in the
        /// paper. Evaders and pursuers usually drive at full speed.
        pub cruise_rate: f64 [at_least(0).unit("1/s")] = 0.5,
        /// Rate at which the turning-rate hypothesis returns to 0; 0 for a pure random walk, as in the paper, with
        /// which hypotheses circle in place while the opponent drives on.
        pub straighten_rate: f64 [at_least(0).unit("1/s")] = 8.0,
        /// Maximum speed of a hypothesis as a share of the opponent's, and a tenth of that backwards; absent:
        /// the opponent's own limits. The published program multiplies speeds by the maximum twice:
        /// its hypotheses reach a fifth of the real speed.
        pub speed_limit: Option<f64> [above(0).at_most(1)],
        /// Maximum turning rate of a hypothesis when lower than the opponent's own; absent: the
        /// opponent's.
        pub turn_limit: Option<f64> [above(0).unit("rad/s")],
        /// `true` if an unseen hypothesis that would drive into an obstacle turns away from it; `false` if it is
        /// ruled out, as in the paper: then hypotheses that hardly move outlive the others.
        pub turn_at_walls: bool = true,
        /// Deviation by which a noisy sighting scatters the hypotheses in x and in y, as a share of its own; 0 for none, as in the
        /// paper. Without it, hypotheses behind an opponent at full speed hardly catch up with it: none is faster.
        pub scatter: f64 [between(0, 1)] = 0.0,
        /// Variant of the filter. [`Fidelity::Published`]: walks that stay at the ends of their ranges;
        /// weights N(x)·N(y)/(1 + |Δheading|) of a noisy sighting, equal ones of an exact sighting; and
        /// copies of one particle when no particle is possible.
        pub fidelity: Fidelity = Fidelity::Ours,
    }
}

parameters::table! {
    /// All parameters of perception.
    pub struct PerceptionParams {
        /// The sensor.
        pub sensor: SensorParams,
        /// The particle filters.
        pub filter: FilterParams,
    }
}

impl Parameters for PerceptionParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.sensor.check_relations().map_err(within("sensor"))
    }
}

impl PerceptionParams {
    /// The experiments' parameters: 30 particles, the exact heading in every sighting, uniform steps of ±25 %
    /// of the maximum speed and ±40 % of the maximum turning rate of a hypothesis per 0.05 s, and the
    /// published program's traits.
    pub fn paper() -> Self {
        Self {
            sensor: SensorParams {
                heading: HeadingModel::Exact,
                ..SensorParams::default()
            },
            filter: FilterParams {
                particles: 30,
                start: StartKnowledge::Known,
                // Half-widths of uniform steps at 20 Hz: √(20/3) times as much per √s.
                speed_walk: 0.25 * 2.581_988_897_471_611,
                turn_walk: 0.4 * 2.581_988_897_471_611,
                cruise_rate: 0.0,
                straighten_rate: 0.0,
                speed_limit: Some(0.2),
                turn_limit: Some(0.5),
                turn_at_walls: false,
                scatter: 0.0,
                fidelity: Fidelity::Published,
            },
        }
    }
}

impl Parameters for SensorParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            self.exact_above >= self.unseen_below,
            "exact_above",
            &self.exact_above,
            "between `unseen_below` and 1",
        )
    }
}

/// Speed backwards as a share of the speed forwards, for hypotheses with a limited speed.
const REVERSE_SHARE: f64 = 0.1;

/// Maximum number of particles of a filter.
pub const MAX_PARTICLES: usize = 1_000_000;

impl Parameters for FilterParams {}

impl FilterParams {
    /// Returns the start pose of an opponent as far as the filter may know it.
    pub fn known_start(&self, start: Pose2) -> Option<Pose2> {
        (self.start == StartKnowledge::Known).then_some(start)
    }

    /// Limits of the hypotheses about an opponent with these limits.
    pub(crate) fn narrowed(&self, own: MotionLimits) -> MotionLimits {
        let (v_max, v_reverse_max) = match self.speed_limit {
            None => (own.v_max, own.v_reverse_max),
            Some(share) => (share * own.v_max, REVERSE_SHARE * share * own.v_max),
        };
        MotionLimits {
            v_max,
            v_reverse_max,
            omega_max: own.omega_max.min(self.turn_limit.unwrap_or(f64::INFINITY)),
        }
    }
}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn defaults_and_the_papers_preset_are_valid() {
        assert_eq!(check(&PerceptionParams::default()), Ok(()));
        assert_eq!(check(&PerceptionParams::paper()), Ok(()));
    }

    #[test]
    fn a_bad_value_is_named_with_what_was_expected() {
        let bad = |change: fn(&mut PerceptionParams)| {
            let mut params = PerceptionParams::default();
            change(&mut params);
            check(&params).unwrap_err().to_string()
        };
        assert_eq!(
            bad(|p| p.filter.particles = 0),
            "`filter.particles` is 0: expected a whole number between 1 and 1000000"
        );
        assert_eq!(
            bad(|p| p.sensor.range = Some(-2.0)),
            "`sensor.range` is -2: expected a finite number above 0 (m)"
        );
        assert!(bad(|p| p.sensor.exact_above = 0.0).starts_with("`sensor.exact_above` is 0:"));
        assert!(bad(|p| p.sensor.field_of_view = Some(7.0)).contains("at most 2π (rad)"));
        assert!(bad(|p| p.filter.turn_walk = f64::NAN).contains("`filter.turn_walk` is NaN"));
        assert!(bad(|p| p.sensor.heading = HeadingModel::Noisy { sigma: 0.0 }).contains("noisy"));
    }
}
