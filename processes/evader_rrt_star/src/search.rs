//! RRT*: a tree of paths from the robot, rewired as it grows.

mod grow;
mod join;
mod kept;
mod refine;

use geometry::pose::Pose2;
use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::bound::Bound;
use crate::collision_map::Body;
use crate::cost::CostModel;
use crate::index::{BucketIndex, Neighbour};
use crate::motion::{Leg, Link, Motion};
use crate::params::{Algorithm, SearchParams};
use crate::sampler::FreeSampler;
use crate::tree::{NONE, ROOT, Tree};

/// Inputs of a search. All of them must be of the same map and the same robot.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The free space.
    pub space: &'a FreeSpace,
    /// Sampler of free places.
    pub sampler: &'a FreeSampler,
    /// Radius of the robot, including the margin (m).
    pub radius: f64,
    /// Costs of edges.
    pub cost: &'a CostModel,
    /// Robots that block the way.
    pub bodies: &'a [Body],
}

impl Scene<'_> {
    /// Returns `true` if the robot can drive from one point to another by this link.
    fn is_free(&self, link: &Link, from: Point2<f64>, to: Point2<f64>) -> bool {
        link.is_free(self.space, from, to, self.radius)
            && self
                .bodies
                .iter()
                .all(|body| body.lets_pass(from, link.distance_to(from, to, body.at)))
    }
}

/// Point of a found path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Position, and the heading there (0 for primitives without one).
    pub pose: Pose2,
    /// Motion from the point before.
    pub leg: Leg,
    /// Length of the path so far (m).
    pub length: f64,
    /// Cost of the path so far (m).
    pub cost: f64,
}

/// Search for the cheapest path from a pose to the nearest of some goals.
///
/// RRT* (Karaman and Frazzoli 2011) with, unless it is the published search,
/// * parents also among the ancestors of near nodes (Quick-RRT*, Jeong et al. 2019),
/// * samples only where they can shorten the path (Informed RRT*, Gammell et al. 2014; here with
///   lower bounds along the streets if they are known),
/// * refinement of the best path's own points (in the spirit of RRT*-Smart, Nasir et al. 2013),
/// * pruning of nodes that can no longer matter.
///
/// Everything follows from the seed, the scene and the numbers of iterations.
#[derive(Debug, Clone)]
pub struct Search<M> {
    params: SearchParams,
    motion: M,
    rng: ChaCha8Rng,
    tree: Tree,
    index: BucketIndex,
    /// Numbers of the goals' nodes: from 1 on.
    goals: u32,
    bound: Bound,
    /// Cheapest goal and its cost.
    best: (f64, u32),
    /// Nodes on the best path, root first.
    way: Vec<u32>,
    /// γ of the shrinking radius for the whole free space (m).
    gamma: f64,
    /// Running share of free space in which samples are still useful.
    useful: f64,
    /// Tree size and cost at the last pruning.
    pruned: (usize, f64),
    near: Vec<Neighbour>,
    seen: Vec<u32>,
    candidates: Vec<join::Candidate>,
    moved: Vec<join::NodeUpdate>,
}

impl<M: Motion> Search<M> {
    /// Returns a search that has not begun.
    pub fn new(params: SearchParams, motion: M, seed: u64) -> Self {
        let nowhere = Aabb {
            min: Point2::origin(),
            max: Point2::new(1.0, 1.0),
        };
        Self {
            params,
            motion,
            rng: ChaCha8Rng::seed_from_u64(seed),
            tree: Tree::default(),
            index: BucketIndex::new(nowhere),
            goals: 0,
            bound: Bound::default(),
            best: (f64::INFINITY, NONE),
            way: Vec::new(),
            gamma: 0.0,
            useful: 1.0,
            pruned: (0, f64::INFINITY),
            near: Vec::new(),
            seen: Vec::new(),
            candidates: Vec::new(),
            moved: Vec::new(),
        }
    }

    /// Returns `true` for the improved search, `false` for the published one.
    pub fn is_improved(&self) -> bool {
        self.params.algorithm == Algorithm::Improved
    }

