//! What a planner prepares of a map for a robot.

use std::sync::Arc;

use nalgebra::Point2;
use navigation::tangent_graph::{TangentGraph, Towards};
use planner_view::free_space::FreeSpace;

use crate::motion::segment_distance;
use crate::sampler::FreeSampler;

/// Steps by which a place is moved out of obstacles.
const PUSHES: u32 = 16;

/// Distance by which an exit's centre may be moved to where the robot fits (m); where that is not
/// enough, the exit is left out.
pub const GOAL_TOLERANCE: f64 = 0.3;

/// How much farther than necessary a place is moved (m).
const SLACK: f64 = 1e-6;

/// A robot that stands in the way, as a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Its centre (m).
    pub at: Point2<f64>,
    /// Distance between its centre and one's own at which they touch (m).
    pub reach: f64,
}

impl Body {
    /// Whether a way that comes as near as `distance` (m) to the body and begins at `from` passes
    /// it. Who touches it already may go on, but not nearer.
    pub fn lets_pass(&self, from: Point2<f64>, distance: f64) -> bool {
        distance >= self.reach.min((from - self.at).norm())
    }
}

/// A map for a robot of one size.
#[derive(Debug, Clone)]
pub struct CollisionMap {
    /// The free space.
    pub space: FreeSpace,
    /// Where samples are drawn from.
    pub sampler: FreeSampler,
    /// Radius for which it is made (m).
    pub radius: f64,
    /// Revision of the map.
    pub revision: u64,
    /// The shortest ways, if the map is not too large for them.
    graph: Option<TangentGraph>,
    /// The goals so far, and the shortest ways to each.
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

    /// The shortest ways to these goals (m), found once for each; empty where they are not known.
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

    /// Whether it is made for this map and radius.
    pub fn is_of(&self, radius: f64, revision: u64) -> bool {
        self.radius == radius && self.revision == revision
    }

    /// Whether a robot of this radius (m) can go straight between two points, past these bodies.
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

    /// A free place as near as can be: the place itself, or where it comes to when it is pushed
    /// away from the surfaces that it is too near to. `None` if that leads nowhere within `most`
    /// (m).
    pub fn free_place(&self, p: Point2<f64>, most: f64) -> Option<Point2<f64>> {
        let mut at = p;
        for _ in 0..PUSHES {
            if self.space.is_free(at, self.radius) {
                return ((at - p).norm() <= most).then_some(at);
            }
            let contact = self.space.shapes().nearest_contact(at);
            if !contact.distance.is_finite() {
                return None;
            }
            at += contact.normal * (self.radius - contact.distance + SLACK);
        }
        None
    }
}
