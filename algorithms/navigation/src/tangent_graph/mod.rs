//! Exact shortest paths of a disc robot among convex pieces.
//!
//! A disc of radius r moves among pieces as its centre moves among the pieces grown by r. These are
//! bounded by straight lines and arcs: of radius r about the corners of polygons, of radius R + r
//! about the centres of discs. A shortest path is a taut string between them: straight segments
//! that touch arcs at both ends, and stretches of these arcs, without kinks. (Laumond 1987,
//! "Obstacle growing in a nonpolygonal world"; for discs: Chew 1985, "Planning the shortest path
//! for a disc in O(n² log n) time".) There are finitely many such *bitangents*, so the shortest
//! path is found in a graph, exactly; [`TangentGraph`] holds it for one space and one radius.
//!
//! - `sites`: the arcs, cut to their free parts. Pieces may overlap, touch, share corners and cross the bounds.
//!   An arc within another grown piece is not a site, and no path bends at a concave junction.
//! - `tangent`, `graph`: the bitangents, each tested exactly by [`FreeSpace::segment_is_free`], and their
//!   successors.
//! - `near`: the sites that a point may see, by the cell that contains it.
//! - `search`: A* from point to point. A tangent from the start or to the goal is tested only when
//!   the path over it would be the shortest.
//! - `towards`: one goal for many starts, as the heuristic of a planner.
//! - `once`: a single query for a space.
//! - `classes`: the shortest paths of several homotopy classes.
//!
//! All lengths are sums in `f64` of the true segments and arcs. Accuracy: a path penetrates by at most [`geometry::map::TOUCHING`] (1 nm) and bends
//! by at most 10⁻⁹ rad where it should not.
//!
//! ```
//! use planner_view::free_space::FreeSpace;
//! use navigation::tangent_graph::TangentGraph;
//! use nalgebra::Point2;
//! use geometry::shape::{Aabb, Convex};
//!
//! let bounds = Aabb { min: Point2::new(-5.0, -5.0), max: Point2::new(5.0, 5.0) };
//! let pillar = Convex::disc(Point2::new(0.0, 0.0), 0.8);
//! let space = FreeSpace::new(vec![pillar], bounds, 0.1).unwrap();
//! let graph = TangentGraph::new(&space, 0.2).unwrap();
//! let path = graph.shortest(Point2::new(-2.0, 0.0), Point2::new(2.0, 0.0)).unwrap();
//! // Tangent, arc of π/3, tangent around a circle of radius 1 from twice as far: 2√3 + π/3.
//! assert!((path.length - 4.511_299_2).abs() < 1e-6);
//! assert_eq!(path.legs.len(), 3);
//! ```

mod backwards;
mod classes;
mod graph;
mod heap;
mod legs;
mod near;
mod once;
mod search;
mod sites;
mod tangent;
mod towards;

use std::sync::Arc as Shared;

use nalgebra::{Point2, Vector2};
use thiserror::Error;

pub use classes::k_shortest_classes;
use graph::Graph;
use near::Near;
pub use once::shortest_once;
use planner_view::free_space::{Arc, FreeSpace};
pub use towards::Towards;

/// Maximum depth (m) of a start or goal in a grown piece: the point is pushed out to the border, and the
/// segment to the border belongs to the path. Ten times the depth that the world's contacts leave, a hundredth
/// of a robot. For deeper points there is no path.
pub const PUSH_OUT: f64 = 1e-3;
/// Smallest radius of a robot (m); it represents a point robot.
pub const MIN_RADIUS: f64 = 1e-6;
/// Maximum number of arcs of a graph: the time to build it grows with their square. A noisy occupancy grid can
/// exceed it.
pub const MAX_SITES: usize = 4096;
/// Maximum number of tangents, one per direction, of a graph.
pub const MAX_TANGENTS: usize = 1 << 20;

/// Reason why a graph cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum GraphError {
    /// The radius is not usable.
    #[error("radius = {0}: expected a number of at least {MIN_RADIUS} (m)")]
    Radius(f64),
    /// The map has too many corners.
    #[error("the map has more than {0} arcs around corners and discs that paths may bend around")]
    TooManySites(usize),
    /// The map has too many tangents.
    #[error("the map has more than {MAX_TANGENTS} lines of sight between corners and discs")]
    TooManyTangents,
}

