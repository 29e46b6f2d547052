//! What a kind of coverage planner must say of itself, and the chaotic one.

use coverage::decomposition::Decomposition;
use coverage::goal::GoalSource;
use coverage::plan::{CoveragePlan, PlanSpec};
use coverage::workplace::Workplace;
use generators::{AnySource, Key};
use nalgebra::Point2;
use serde::de::DeserializeOwned;
use sim_backend::shape::Aabb;

use crate::params::{ChebyshevParams, FollowParams};

/// The workplace that a robot finds itself in.
#[derive(Debug, Clone)]
pub struct Site {
    /// The workplace, for the robot's radius and margin.
    pub workplace: Workplace,
    /// Its free space.
    pub decomposition: Decomposition,
    /// Where the robot is [m], or the nearest place in free space.
    pub start: Point2<f64>,
}

/// A kind of coverage planner: how to make its sub-goals. The process does the rest.
pub trait Design {
    /// Its parameters.
    type Params: DeserializeOwned + Clone;
    /// Its sub-goals.
    type Goals: GoalSource;

    /// Checks the parameters.
    ///
    /// # Errors
    /// A text that names the parameter that does not do.
    fn validate(params: &Self::Params) -> Result<(), String>;

    /// The parameters that all kinds share.
    fn follow(params: &Self::Params) -> FollowParams;

    /// The sub-goals for a site; `seed` is the robot's own. `before` are those for the site that it
    /// replaces, if the map has changed: secrets and numbers go on from there.
    ///
    /// # Errors
    /// A text that says what does not fit the site.
    fn goals(
        params: &Self::Params,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String>;
}

/// Sub-goals from a chaotic map or a keyed stream, rectangle after rectangle.
#[derive(Debug)]
pub struct Chebyshev;

impl Design for Chebyshev {
    type Params = ChebyshevParams;
    type Goals = CoveragePlan<AnySource>;

    fn validate(params: &ChebyshevParams) -> Result<(), String> {
        params.validate().map_err(|e| e.to_string())
    }

    fn follow(params: &ChebyshevParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &ChebyshevParams,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String> {
        let mut decomposition = site.decomposition.clone();
        for bridge in &params.bridges {
            let rectangle = Aabb {
                min: Point2::from(bridge.min),
                max: Point2::from(bridge.max),
            };
            decomposition = decomposition
                .with_bridge(&site.workplace, bridge.between, rectangle)
                .map_err(|e| e.to_string())?;
        }
        let spec = PlanSpec {
            route: params.route.clone(),
            iterations: params.iterations.clone(),
            transit: params.transit,
            loops: params.loops,
        };
        let plan = if let Some(before) = before {
            before.moved(decomposition, site.start, &spec)
        } else {
            let key = params
                .key
                .unwrap_or_else(|| Key::from_seed(params.map, seed));
            let source = key.source().map_err(|e| e.to_string())?;
            CoveragePlan::new(decomposition, site.start, &spec, source)
        };
        plan.map_err(|e| e.to_string())
    }
}
