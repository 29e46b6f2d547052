//! Parameters of adversaries.

use metrics::detection::DetectionRule;
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, above, at_least, between, each, require, unit, within};
use patrol::attack::{Method, Schedule, places_along};
use patrol::mission::MissionParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Longest duration, pause and window (s).
const MAX_TIME: f64 = 3600.0;

/// Parameters of adversaries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AttackerParams {
    /// Names of the robots that guard the places; empty: all.
    pub watch: Vec<String>,
    /// The adversaries, each with one method and independent of the others.
    #[schemars(length(min = 1))]
    pub methods: Vec<Method>,
    /// Duration of an attack.
    #[schemars(transform = above(0).at_most(MAX_TIME).unit("s"))]
    pub duration_s: f64,
    /// Distance from the place at which a guard detects an attack.
    #[schemars(transform = at_least(0).unit("m"))]
    pub distance: f64,
    /// Range at which a guard with a free line of sight detects an attack; if absent, guards do not see.
    #[schemars(transform = above(0).unit("m"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sight: Option<f64>,
    /// The places; empty: those along the contour of `mission`.
    #[schemars(transform = each(each(unit("m"))))]
    pub places: Vec<[f64; 2]>,
    /// Distance of the places along that contour.
    #[schemars(transform = above(0).unit("m"))]
    pub step: f64,
    /// Time in which an adversary only watches.
    #[schemars(transform = at_least(0).unit("s"))]
    pub first_s: f64,
    /// Time from the end of an attack until an adversary looks for the next one.
    #[schemars(transform = at_least(0).at_most(MAX_TIME).unit("s"))]
    pub pause_s: f64,
    /// Time in which an adversary then begins an attack.
    #[schemars(transform = at_least(0).at_most(MAX_TIME).unit("s"))]
    pub window_s: f64,
    /// Number of keys that `best_response` draws for each attack.
    #[schemars(transform = between(1, 1000))]
    pub samples: u32,
    /// Task of the guards, if they patrol a contour: its parameters but the key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mission: Option<MissionParams>,
}

impl Default for AttackerParams {
    fn default() -> Self {
        Self {
            watch: Vec::new(),
            methods: vec![Method::Random],
            duration_s: 20.0,
            distance: 1.0,
            sight: None,
            places: Vec::new(),
            step: 1.0,
            first_s: 300.0,
            pause_s: 10.0,
            window_s: 60.0,
            samples: 32,
            mission: None,
        }
    }
}

impl Parameters for AttackerParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let mut methods = self.methods.clone();
        methods.sort_unstable();
        methods.dedup();
        require(
            methods.len() == self.methods.len(),
            "methods",
            &"a list with repetitions",
            "each method at most once",
        )?;
        let Some(mission) = &self.mission else {
            require(
                !self.methods.contains(&Method::BestResponse),
                "mission",
                &"absent",
                "the guards' task, which `best_response` knows",
            )?;
            return require(
                !self.places.is_empty(),
                "places",
                &"empty",
                "at least one place, or the guards' task in `mission`",
            );
        };
        require(
            mission.key.is_none(),
            "mission.key",
            &"given",
            "no key: an adversary does not know it",
        )?;
        mission.check_relations().map_err(within("mission"))
    }
}

impl AttackerParams {
    /// The places (m), at least one for valid parameters.
    pub fn places(&self) -> Vec<Point2<f64>> {
        let contour = self.mission.as_ref().and_then(|m| m.contour().ok());
        match contour {
            Some(contour) if self.places.is_empty() => places_along(&contour, self.step),
            _ => self.places.iter().map(|&place| place.into()).collect(),
        }
    }

    /// The times of attacks.
    pub fn schedule(&self) -> Schedule {
        Schedule {
            duration_s: self.duration_s,
            first_s: self.first_s,
            pause_s: self.pause_s,
            window_s: self.window_s,
        }
    }

    /// The way in which guards detect attacks.
    pub fn rule(&self) -> DetectionRule {
        DetectionRule {
            distance: self.distance,
            sight: self.sight.unwrap_or(0.0),
        }
    }
}
