//! The shortest routes from one place to all others.

use core::cmp::Reverse;
use core::sync::atomic::{AtomicU32, Ordering};
use std::collections::BinaryHeap;

use nalgebra::Point2;

use super::nav_grid::{NONE, NavGrid, SIGHT};
use planner_view::map::PlannerMap;

/// A cost (mm) that means "no path".
const UNREACHED: u32 = u32::MAX;

/// Largest factor by which a threat may lengthen an edge.
const MAX_THREAT: f64 = 1000.0;

/// A place to avoid: routes near it count as longer than they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threat {
    /// Position (m).
    pub at: Point2<f64>,
    /// Extra cost (m) per metre of path at distance `reach`; it falls with the square of the distance.
    pub gain: f64,
    /// Distance at which `gain` applies (m).
    pub reach: f64,
}

/// The first straight leg of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteLeg {
    /// End of the leg (m): the destination if it is visible, else the last visible point on the path to
    /// it.
    pub waypoint: Point2<f64>,
    /// Length of the path beyond the waypoint (m).
    pub beyond: f64,
}

/// Shortest routes between one or several roots and all nodes of a [`NavGrid`].
///
/// Besides length and parent, a tree that was planted with gates knows every node's *gate*: the last node
/// of the path to it up to which the whole path is visible from the root, within `nav_grid::SIGHT`.
/// Heading for gates cuts off the corners of the grid's eight directions. Gates are computed on request:
/// of all the nodes that a tree reaches, few are ever a destination.
///
/// The tree grows outwards from the root and only as far as requested ([`RouteTree::reach`]); nodes beyond
/// are unknown, not unreachable.
///
/// Costs are whole millimetres and ties go to the lower index, so the tree is the same on every
/// machine.
#[derive(Debug, Clone, Default)]
pub struct RouteTree {
    /// Per node of the graph, the cheapest path to it.
    nodes: Vec<Node>,
    gates: Gates,
    /// Number of nodes reached.
    settled: u32,
    threats: Vec<Threat>,
    /// Extra cost of a node as a fraction of the length of its edges, in 1/256; [`NONE`] until it is
    /// needed; empty without threats.
    extra: Vec<u32>,
    /// Nodes on the rim with the cost of the routes to them (mm), the cheapest first; of equal ones, the
    /// lowest index. One number each, see [`queued`]: comparisons take most of the time of a tree.
    queue: BinaryHeap<Reverse<u64>>,
    /// Point from which gates are visible; `None` in a tree without gates.
    origin: Option<Point2<f64>>,
}

/// The cheapest path to a node, as far as it is known. One record: a look-up of a far node is one cache miss.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Cost (mm): its length, more near threats.
    cost: u32,
    /// Length (mm).
    length: u32,
    /// The node before this one; [`NONE`] at a root.
    parent: u32,
    /// Number of nodes reached before this one; [`NONE`] until it is reached.
    rank: u32,
}

impl Node {
    const UNREACHED: Self = Self {
        cost: UNREACHED,
        length: UNREACHED,
        parent: NONE,
        rank: NONE,
    };
}

impl RouteTree {
    /// Plants the tree anew at a root node, with gates; reuses the memory.
    pub fn plant(&mut self, grid: &NavGrid, root: usize) {
        self.plant_without_gates(grid, &[root], &[]);
        self.gates.0.resize_with(grid.len(), Gates::unknown);
        self.origin = grid.point(root);
    }

    /// Plants the tree anew at several root nodes, without gates.
    ///
    /// Routes lead to the cheapest root, and avoid `threats` as far as that is worth the longer path.
    pub fn plant_without_gates(&mut self, grid: &NavGrid, roots: &[usize], threats: &[Threat]) {
        let nodes = grid.len();
        self.nodes.clear();
        self.nodes.resize(nodes, Node::UNREACHED);
        self.gates.0.clear();
        self.settled = 0;
        self.threats.clear();
        self.threats.extend_from_slice(threats);
        self.extra.clear();
        if !threats.is_empty() {
            self.extra.resize(nodes, NONE);
        }
        self.queue.clear();
        self.origin = None;
        for &root in roots.iter().filter(|&&root| root < nodes) {
            self.nodes[root].cost = 0;
            self.nodes[root].length = 0;
            self.queue.push(queued(0, root as u32));
        }
    }

    /// Grows the tree until it reaches a node; returns `false` if it cannot. `grid` must be the graph for
    /// which the tree was planted.
    pub fn reach(&mut self, grid: &NavGrid, node: usize) -> bool {
        while !self.knows(node) {
            if !self.settle_next(grid) {
                return false;
            }
        }
        true
    }

