//! The shortest paths of several homotopy classes: ways around the obstacles on different sides.
//!
//! A path in the graph has no kinks and bends around obstacles only, so it is locally shortest; and
//! the free space has no two locally shortest paths of one class (its universal cover has no
//! positive curvature). So each path of the graph is the shortest of its class, and the shortest
//! paths of the k shortest classes are the k shortest paths of the graph. The search is A* over all
//! paths, not over vertices as in `search`, with the exact cost of the rest as its bound: it
//! continues only paths that are among the shortest, except those that it drops.
//!
//! Dropped are paths that visit a point twice (they wind around an obstacle, or return along it):
//! there are always shorter classes, and without them the number of paths is finite.

use core::f64::consts::TAU;

use nalgebra::Point2;

use super::backwards::backwards;
use super::graph::{self, NONE};
use super::heap::Heap;
use super::near::Join;
use super::{GraphError, Inner, PathLeg, ShortestPath, TangentGraph, legs, once};
use planner_view::free_space::FreeSpace;

/// Maximum number of continued paths of a search; where paths are dropped in large numbers, it ends with fewer
/// classes.
const MAX_PATHS: usize = 1 << 16;
/// Angle (rad) by which two arcs may overlap: rounding at a common end.
const OVERLAP: f64 = 1e-9;
/// Length (m) of an arc below which it is no bend.
const NO_BEND: f64 = 1e-9;

/// The shortest path of each of the `k` shortest homotopy classes for a disc of this radius (m) between
/// two points (m), in order of length; fewer if there are fewer that visit no point twice and are no
/// longer than `max_length` (m). The first is that of [`shortest_once`](super::shortest_once).
///
/// # Errors
/// As [`TangentGraph::new`].
pub fn k_shortest_classes(
    space: &FreeSpace,
    radius: f64,
    from: Point2<f64>,
    to: Point2<f64>,
    k: usize,
    max_length: f64,
) -> Result<Vec<ShortestPath>, GraphError> {
    once::growing(space, radius, from, to, max_length, |graph, limit| {
        let paths = graph.classes(from, to, k, limit);
        let complete = paths.len() >= k;
        (paths, complete)
    })
}

/// A path up to its landing on a track.
#[derive(Debug, Clone, Copy)]
struct Landing {
    /// Index of the landing before; `None` after the tangent from the start.
    before: Option<usize>,
    /// Position (rad) where the path left the track of the landing before.
    left_at: f64,
    /// The tangent (m) that led here.
    ends: [Point2<f64>; 2],
    track: u32,
    /// Position of landing on the track (rad).
    at: f64,
}

/// A continuation of a path.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// Along the track to the departure of a vertex, after an arc (rad) at a cost (m).
    Depart {
        landing: usize,
        vertex: u32,
        arc: f64,
        cost: f64,
    },
    /// Along the track to the tangent to the goal with this index.
    Finish { landing: usize, goal: usize },
}

/// State of a search.
struct Search<'a> {
    inner: &'a Inner,
    goal: Point2<f64>,
    goals: Vec<Join>,
    /// By track, the index of the tangent to the goal.
    goal_of: Vec<Option<usize>>,
    /// Cost (m) from every vertex to the goal.
    costs: Vec<f64>,
    landings: Vec<Landing>,
    steps: Vec<Step>,
    heap: Heap,
}

impl TangentGraph {
    /// The shortest path of each of the `k` shortest homotopy classes between two points (m), in order
    /// of length; fewer if there are fewer that visit no point twice and are no longer than
    /// `max_length` (m).
    pub fn classes(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        k: usize,
        max_length: f64,
    ) -> Vec<ShortestPath> {
        self.inner
            .classes(from, to, k, max_length)
            .unwrap_or_default()
    }
}

