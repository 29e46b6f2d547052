//! Parameters of the planners of sub-goals.

use coverage::tour::{Iterations, Route};
use coverage::transit::Transit;
use generators::{Emission, Key, KeyKind};
use guidance::params::{ParamsError, not_negative, positive, require};
use guidance::path_tracking::TrackingParams;
use guidance::waypoint_driver::DriverParams;
use serde::{Deserialize, Serialize};

/// How the robot gets from sub-goal to sub-goal (Chebyshev coverage paper, Fig. 9).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight legs; it stops and turns at each sub-goal. Goes around obstacles that its range
    /// sensor sees.
    #[default]
    Linear,
    /// Arcs in place of the corners where they fit; it passes by the sub-goals. Knows only the
    /// obstacles of the map.
    Arc,
}

/// Parameters that all planners of sub-goals share.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FollowParams {
    /// How far rectangles may stick out of the obstacles that they stand for [m], ≥ 10⁻⁶.
    pub tolerance: f64,
    /// Distance that the robot's body keeps from obstacles and walls where it is planned to be [m],
    /// ≥ 0: a robot on wheels strays from its legs.
    pub margin: f64,
    /// The way between sub-goals.
    pub interpolation: Interpolation,
    /// Arcs of less than this radius are left out: the robot turns on the spot [m], ≥ 0.
    pub least_radius: f64,
    /// How straight legs are driven.
    pub driver: DriverParams,
    /// How arcs are driven; `arrived` is also the tolerance of corners that are no arcs.
    pub tracking: TrackingParams,
}

impl Default for FollowParams {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            margin: 0.05,
            interpolation: Interpolation::default(),
            least_radius: 0.02,
            driver: DriverParams::default(),
            tracking: TrackingParams {
                look_ahead: 0.1,
                look_ahead_time_s: 0.2,
                ..TrackingParams::default()
            },
        }
    }
}

impl FollowParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path of the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        let least = coverage::workplace::LEAST_TOLERANCE;
        require(
            self.tolerance >= least && self.tolerance.is_finite(),
            "tolerance",
            &self.tolerance,
            "a finite number of at least 0.000001 [m]",
        )?;
        not_negative("margin", self.margin)?;
        not_negative("least_radius", self.least_radius)?;
        self.driver.validate().map_err(|e| e.within("driver"))?;
        self.tracking.validate().map_err(|e| e.within("tracking"))?;
        positive("tracking.speed_fraction", self.tracking.speed_fraction)
    }
}

/// A bridge between rectangles that share no border.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeParams {
    /// The rectangles that it joins, by number.
    pub between: [usize; 2],
    /// Its corner with the smaller coordinates [m].
    pub min: [f64; 2],
    /// Its corner with the larger coordinates [m].
    pub max: [f64; 2],
}

/// Parameters of the chaotic coverage planner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChebyshevParams {
    /// Generator and key, such as `chebp-raw:123,456`; absent: `map` with a key made from the seed
    /// of the run.
    pub key: Option<Key>,
    /// Generator for which a key is made: `chebp`, `chebp-raw`, `chebf64`, `logistic`, `standard`,
    /// `henon`, `catp`, `keyed`, …
    pub map: KeyKind,
    /// Order of the rectangles in a large loop.
    pub route: Route,
    /// Sub-goals of a large loop.
    pub iterations: Iterations,
    /// How to get from one rectangle to the next.
    pub transit: Transit,
    /// Large loops; 0 for loops without end.
    pub loops: u32,
    /// Bridges besides those across borders.
    pub bridges: Vec<BridgeParams>,
    /// What all planners of sub-goals share.
    pub follow: FollowParams,
}

impl Default for ChebyshevParams {
    fn default() -> Self {
        Self {
            key: None,
            map: KeyKind::ChebP(Emission::Arcsine),
            route: Route::default(),
            iterations: Iterations::InAll(200),
            transit: Transit::default(),
            loops: 0,
            bridges: Vec::new(),
            follow: FollowParams::default(),
        }
    }
}

impl ChebyshevParams {
    /// Checks every field that can be checked without the map.
    ///
    /// # Errors
    /// [`ParamsError`] with the path of the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        if let Some(key) = &self.key
            && let Err(error) = key.validate()
        {
            return Err(ParamsError::new("key", &error, "a sound key"));
        }
        let none = match &self.iterations {
            Iterations::InAll(n) | Iterations::Each(n) => *n == 0,
            Iterations::By(numbers) => numbers.iter().all(|&n| n == 0),
        };
        require(!none, "iterations", &0, "at least one sub-goal")?;
        require(
            self.transit != Transit::Wait { cap: 0 },
            "transit.wait.cap",
            &0,
            "at least 1 sub-goal",
        )?;
        self.follow.validate().map_err(|e| e.within("follow"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_read_as_a_scenario_writes_them() {
        let text = "
            key = \"chebp-raw:123,456\"
            route = { cycle = [1, 2, 0] }
            iterations = { by = [90, 90, 30] }
            transit = { wait = { cap = 1000 } }
            loops = 10
            bridges = [{ between = [0, 1], min = [3.1, 0.1], max = [6.9, 9.9] }]
            [follow]
            interpolation = \"arc\"
            driver = { time_limit_factor = 3.0 }
        ";
        let params: ChebyshevParams = toml::from_str(text).unwrap();
        params.validate().unwrap();
        assert_eq!(params.transit, Transit::Wait { cap: 1000 });
        assert_eq!(params.follow.interpolation, Interpolation::Arc);
        let again: ChebyshevParams = toml::from_str(&toml::to_string(&params).unwrap()).unwrap();
        assert_eq!(again, params);
        ChebyshevParams::default().validate().unwrap();
        assert!(toml::from_str::<ChebyshevParams>("loop = 1").is_err());
    }

    #[test]
    fn values_out_of_range_are_named() {
        let refusal = |text: &str| {
            let params: ChebyshevParams = toml::from_str(text).unwrap();
            params.validate().unwrap_err().to_string()
        };
        assert!(refusal("key = \"chebp:5,5\"").starts_with("`key` is"));
        assert!(refusal("iterations = { each = 0 }").starts_with("`iterations` is 0"));
        assert!(refusal("transit = { wait = { cap = 0 } }").starts_with("`transit.wait.cap`"));
        assert!(refusal("follow = { tolerance = 0.0 }").starts_with("`follow.tolerance` is 0"));
        assert!(refusal("follow = { margin = -1.0 }").starts_with("`follow.margin` is -1"));
    }
}
