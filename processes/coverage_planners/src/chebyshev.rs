//! Covers a workplace by chaotic sub-goals, rectangle after rectangle (Chebyshev coverage paper).

pub mod params;

#[cfg(test)]
mod tests;

use crate::design::Design;
use crate::error::DesignError;
use crate::follower::Follower;
use chaotic_maps::{AnySource, Key};
use coverage::decomposition::{BridgeError, Decomposition};
use coverage::plan::{CoveragePlan, PlanSpec};
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::Site;
use coverage::tour::{Iterations, Route};
use geometry::shape::Aabb;
use nalgebra::Point2;

pub use params::ChebyshevParams;

/// Process of the chaotic coverage planner.
pub type ChebyshevPlanner = Follower<Chebyshev>;

/// Sub-goals from a chaotic map or a keyed stream, rectangle after rectangle.
#[derive(Debug)]
pub struct Chebyshev;

impl Chebyshev {
    /// Returns the free space of a site with the bridges of the parameters.
    ///
    /// # Errors
    /// [`BridgeError`] names the invalid bridge.
    pub fn lay_out(params: &ChebyshevParams, site: &Site) -> Result<Decomposition, BridgeError> {
        let mut decomposition = site.decomposition.clone();
        for bridge in &params.bridges {
            let rectangle = Aabb {
                min: Point2::from(bridge.min),
                max: Point2::from(bridge.max),
            };
            decomposition =
                decomposition.with_bridge(&site.workplace, bridge.between, rectangle)?;
        }
        Ok(decomposition)
    }
}

impl Design for Chebyshev {
    const NAME: &'static str = "coverage_chebyshev";
    const SUMMARY: &'static str =
        "covers a workplace by chaotic sub-goals, rectangle after rectangle";

    type Params = ChebyshevParams;
    type Goals = CoveragePlan<AnySource>;

    fn follow(params: &ChebyshevParams) -> FollowParams {
        let by_number = matches!(params.route, Route::Cycle(_))
            || matches!(params.iterations, Iterations::By(_))
            || !params.bridges.is_empty();
        let divide = params.follow.divide && !by_number;
        FollowParams {
            divide,
            ..params.follow
        }
    }

    fn goals(
        params: &ChebyshevParams,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, DesignError> {
        let decomposition = Self::lay_out(params, site)?;
        let spec = PlanSpec {
            route: params.route.clone(),
            iterations: params.iterations.clone(),
            transit: params.transit,
            loops: params.loops,
        };
        let plan = if let Some(before) = before {
            before.moved(decomposition, site.start, &spec)
        } else {
            let key = crate::own_key(params.key, site)
                .unwrap_or_else(|| Key::from_seed(params.map, seed));
            let source = key.source()?;
            CoveragePlan::new(decomposition, site.start, &spec, source)
        };
        Ok(plan?)
    }
}
