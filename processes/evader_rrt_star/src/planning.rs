//! Plans: from a situation to a route.

use std::sync::Arc;

use guidance::limits::Limits;
use guidance::tangent_graph::Towards;
use nalgebra::Point2;
use sim_backend::pose::Pose2;

use crate::bound::Bound;
use crate::cost::CostModel;
use crate::ground::{Body, Ground};
use crate::motion::{Arcs, Motion, Straight};
use crate::params::{Follower, Primitive, RrtStarParams};
use crate::route::Route;
use crate::search::{Progress, Scene, Search};
use crate::tree::Tree;

/// A search with either primitive.
trait Engine: core::fmt::Debug + Send {
    fn plan(&mut self, task: &Task<'_>, stop: &mut dyn FnMut() -> bool) -> Option<Route>;
    fn progress(&self) -> Progress;
    fn tree(&self) -> &Tree;
    fn is_on_way(&self, node: u32) -> bool;
}

/// What is to be planned.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The map.
    pub ground: &'a Ground,
    /// Robots that stand in the way.
    pub bodies: &'a [Body],
    /// What ways cost.
    pub cost: &'a CostModel,
    /// From where.
    pub start: Pose2,
    /// To the cheapest of these [m].
    pub goals: &'a [Point2<f64>],
    /// The shortest ways to the goals, one for each, or none where they are not known.
    pub towards: &'a [Arc<Towards>],
    /// Whether obstacles have changed since the last plan.
    pub map_changed: bool,
    /// Most iterations.
    pub iterations: u32,
}

/// Plans one route after the other, each with what is left of the last tree.
#[derive(Debug)]
pub struct Planning {
    engine: Box<dyn Engine>,
}

impl Planning {
    /// A planner for a robot with these limits; everything it draws follows from the seed.
    pub fn new(params: &RrtStarParams, limits: &Limits, seed: u64) -> Self {
        let engine: Box<dyn Engine> = match params.primitive {
            Primitive::Line => Box::new(Search::new(params.search, Straight, seed)),
            Primitive::Arc => {
                let cap = match params.follower {
                    Follower::PurePursuit => params.tracking.omega_cap,
                    Follower::PotentialField => params.field.feedback.omega_cap,
                };
                let cap = cap.unwrap_or(f64::INFINITY);
                let arcs = Arcs {
                    min_radius: params
                        .arc
                        .min_radius
                        .unwrap_or(limits.v_max() / limits.omega_max().min(cap)),
                    max_bearing: params.arc.max_bearing,
                    free_start: params.arc.free_start,
                };
                Box::new(Search::new(params.search, arcs, seed))
            }
        };
        Self { engine }
    }

    /// The best route found: to a goal, or as near as was come to one; `None` if not a step was
    /// found. `stop` is asked now and then whether to stop early.
    pub fn plan(&mut self, task: &Task<'_>, stop: &mut dyn FnMut() -> bool) -> Option<Route> {
        self.engine.plan(task, stop)
    }

    /// How far the last plan came.
    pub fn progress(&self) -> Progress {
        self.engine.progress()
    }

    /// The tree of the last plan.
    pub fn tree(&self) -> &Tree {
        self.engine.tree()
    }

    /// Whether a node of the tree is on the last plan's way to a goal.
    pub fn is_on_way(&self, node: u32) -> bool {
        self.engine.is_on_way(node)
    }
}

impl<M: Motion + core::fmt::Debug + Send> Engine for Search<M> {
    fn plan(&mut self, task: &Task<'_>, stop: &mut dyn FnMut() -> bool) -> Option<Route> {
        let scene = Scene {
            space: &task.ground.space,
            sampler: &task.ground.sampler,
            radius: task.ground.radius,
            cost: task.cost,
            bodies: task.bodies,
        };
        let start = task.start.position();
        let bound = if task.towards.is_empty() || !self.params().street_bounds {
            Bound::straight(start, task.goals)
        } else {
            Bound::along_streets(start, task.towards)
        };
        self.replant(&scene, task.start, task.goals, bound, task.map_changed);
        self.run(&scene, task.iterations, stop);
        Route::new(self.way(), true).or_else(|| Route::new(self.partial_way(), false))
    }

    fn progress(&self) -> Progress {
        Search::progress(self)
    }

    fn tree(&self) -> &Tree {
        Search::tree(self)
    }

    fn is_on_way(&self, node: u32) -> bool {
        Search::is_on_way(self, node)
    }
}
