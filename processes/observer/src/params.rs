//! Parameters of an observer.

use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, not_negative, positive, require, within};
use tracking::params::FilterParams;

use crate::knowledge::{CatKnowledge, ChebyshevKnowledge};

/// Most times ahead.
const MOST_HORIZONS: usize = 32;
/// Longest time ahead [s].
const LONGEST_HORIZON: f64 = 600.0;

/// A method that needs no knowledge of how goals are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// A Kalman filter of constant velocity.
    Kalman,
    /// The particle filter of perception.
    Particles,
    /// What followed the most similar stretch of the way so far.
    SimilarStretch,
    /// The goal that followed the most similar one.
    SimilarGoal,
    /// The same, each coordinate for itself.
    SimilarGoalPerAxis,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Kalman,
        Self::Particles,
        Self::SimilarStretch,
        Self::SimilarGoal,
        Self::SimilarGoalPerAxis,
    ];
}

/// How well an observer sees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EyesParams {
    /// Standard deviation of x and of y [m], ≥ 0.
    pub noise: f64,
    /// Standard deviation of the heading [rad], ≥ 0.
    pub heading_noise: f64,
    /// Largest distance at which a robot is seen [m], > 0; unlimited if absent.
    pub range: Option<f64>,
}

impl Default for EyesParams {
    fn default() -> Self {
        Self {
            noise: 0.005,
            heading_noise: 0.005,
            range: None,
        }
    }
}

/// Parameters of an observer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ObserverParams {
    /// Names of the robots that it watches; empty: all that it does not look from.
    pub watch: Vec<String>,
    /// Fixed places from which it looks [m]. Without any, and without `from_robots`, it sees
    /// everything always.
    pub from_points: Vec<[f64; 2]>,
    /// Names of the robots from which it looks.
    pub from_robots: Vec<String>,
    /// How well it sees.
    pub eyes: EyesParams,
    /// Time between two messages [s], > 0, rounded to whole ticks.
    pub period_s: f64,
    /// How far ahead it predicts [s], each > 0, rounded to whole ticks.
    pub horizons_s: Vec<f64>,
    /// By which methods, besides those that the knowledge below allows.
    pub methods: Vec<Method>,
    /// Distance from its goal at which a watched robot turns to the next one [m], ≥ 0.
    pub arrival: f64,
    /// Spectral density of the acceleration in the Kalman filter [m²/s³], ≥ 0.
    pub acceleration: f64,
    /// The particle filters.
    pub filter: FilterParams,
    /// What is publicly known of a patrol with a cat map; its key is looked for if given.
    pub cat: Option<CatKnowledge>,
    /// What is publicly known of a coverage with Chebyshev maps; its key is looked for if given.
    pub chebyshev: Option<ChebyshevKnowledge>,
}

impl Default for ObserverParams {
    fn default() -> Self {
        Self {
            watch: Vec::new(),
            from_points: Vec::new(),
            from_robots: Vec::new(),
            eyes: EyesParams::default(),
            period_s: 0.25,
            horizons_s: vec![0.5, 1.0, 2.0, 5.0],
            methods: Method::ALL.to_vec(),
            arrival: 0.05,
            acceleration: 1.0,
            filter: FilterParams::default(),
            cat: None,
            chebyshev: None,
        }
    }
}

impl ObserverParams {
    /// Checks every field. That the names are those of robots is checked where the run is known.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        for (index, point) in self.from_points.iter().enumerate() {
            let [x, y] = point;
            require(
                point.iter().all(|c| c.is_finite()),
                &format!("from_points.{index}"),
                &format!("[{x}, {y}]"),
                "two finite numbers",
            )?;
        }
        not_negative("eyes.noise", self.eyes.noise)?;
        not_negative("eyes.heading_noise", self.eyes.heading_noise)?;
        if let Some(range) = self.eyes.range {
            positive("eyes.range", range)?;
        }
        positive("period_s", self.period_s)?;
        require(
            (1..=MOST_HORIZONS).contains(&self.horizons_s.len()),
            "horizons_s",
            &format!("{} numbers", self.horizons_s.len()),
            "1 to 32 numbers",
        )?;
        for (index, &horizon) in self.horizons_s.iter().enumerate() {
            require(
                horizon > 0.0 && horizon <= LONGEST_HORIZON,
                &format!("horizons_s.{index}"),
                &horizon,
                "a time above 0 and at most 600 s",
            )?;
        }
        require(
            !(self.methods.is_empty() && self.cat.is_none() && self.chebyshev.is_none()),
            "methods",
            &"empty",
            "at least one method, or knowledge in `cat` or `chebyshev`",
        )?;
        not_negative("arrival", self.arrival)?;
        not_negative("acceleration", self.acceleration)?;
        self.filter.validate()?;
        if let Some(cat) = &self.cat {
            cat.validate().map_err(within("cat"))?;
        }
        if let Some(chebyshev) = &self.chebyshev {
            chebyshev.validate().map_err(within("chebyshev"))?;
        }
        Ok(())
    }
}