/// A part of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathLeg {
    /// A straight segment.
    Segment {
        /// Start (m).
        from: Point2<f64>,
        /// End (m).
        to: Point2<f64>,
    },
    /// An arc around a corner or disc.
    Arc(Arc),
}

impl PathLeg {
    /// Length (m).
    pub fn length(&self) -> f64 {
        match self {
            Self::Segment { from, to } => (to - from).norm(),
            Self::Arc(arc) => arc.length(),
        }
    }

    /// The point at a fraction of the leg, 0 at the start and 1 at the end (m).
    pub fn at(&self, part: f64) -> Point2<f64> {
        match self {
            Self::Segment { from, to } => from + (to - from) * part,
            Self::Arc(arc) => arc.at(part),
        }
    }

    /// Unit vector of travel at a fraction of the leg.
    pub fn heading(&self, part: f64) -> Vector2<f64> {
        match self {
            Self::Segment { from, to } => (to - from).normalize(),
            Self::Arc(arc) => arc.heading(part),
        }
    }

    /// Curvature (1/m): positive to the left.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Segment { .. } => 0.0,
            Self::Arc(Arc { radius, sweep, .. }) => sweep.signum() / radius,
        }
    }
}

/// A shortest path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShortestPath {
    /// Length (m): the sum of the legs.
    pub length: f64,
    /// The legs in order, each beginning at the end of the last; empty if start and goal are the same. Headings
    /// are continuous at all joints except that of a start or goal that was pushed out.
    pub legs: Vec<PathLeg>,
}

/// The shortest paths of a disc among the pieces of a space; cheap to clone, shared between threads.
///
/// # Performance
/// Build time grows with the square of the number of corners; query time grows with the complexity of the path.
/// Figures in `benches/shortest_path.rs`.
#[derive(Debug, Clone)]
pub struct TangentGraph {
    inner: Shared<Inner>,
}

#[derive(Debug)]
struct Inner {
    space: FreeSpace,
    radius: f64,
    graph: Graph,
    near: Near,
}

impl TangentGraph {
    /// Builds the graph of a space for a robot of this radius (m).
    ///
    /// # Errors
    /// [`GraphError`] for a radius that is not usable and for maps with too many corners.
    pub fn new(space: &FreeSpace, radius: f64) -> Result<Self, GraphError> {
        if !(radius >= MIN_RADIUS && radius.is_finite()) {
            return Err(GraphError::Radius(radius));
        }
        let sites = sites::find(space, radius, MAX_SITES);
        if sites.len() > MAX_SITES {
            return Err(GraphError::TooManySites(MAX_SITES));
        }
        let graph = Graph::new(space, radius, sites)?;
        let inner = Inner {
            near: Near::new(space.bounds()),
            space: space.clone(),
            radius,
            graph,
        };
        Ok(Self {
            inner: Shared::new(inner),
        })
    }

    /// The robot's radius (m).
    pub fn radius(&self) -> f64 {
        self.inner.radius
    }

    /// The space that the paths lead through.
    pub fn space(&self) -> &FreeSpace {
        &self.inner.space
    }

    /// Number of arcs that paths bend around.
    pub fn sites(&self) -> usize {
        self.inner.graph.sites.len()
    }

    /// Number of tangents between them, one per direction.
    pub fn tangents(&self) -> usize {
        self.inner.graph.vertices.len()
    }

    /// The shortest path between two points (m); `None` if there is none, if either is deeper
    /// inside a grown piece than [`PUSH_OUT`], or not finite.
    pub fn shortest(&self, from: Point2<f64>, to: Point2<f64>) -> Option<ShortestPath> {
        let mut legs = Vec::new();
        let length =
            search::with_scratch(|scratch| self.inner.search(from, to, Some(&mut legs), scratch))?;
        Some(ShortestPath { length, legs })
    }

    /// Length (m) of [`Self::shortest`]; does not allocate after the first call in a thread.
    pub fn distance(&self, from: Point2<f64>, to: Point2<f64>) -> Option<f64> {
        search::with_scratch(|scratch| self.inner.search(from, to, None, scratch))
    }

    /// Prepares one goal (m) for queries from many starts.
    pub fn towards(&self, goal: Point2<f64>) -> Towards {
        Towards::new(Shared::clone(&self.inner), goal)
    }
}
