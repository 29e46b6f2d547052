//! Data that a planner derives from a map for a robot.

use std::sync::Arc;

use nalgebra::Point2;
use navigation::tangent_graph::{TangentGraph, Towards};
use planner_view::free_space::FreeSpace;

use crate::motion::segment_distance;
use crate::sampler::FreeSampler;

/// Robot that blocks the way, as a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Its centre (m).
    pub at: Point2<f64>,
    /// Distance between its centre and that of the planning robot at contact (m).
    pub reach: f64,
}

impl Body {
    /// Returns `true` if a path that comes as near as `distance` (m) to the body and begins at
    /// `from` passes it. A robot in contact may continue, but not come nearer.
    pub fn lets_pass(&self, from: Point2<f64>, distance: f64) -> bool {
        distance >= self.reach.min((from - self.at).norm())
    }
}

/// Map for a robot of one size.
#[derive(Debug, Clone)]
pub struct CollisionMap {
    /// The free space.
    pub space: FreeSpace,
    /// Sampler of free places.
    pub sampler: FreeSampler,
    /// Radius for which it is made (m).
    pub radius: f64,
    /// Revision of the map.
    pub revision: u64,
    /// Graph of the shortest paths, if the map is small enough.
    graph: Option<TangentGraph>,
    /// Goals so far, and the shortest paths to each.
    towards: Vec<Arc<Towards>>,
}

impl CollisionMap {
    /// Prepares a map for a robot of this radius, margin included (m).
    pub fn new(space: &FreeSpace, radius: f64, revision: u64) -> Self {
        Self {
            space: space.clone(),
            sampler: FreeSampler::new(space, radius),
            radius,
            revision,
            graph: TangentGraph::new(space, radius).ok(),
            towards: Vec::new(),
        }
    }

    /// Returns the shortest paths to these goals (m), computed once for each; empty if they are not
    /// known.
    pub fn towards(&mut self, goals: &[Point2<f64>]) -> Vec<Arc<Towards>> {
        let Some(graph) = &self.graph else {
            return Vec::new();
        };
        goals
            .iter()
            .map(|goal| {
                let known = self.towards.iter().find(|known| known.goal() == *goal);
                let towards = known.map_or_else(|| Arc::new(graph.towards(*goal)), Arc::clone);
                if known.is_none() {
                    self.towards.push(Arc::clone(&towards));
                }
                towards
            })
            .collect()
    }

    /// Returns `true` if it was made for this map and radius.
    pub fn is_of(&self, radius: f64, revision: u64) -> bool {
        self.radius == radius && self.revision == revision
    }

    /// Returns `true` if a robot of this radius (m) can drive straight between two points, past
    /// these bodies.
    pub fn is_free_line(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        radius: f64,
        bodies: &[Body],
    ) -> bool {
        self.space.segment_is_free(from, to, radius)
            && bodies
                .iter()
                .all(|body| body.lets_pass(from, segment_distance(from, to, body.at)))
    }

    /// Returns the nearest free place: the place itself, or its position after it is pushed away
    /// from the surfaces that it is too near to. `None` if there is none within `most` (m).
    pub fn free_place(&self, p: Point2<f64>, most: f64) -> Option<Point2<f64>> {
        self.space.free_place(p, self.radius, most)
    }
}
