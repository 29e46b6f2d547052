//! Planning of a route in a given situation.

use std::sync::Arc;

use control::path_tracking::TrackingParams;
use geometry::pose::Pose2;
use nalgebra::Point2;
use navigation::tangent_graph::Towards;
use planner_view::limits::Limits;

use crate::bound::Bound;
use crate::collision_map::{Body, CollisionMap};
use crate::cost::CostModel;
use crate::motion::{Arcs, Motion, Straight};
use crate::params::{Algorithm, Follower, Primitive, RrtStarParams};
use crate::route::Route;
use crate::search::{Scene, Search};
use crate::tree::Tree;

/// Maximum bearing of an arc's end from the heading at its start (rad): half of the largest turn in
/// one arc.
const MAX_BEARING: f64 = core::f64::consts::FRAC_PI_4;

/// Planning task.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The map.
    pub collision_map: &'a CollisionMap,
    /// Robots that block the way.
    pub bodies: &'a [Body],
    /// Costs of paths.
    pub cost: &'a CostModel,
    /// Start pose.
    pub start: Pose2,
    /// Goals, of which the cheapest is used (m).
    pub goals: &'a [Point2<f64>],
    /// The shortest paths to the goals, one for each, or none if they are not known.
    pub towards: &'a [Arc<Towards>],
    /// `true` if obstacles have changed since the last plan.
    pub map_changed: bool,
    /// Maximum number of iterations.
    pub iterations: u32,
}

/// Plans one route after the other, each with the reusable part of the last tree.
pub trait Planning: core::fmt::Debug + Send {
    /// Returns the best route found: to a goal, or as near to one as possible; `None` without a
    /// single step.
    fn plan(&mut self, task: &Task<'_>) -> Option<Route>;

    /// The tree of the last plan.
    fn tree(&self) -> &Tree;

    /// Returns `true` if a node of the tree is on the last plan's path to a goal.
    fn is_on_way(&self, node: u32) -> bool;
}

/// Returns the planning of a robot with these limits; all random values follow from the seed.
pub fn for_robot(params: &RrtStarParams, limits: &Limits, seed: u64) -> Box<dyn Planning> {
    match params.primitive {
        Primitive::Line => Box::new(Search::new(params.search, Straight, seed)),
        Primitive::Arc => {
            let cap = match params.follower {
                Follower::PurePursuit => TrackingParams::default().omega_cap,
                Follower::PotentialField => params.follower.field().feedback.omega_cap,
            };
            let cap = cap.unwrap_or(f64::INFINITY);
            let arcs = Arcs {
                min_radius: params
                    .arc
                    .min_radius
                    .unwrap_or(limits.v_max() / limits.omega_max().min(cap)),
                max_bearing: MAX_BEARING,
                free_start: params.search.algorithm == Algorithm::Improved,
            };
            Box::new(Search::new(params.search, arcs, seed))
        }
    }
}

impl<M: Motion + core::fmt::Debug + Send> Planning for Search<M> {
    fn plan(&mut self, task: &Task<'_>) -> Option<Route> {
        let scene = Scene {
            space: &task.collision_map.space,
            sampler: &task.collision_map.sampler,
            radius: task.collision_map.radius,
            cost: task.cost,
            bodies: task.bodies,
        };
        let start = task.start.position();
        let bound = if task.towards.is_empty() || !self.is_improved() {
            Bound::straight(start, task.goals)
        } else {
            Bound::along_streets(start, task.towards)
        };
        self.replant(&scene, task.start, task.goals, bound, task.map_changed);
        self.run(&scene, task.iterations);
        Route::new(self.way(), true).or_else(|| Route::new(self.partial_way(), false))
    }

    fn tree(&self) -> &Tree {
        Search::tree(self)
    }

    fn is_on_way(&self, node: u32) -> bool {
        Search::is_on_way(self, node)
    }
}