    /// Begins again with the root and the goals (m) alone.
    pub fn plant(&mut self, scene: &Scene<'_>, root: Pose2, goals: &[Point2<f64>], bound: Bound) {
        self.begin(scene, root, goals, bound);
    }

    fn begin(&mut self, scene: &Scene<'_>, root: Pose2, goals: &[Point2<f64>], bound: Bound) {
        self.tree.plant(root);
        self.index = BucketIndex::new(*scene.space.bounds());
        self.index.insert(root.position());
        for goal in goals {
            self.tree.push(Pose2::new(goal.x, goal.y, 0.0));
            // Goals keep their numbers, but the index must not find them: no path continues from
            // there.
            self.index.insert(Point2::new(f64::NAN, f64::NAN));
        }
        self.goals = goals.len() as u32;
        self.bound = bound;
        self.best = (f64::INFINITY, NONE);
        self.way.clear();
        self.useful = 1.0;
        self.pruned = (0, f64::INFINITY);
        // Karaman and Frazzoli 2011, theorem 38, in the plane: γ* = 2 √(1 + 1/2) √(area / π).
        let area = scene.sampler.area();
        self.gamma = 2.0 * (1.5 * area / core::f64::consts::PI).sqrt();
        // The goals may be in sight.
        for goal in 1..=self.goals {
            self.join_goal(scene, goal);
        }
        self.note_best(scene);
    }

    /// Continues for this many iterations.
    pub fn run(&mut self, scene: &Scene<'_>, iterations: u32) {
        if self.tree.is_empty() {
            return;
        }
        for _ in 0..iterations {
            self.iterate(scene);
        }
    }

    /// The tree.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Returns `true` if a node is on the best path.
    pub fn is_on_way(&self, node: u32) -> bool {
        self.way.contains(&node)
    }

    /// Returns the best path from the root to a goal, root first; empty without one.
    pub fn way(&self) -> Vec<Waypoint> {
        self.waypoints(&self.way)
    }

    /// Returns the path to the node from which a goal seems nearest: the route while no goal has
    /// been reached. Empty if that is the root itself.
    pub fn partial_way(&self) -> Vec<Waypoint> {
        let nearest = self
            .tree
            .nodes()
            .iter()
            .enumerate()
            .filter(|(_, node)| node.cost.is_finite())
            .map(|(i, node)| (self.bound.to_goal(node.position()), i as u32))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let mut way = Vec::new();
        if let Some((_, node)) = nearest.filter(|&(_, node)| node != ROOT) {
            self.tree.way_to(node, &mut way);
        }
        self.waypoints(&way)
    }

    fn waypoints(&self, way: &[u32]) -> Vec<Waypoint> {
        let mut before: Option<u32> = None;
        way.iter()
            .map(|&number| {
                let node = self.tree.node(number);
                let leg = before
                    .and_then(|before| self.link(before, node.position()))
                    .map_or(Leg::Line, |link| link.leg);
                before = Some(number);
                Waypoint {
                    pose: node.pose,
                    leg,
                    length: node.length,
                    cost: node.cost,
                }
            })
            .collect()
    }

    /// Returns the current radius within which nodes are joined (m): γ √(ln n / n) for n nodes, so
    /// that it shrinks as the tree fills the space. In the published search it stays the longest
    /// edge.
    fn radius(&self) -> f64 {
        if !self.is_improved() {
            return self.params.max_edge;
        }
        let n = (self.tree.len() as f64).max(2.0);
        // γ is of the area in which there still are samples.
        let gamma = self.gamma * self.useful.sqrt();
        (gamma * (geometry::math::ln(n) / n).sqrt()).min(self.params.max_edge)
    }

    /// Updates the best path to a goal.
    fn note_best(&mut self, scene: &Scene<'_>) {
        let goals = 1..=self.goals;
        let cheapest = goals
            .map(|goal| (self.tree.node(goal).cost, goal))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|cheapest| cheapest.0.is_finite());
        let Some(cheapest) = cheapest else {
            return;
        };
        if cheapest == self.best && !self.way.is_empty() {
            return;
        }
        self.best = cheapest;
        self.tree.way_to(cheapest.1, &mut self.way);
        if self.is_improved() {
            self.straighten(scene);
        }
    }
}

#[cfg(test)]
mod tests;