    /// Grows the tree until it has reached this many nodes, or all reachable ones. Requires the same graph
    /// as [`RouteTree::reach`].
    pub fn settle(&mut self, grid: &NavGrid, nodes: u32) {
        while self.settled < nodes && self.settle_next(grid) {}
    }

    /// Reaches one more node; returns `false` if there is none.
    fn settle_next(&mut self, grid: &NavGrid) -> bool {
        while let Some(Reverse(next)) = self.queue.pop() {
            let (cost, from) = ((next >> 32) as u32, next as u32 as usize);
            if cost > self.nodes[from].cost || self.knows(from) {
                continue;
            }
            self.nodes[from].rank = self.settled;
            let length = self.nodes[from].length;
            self.settled += 1;
            let is_threatened = !self.extra.is_empty();
            let here = if is_threatened {
                self.extra_of(grid, from)
            } else {
                0
            };
            for edge in grid.edges(from) {
                let to = edge.to as usize;
                // Threats only add to it.
                let mut reached = cost.saturating_add(edge.length);
                if reached >= self.nodes[to].cost {
                    continue;
                }
                if is_threatened {
                    let extra = here.max(self.extra_of(grid, to));
                    reached = cost.saturating_add(threatened(edge.length, extra));
                }
                let node = &mut self.nodes[to];
                if reached < node.cost {
                    node.cost = reached;
                    node.length = length.saturating_add(edge.length);
                    node.parent = from as u32;
                    self.queue.push(queued(reached, edge.to));
                }
            }
            return true;
        }
        false
    }

    /// The record of a node that the tree has reached.
    fn reached(&self, node: usize) -> Option<&Node> {
        self.nodes.get(node).filter(|node| node.rank != NONE)
    }

    /// Returns `true` if the tree has reached the node.
    pub fn knows(&self, node: usize) -> bool {
        self.reached(node).is_some()
    }

    /// The number of nodes that the tree had reached before this one. The order does not depend on the
    /// steps in which the tree grows.
    pub fn rank(&self, node: usize) -> Option<u32> {
        self.reached(node).map(|node| node.rank)
    }

    /// The number of nodes that the tree has reached.
    pub fn settled(&self) -> u32 {
        self.settled
    }

    /// Returns `true` if the tree has reached all reachable nodes.
    pub fn is_complete(&self) -> bool {
        self.queue.is_empty()
    }

    /// Length of the path to a node (mm); `None` if the tree has not reached it.
    pub fn length_mm(&self, node: usize) -> Option<u32> {
        self.reached(node).map(|node| node.length)
    }

    /// Length of the path to a node (m); `None` if the tree has not reached it.
    pub fn length(&self, node: usize) -> Option<f64> {
        self.length_mm(node).map(|mm| f64::from(mm) / 1000.0)
    }

    /// Cost of the path to a node (m): its length, more near threats; `None` if the tree has not reached
    /// it.
    pub fn cost(&self, node: usize) -> Option<f64> {
        let node = self.reached(node)?;
        Some(f64::from(node.cost) / 1000.0)
    }

    /// The node before this one on the path from the root.
    pub fn parent(&self, node: usize) -> Option<usize> {
        let parent = self.nodes.get(node)?.parent;
        (parent != NONE).then_some(parent as usize)
    }

    /// The last node on the path to this one that is visible from the root; in a tree without gates the
    /// node itself. `None` if the tree has not reached it. `map` and `grid` must be those for which the
    /// tree was planted.
    pub fn gate(&self, map: &PlannerMap, grid: &NavGrid, node: usize) -> Option<usize> {
        self.reached(node)?;
        let Some(origin) = self.origin else {
            return Some(node);
        };
        if let Some(known) = self.gates.get(node) {
            return Some(known as usize);
        }
        // Gates are inherited from the root, so the gates of nodes nearer the root are computed first.
        let mut path = vec![node];
        let mut next = self.parent(node);
        let mut gate = None;
        while let Some(before) = next {
            gate = self.gates.get(before);
            if gate.is_some() {
                break;
            }
            path.push(before);
            next = self.parent(before);
        }
        let sight = (SIGHT * 1000.0) as u32;
        let mut parent = next;
        for &node in path.iter().rev() {
            let found = match (parent, gate) {
                (Some(parent), Some(inherited)) => {
                    // The path is visible up to this node if it is visible up to the parent, and this node
                    // is visible.
                    let in_sight = inherited == parent as u32
                        && self.nodes[parent].length < sight
                        && grid.point(node).is_some_and(|point| {
                            map.line_is_clear(origin, point, grid.inflation())
                        });
                    if in_sight { node as u32 } else { inherited }
                }
                // The root.
                _ => node as u32,
            };
            self.gates.set(node, found);
            (parent, gate) = (Some(node), Some(found));
        }
        gate.map(|gate| gate as usize)
    }