impl Inner {
    /// `None` if the start or the goal is not free.
    fn classes(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        k: usize,
        max_length: f64,
    ) -> Option<Vec<ShortestPath>> {
        let (p, q) = (self.settle(from)?, self.settle(to)?);
        let aside = (p - from).norm() + (q - to).norm();
        let mut found: Vec<(Vec<u32>, ShortestPath)> = Vec::new();
        let mut add = |bends: Vec<u32>, length: f64, path: Vec<PathLeg>| {
            // A path past a site without a bend is also one over it.
            if found.iter().all(|(known, _)| *known != bends) {
                let length = aside + length;
                found.push((bends, ShortestPath { length, legs: path }));
            }
            found.len() >= k
        };
        let line = (q - p).norm();
        if k == 0 || aside + line > max_length {
            return Some(Vec::new());
        }
        let mut is_done = false;
        if self.space.segment_is_free(p, q, self.radius) {
            let mut path = Vec::new();
            legs::straight(&[from, p, q, to], &mut path);
            is_done = add(Vec::new(), line, path);
        }
        let mut search = Search::new(self, p, q);
        while !is_done
            && search.steps.len() < MAX_PATHS
            && let Some((length, step)) = search.heap.pop()
        {
            if aside + length > max_length {
                break;
            }
            match search.steps[step as usize] {
                Step::Depart {
                    landing,
                    vertex,
                    arc,
                    cost,
                } => search.depart(landing, vertex, arc, cost),
                Step::Finish { landing, goal } => {
                    if let Some((bends, mut path)) = search.finish(landing, goal) {
                        if from != p {
                            path.insert(0, PathLeg::Segment { from, to: p });
                        }
                        legs::straight(&[q, to], &mut path);
                        is_done = add(bends, length, path);
                    }
                }
            }
        }
        Some(found.into_iter().map(|(_, path)| path).collect())
    }
}

impl<'a> Search<'a> {
    fn new(inner: &'a Inner, p: Point2<f64>, q: Point2<f64>) -> Self {
        let Inner {
            space,
            graph,
            near,
            radius,
        } = inner;
        let joins = |at: Point2<f64>| {
            let mut joins = Vec::new();
            near.joins(space, graph, at, &mut joins);
            joins.retain(|join| space.segment_is_free(join.touch, at, *radius));
            joins
        };
        let mut goals = joins(q);
        let mut goal_of = vec![None; graph.tracks()];
        for (i, goal) in goals.iter_mut().enumerate() {
            // A tangent from the goal is a tangent to it on the opposite track.
            goal.at = graph.opposite(goal.track, goal.at);
            goal.track ^= 1;
            goal_of[goal.track as usize] = Some(i);
        }
        let mut search = Self {
            inner,
            goal: q,
            goals,
            goal_of,
            costs: Vec::new(),
            landings: Vec::new(),
            steps: Vec::new(),
            heap: Heap::default(),
        };
        let seeds = graph.vertices.iter().enumerate().filter_map(|(i, v)| {
            let (_, rest) = search.to_goal(v.to_track, v.to_at)?;
            Some((i as u32, v.length + rest))
        });
        let mut costs = Vec::new();
        backwards(graph, seeds, &mut costs, &mut Heap::default());
        search.costs = costs;
        for start in joins(p) {
            let landing = Landing {
                before: None,
                left_at: 0.0,
                ends: [p, start.touch],
                track: start.track,
                at: start.at,
            };
            search.land(landing, start.length);
        }
        search
    }

    /// The tangent to the goal from a track, and the cost (m) from a position on it.
    fn to_goal(&self, track: u32, at: f64) -> Option<(usize, f64)> {
        let goal = self.goal_of[track as usize]?;
        let graph = &self.inner.graph;
        let arc = graph.arc(track, at, self.goals[goal].at)?;
        Some((
            goal,
            graph.site(track).radius * arc + self.goals[goal].length,
        ))
    }

    /// Continues from a landing that costs this much (m).
    fn land(&mut self, landing: Landing, cost: f64) {
        let index = self.landings.len();
        self.landings.push(landing);
        let Landing { track, at, .. } = landing;
        if let Some((goal, rest)) = self.to_goal(track, at) {
            let step = Step::Finish {
                landing: index,
                goal,
            };
            self.push(cost + rest, step);
        }
        let graph = &self.inner.graph;
        let (vertex, way) = graph.departure(track, at);
        let arc = way / graph.site(track).radius;
        self.reach(index, vertex, arc, cost + way);
    }

