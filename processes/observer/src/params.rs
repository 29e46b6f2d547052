//! Parameters of an observer.

use parameters::{Parameters, ParamsError, above, at_least, each, require, unit, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tracking::params::FilterParams;

use crate::knowledge::{CatKnowledge, ChebyshevKnowledge};

/// Maximum number of horizons.
const MAX_HORIZONS: usize = 32;
/// Longest horizon (s).
const MAX_HORIZON: f64 = 600.0;

/// Method that does not use the rule of the goals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// A Kalman filter of constant velocity.
    Kalman,
    /// The particle filter of perception.
    Particles,
    /// The continuation of the most similar stretch of the path so far.
    SimilarStretch,
    /// The goal that followed the most similar one.
    SimilarGoal,
    /// The same, each coordinate separately.
    SimilarGoalPerAxis,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 5] = [
        Self::Kalman,
        Self::Particles,
        Self::SimilarStretch,
        Self::SimilarGoal,
        Self::SimilarGoalPerAxis,
    ];
}

parameters::table! {
    /// Accuracy of an observer's view.
    pub struct PoseSensorParams {
        /// Standard deviation of x and of y.
        pub noise: f64 [at_least(0).unit("m")] = 0.005,
        /// Standard deviation of the heading.
        pub heading_noise: f64 [at_least(0).unit("rad")] = 0.005,
        /// Largest distance at which a robot is seen; unlimited if absent.
        pub range: Option<f64> [above(0).unit("m")],
    }
}

impl Parameters for PoseSensorParams {}

parameters::table! {
    /// Parameters of an observer.
    pub struct ObserverParams {
        /// Names of the robots that it watches; empty: all but its viewpoints.
        pub watch: Vec<String>,
        /// Fixed viewpoints. Without any, and without `from_robots`, it sees everything always.
        pub from_points: Vec<[f64; 2]> [each(each(unit("m")))],
        /// Names of the robots that are viewpoints.
        pub from_robots: Vec<String>,
        /// Accuracy of its view.
        pub viewpoint: PoseSensorParams,
        /// Time between two messages, rounded to whole ticks.
        pub period_s: f64 [above(0).unit("s")] = 0.25,
        /// Prediction horizons, rounded to whole ticks.
        #[schemars(length(min = 1, max = MAX_HORIZONS), transform = each(above(0).at_most(MAX_HORIZON).unit("s")))]
        pub horizons_s: Vec<f64> = vec![0.5, 1.0, 2.0, 5.0],
        /// Prediction methods, besides those that the knowledge below allows.
        pub methods: Vec<Method> = Method::ALL.to_vec(),
        /// Distance from its goal at which a watched robot turns to the next one.
        pub arrival: f64 [at_least(0).unit("m")] = 0.05,
        /// Spectral density of the acceleration in the Kalman filter.
        pub acceleration: f64 [at_least(0).unit("m²/s³")] = 1.0,
        /// The particle filters.
        pub filter: FilterParams,
        /// Public knowledge of a patrol with a cat map. If given, the observer searches for its key.
        pub cat: Option<CatKnowledge>,
        /// Public knowledge of a coverage with Chebyshev maps. If given, the observer searches for its
        /// key.
        pub chebyshev: Option<ChebyshevKnowledge>,
    }
}

impl Parameters for ObserverParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            !(self.methods.is_empty() && self.cat.is_none() && self.chebyshev.is_none()),
            "methods",
            &"empty",
            "at least one method, or knowledge in `cat` or `chebyshev`",
        )?;
        if let Some(cat) = &self.cat {
            cat.check_relations().map_err(within("cat"))?;
        }
        if let Some(chebyshev) = &self.chebyshev {
            chebyshev.check_relations().map_err(within("chebyshev"))?;
        }
        Ok(())
    }
}