    /// Extra cost that the threats add to a node.
    #[inline]
    fn extra_of(&mut self, grid: &NavGrid, node: usize) -> u32 {
        if self.extra[node] == NONE {
            let point = grid.points()[node];
            let extra: f64 = self
                .threats
                .iter()
                .map(|threat| {
                    let near = threat.reach * threat.reach;
                    threat.gain * near / (point - threat.at).norm_squared().max(1e-6)
                })
                .filter(|extra| !extra.is_nan())
                .sum();
            self.extra[node] = (extra.clamp(0.0, MAX_THREAT) * 256.0) as u32;
        }
        self.extra[node]
    }
}

/// Cost (mm) of an edge of this length (mm) with an extra cost.
fn threatened(length: u32, extra: u32) -> u32 {
    let cost = u64::from(length) * (256 + u64::from(extra)) / 256;
    u32::try_from(cost).unwrap_or(UNREACHED - 1)
}

/// Returns the entry of the queue for a node at a cost (mm).
fn queued(cost: u32, node: u32) -> Reverse<u64> {
    Reverse(u64::from(cost) << 32 | u64::from(node))
}

/// Per node, its gate, or [`NONE`] until it is computed; empty in a tree without gates.
///
/// Several readers of one tree may compute the same gate at the same time. A gate is a function of the
/// tree, so all compute the same value.
#[derive(Debug, Default)]
struct Gates(Vec<AtomicU32>);

impl Gates {
    fn unknown() -> AtomicU32 {
        AtomicU32::new(NONE)
    }

    fn get(&self, node: usize) -> Option<u32> {
        let gate = self.0.get(node)?.load(Ordering::Relaxed);
        (gate != NONE).then_some(gate)
    }

    fn set(&self, node: usize, gate: u32) {
        if let Some(place) = self.0.get(node) {
            place.store(gate, Ordering::Relaxed);
        }
    }
}

impl Clone for Gates {
    fn clone(&self) -> Self {
        let copy = |gate: &AtomicU32| AtomicU32::new(gate.load(Ordering::Relaxed));
        Self(self.0.iter().map(copy).collect())
    }
}

/// A tree together with its graph: shortest routes from a robot to points of the world.
///
/// Answers for the points of the request (see [`super::RouteFinder::routes`]) and others that are no
/// further. For all other points it reports that no path is known.
#[derive(Debug, Clone, Copy)]
pub struct Routes<'a> {
    /// The map that the graph is laid over.
    pub(super) map: &'a PlannerMap,
    /// The graph.
    pub(super) grid: &'a NavGrid,
    /// The tree in the graph; other planners may have grown it further than this one requested.
    pub(super) tree: &'a RouteTree,
    /// Number of nodes that the tree would have reached if only this planner used it.
    pub(super) horizon: u32,
}

impl Routes<'_> {
    /// The node at a point, if a path to it is known.
    fn known(&self, to: Point2<f64>) -> Option<usize> {
        let node = self.grid.node_at(to)?;
        (self.tree.rank(node)? < self.horizon).then_some(node)
    }

    /// The first leg of the path to a point (m); `None` if no path is known.
    pub fn leg_to(&self, to: Point2<f64>) -> Option<RouteLeg> {
        let node = self.known(to)?;
        let gate = self.tree.gate(self.map, self.grid, node)?;
        let last = self.grid.point(node)?;
        if gate == node {
            return Some(RouteLeg {
                waypoint: to,
                beyond: 0.0,
            });
        }
        let beyond = self.tree.length(node)? - self.tree.length(gate)? + (to - last).norm();
        Some(RouteLeg {
            waypoint: self.grid.point(gate)?,
            beyond,
        })
    }

    /// Length of the path to a point (m), to the accuracy of the graph's blocks; `None` if no path is
    /// known.
    pub fn distance_to(&self, to: Point2<f64>) -> Option<f64> {
        let node = self.known(to)?;
        Some(self.tree.length(node)? + (to - self.grid.point(node)?).norm())
    }

    /// Writes the path from the root to a point into `path`, root first, as points (m) with the distance
    /// travelled to each (m); leaves it empty if no path is known.
    pub fn way_to(&self, to: Point2<f64>, path: &mut Vec<(Point2<f64>, f64)>) {
        path.clear();
        let mut next = self.known(to);
        while let Some(node) = next {
            let (Some(point), Some(length)) = (self.grid.point(node), self.tree.length(node))
            else {
                break;
            };
            path.push((point, length));
            next = self.tree.parent(node);
        }
        path.reverse();
    }
}