    /// Queues the departure of a vertex.
    fn reach(&mut self, landing: usize, vertex: u32, arc: f64, cost: f64) {
        if vertex == NONE || arc > TAU {
            return;
        }
        let total = cost + self.costs[vertex as usize];
        let step = Step::Depart {
            landing,
            vertex,
            arc,
            cost,
        };
        if total.is_finite() {
            self.push(total, step);
        }
    }

    fn push(&mut self, total: f64, step: Step) {
        self.heap.push(total, self.steps.len() as u32);
        self.steps.push(step);
    }

    /// Takes the tangent of a vertex, and stays on the track for the next one.
    fn depart(&mut self, landing: usize, vertex: u32, arc: f64, cost: f64) {
        let graph = &self.inner.graph;
        let v = graph.vertices[vertex as usize];
        let radius = graph.site(v.track).radius;
        self.reach(
            landing,
            v.stay,
            arc + v.stay_cost / radius,
            cost + v.stay_cost,
        );
        if self.is_new(landing, arc, v.ends) {
            let next = Landing {
                before: Some(landing),
                left_at: v.at,
                ends: v.ends,
                track: v.to_track,
                at: v.to_at,
            };
            self.land(next, cost + v.length);
        }
    }

    /// Returns `true` if the path visits no point for the second time on an arc (rad) after a landing
    /// and on the tangent after it.
    fn is_new(&self, landing: usize, arc: f64, tangent: [Point2<f64>; 2]) -> bool {
        let graph = &self.inner.graph;
        let here = self.landings[landing];
        let start = |landing: &Landing, arc: f64| {
            if graph::turn(landing.track) > 0.0 {
                landing.at
            } else {
                graph.site(landing.track).width - landing.at - arc
            }
        };
        if crosses(here.ends, tangent) {
            return false;
        }
        let mut after = here;
        let mut before = here.before;
        while let Some(index) = before {
            let past = self.landings[index];
            if crosses(past.ends, tangent) {
                return false;
            }
            if past.track / 2 == here.track / 2 {
                let past_arc = graph.arc(past.track, past.at, after.left_at).unwrap_or(0.0);
                let ahead = (start(&here, arc) - start(&past, past_arc)).rem_euclid(TAU);
                let behind = TAU - ahead;
                let both = arc > OVERLAP && past_arc > OVERLAP;
                if both && (ahead < past_arc - OVERLAP || behind < arc - OVERLAP) {
                    return false;
                }
            }
            after = past;
            before = past.before;
        }
        true
    }

    /// The bends and the legs of a path that continues from a landing to the goal; `None` if it visits a
    /// point twice.
    fn finish(&self, landing: usize, goal: usize) -> Option<(Vec<u32>, Vec<PathLeg>)> {
        let graph = &self.inner.graph;
        let goal = self.goals[goal];
        let last = self.landings[landing];
        let arc = graph.arc(last.track, last.at, goal.at)?;
        let tangent = [goal.touch, self.goal];
        if !self.is_new(landing, arc, tangent) {
            return None;
        }
        let mut chain = vec![last];
        while let Some(before) = chain.last().and_then(|landing| landing.before) {
            chain.push(self.landings[before]);
        }
        chain.reverse();
        let (mut bends, mut path) = (Vec::new(), Vec::new());
        for (i, landing) in chain.iter().enumerate() {
            let leaves = chain.get(i + 1).map_or(goal.at, |next| next.left_at);
            let at = (landing.track, landing.at);
            let arc = graph.arc(landing.track, landing.at, leaves).unwrap_or(0.0);
            if arc * graph.site(landing.track).radius > NO_BEND {
                bends.push(landing.track);
            }
            legs::straight(&landing.ends, &mut path);
            legs::arc(graph, at, leaves, &mut path);
        }
        legs::straight(&tangent, &mut path);
        Some((bends, path))
    }
}

/// Returns `true` if two segments cross at inner points of both.
fn crosses([a, b]: [Point2<f64>; 2], [c, d]: [Point2<f64>; 2]) -> bool {
    let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
    let apart = |x: f64, y: f64| x * y < 0.0;
    apart(side(a, b, c), side(a, b, d)) && apart(side(c, d, a), side(c, d, b))
}
