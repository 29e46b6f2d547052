//! Parameters of the chaotic coverage planner.

use chaotic_maps::{Emission, Key, KeyKind};
use coverage::sub_goals::FollowParams;
use coverage::tour::{Iterations, Route};
use coverage::transit::Transit;
use parameters::{Parameters, ParamsError, each, require, unit, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A bridge between rectangles that share no border.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BridgeParams {
    /// Numbers of the rectangles that it joins.
    pub between: [usize; 2],
    /// Its corner with the smaller coordinates.
    #[schemars(transform = each(unit("m")))]
    pub min: [f64; 2],
    /// Its corner with the larger coordinates.
    #[schemars(transform = each(unit("m")))]
    pub max: [f64; 2],
}

parameters::table! {
    /// Parameters of the chaotic coverage planner.
    pub struct ChebyshevParams {
        /// Generator and key, such as `chebp-raw:123,456`; absent: `map` with a key made from the seed
        /// of the run.
        pub key: Option<Key>,
        /// Generator of the key if none is given: `chebp`, `chebp-raw`, `chebf64`, `logistic`,
        /// `standard`, `catp`, `keyed`, …
        pub map: KeyKind = KeyKind::ChebP(Emission::Arcsine),
        /// Order of the rectangles in a large loop.
        pub route: Route,
        /// Sub-goals of a large loop.
        pub iterations: Iterations = Iterations::InAll(200),
        /// Transit from one rectangle to the next.
        pub transit: Transit,
        /// Number of large loops; 0 for no limit.
        pub loops: u32 = 0,
        /// Bridges besides those across borders.
        pub bridges: Vec<BridgeParams>,
        /// Parameters that all planners of sub-goals share.
        pub follow: FollowParams,
    }
}

impl Parameters for ChebyshevParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        if let Some(key) = &self.key {
            key.validate()?;
        }
        let none = match &self.iterations {
            Iterations::InAll(n) | Iterations::Each(n) => *n == 0,
            Iterations::By(numbers) => numbers.iter().all(|&n| n == 0),
        };
        require(!none, "iterations", &0, "at least one sub-goal")?;
        self.follow.check_relations().map_err(within("follow"))
    }
}

#[cfg(test)]
mod tests {
    use parameters::check;

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
        check(&params).unwrap();
        assert_eq!(params.transit, Transit::Wait { cap: 1000 });
        assert_eq!(
            params.follow.interpolation,
            coverage::sub_goals::Interpolation::Arc
        );
        let again: ChebyshevParams = toml::from_str(&toml::to_string(&params).unwrap()).unwrap();
        assert_eq!(again, params);
        check(&ChebyshevParams::default()).unwrap();
        assert!(toml::from_str::<ChebyshevParams>("loop = 1").is_err());
    }

    #[test]
    fn values_out_of_range_are_named() {
        let refusal = |text: &str| {
            let params: ChebyshevParams = toml::from_str(text).unwrap();
            check(&params).unwrap_err().to_string()
        };
        assert!(refusal("key = \"chebp:5,5\"").starts_with("`key`: "));
        assert!(refusal("iterations = { each = 0 }").starts_with("`iterations` is 0"));
        assert!(refusal("transit = { wait = { cap = 0 } }").starts_with("`transit.wait.cap`"));
        assert!(refusal("follow = { tolerance = 0.0 }").starts_with("`follow.tolerance` is 0"));
        assert!(refusal("follow = { margin = -1.0 }").starts_with("`follow.margin` is -1"));
    }
}
