//! The graph of a map with the trees that its planners share.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use super::nav_grid::NavGrid;
use super::route_tree::{RouteTree, Threat};

/// Maximum number of nodes of all trees that are kept; a node takes about 20 bytes. Enough for all trees of a map of
/// some 3000 nodes, which many missions at once need.
const MAX_NODES: usize = 24_000_000;

/// Maximum number of kept trees whose threats will hardly occur again.
const MAX_PASSING: usize = 16;

/// Inputs that determine a tree, besides its graph.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seed {
    /// Routes with gates from a node.
    From(usize),
    /// Lengths from a node.
    Lengths(usize),
    /// Routes to the cheapest of these nodes past these threats (the bits of their numbers).
    Out(Vec<usize>, Vec<[u64; 4]>),
}

impl Seed {
    pub(super) fn out(roots: &[usize], threats: &[Threat]) -> Self {
        let bits = |threat: &Threat| {
            [threat.at.x, threat.at.y, threat.gain, threat.reach].map(f64::to_bits)
        };
        Self::Out(roots.to_vec(), threats.iter().map(bits).collect())
    }

    /// Returns `true` if the seed belongs to one instant of one run.
    fn is_passing(&self) -> bool {
        matches!(self, Self::Out(_, threats) if !threats.is_empty())
    }
}

/// A graph, and the trees grown in it so far.
#[derive(Debug)]
pub struct RouteTrees {
    pub(super) grid: NavGrid,
    kept: Mutex<TreeCache>,
}

#[derive(Debug, Default)]
struct TreeCache {
    trees: BTreeMap<Seed, Arc<RouteTree>>,
    passing: VecDeque<(Seed, Arc<RouteTree>)>,
}

impl RouteTrees {
    pub(super) fn new(grid: NavGrid) -> Self {
        Self {
            grid,
            kept: Mutex::default(),
        }
    }

    /// The tree of this seed as far as any planner has grown it.
    pub(super) fn tree(&self, seed: &Seed) -> Option<Arc<RouteTree>> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if seed.is_passing() {
            let known = kept.passing.iter().find(|(known, _)| known == seed);
            return known.map(|(_, tree)| Arc::clone(tree));
        }
        kept.trees.get(seed).cloned()
    }

    /// Stores a tree for other planners, unless the stored one has grown further.
    pub(super) fn keep(&self, seed: &Seed, tree: &Arc<RouteTree>) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let TreeCache { trees, passing } = &mut *kept;
        let is_new = |known: &Arc<RouteTree>| known.settled() < tree.settled();
        if seed.is_passing() {
            match passing.iter_mut().find(|(known, _)| known == seed) {
                Some((_, known)) if is_new(known) => *known = Arc::clone(tree),
                Some(_) => {}
                None => {
                    if passing.len() >= MAX_PASSING {
                        passing.pop_front();
                    }
                    passing.push_back((seed.clone(), Arc::clone(tree)));
                }
            }
            return;
        }
        let is_full = trees.len() * self.grid.len() >= MAX_NODES;
        match trees.get_mut(seed) {
            Some(known) if is_new(known) => *known = Arc::clone(tree),
            Some(_) => {}
            None if is_full => {}
            None => {
                trees.insert(seed.clone(), Arc::clone(tree));
            }
        }
    }
}
