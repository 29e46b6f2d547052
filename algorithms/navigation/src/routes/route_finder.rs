//! Route trees that are kept between ticks.

use std::sync::Arc;

use nalgebra::Point2;

use super::nav_grid::{NavGrid, SIGHT};
use super::route_tree::{RouteTree, Routes, Threat};
use super::route_trees::{RouteTrees, Seed};
use planner_view::map::PlannerMap;

/// Maximum number of trees that are kept; slots above it share the last one.
const MAX_SLOTS: usize = 256;

/// Largest radius (m); larger radii are clamped. No arena holds such a robot, but a corrupt message
/// may contain one.
const MAX_RADIUS: f64 = 10.0;

/// Keeps the graph of the current map (one for all planners that share the map) and one
/// [`RouteTree`] per slot. Plants a tree anew only when its root moves to another node, or the map
/// or the robot's radius changes.
#[derive(Debug, Clone, Default)]
pub struct RouteFinder {
    built_for: Option<(u64, f64)>,
    route_trees: Option<Arc<RouteTrees>>,
    /// `true` if other planners use the same trees.
    shares: bool,
    slots: Vec<Slot>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    planted: TreeKey,
    /// Key from which the tree grew, if other planners use it too.
    seed: Option<Seed>,
    tree: Arc<RouteTree>,
    /// Number of nodes that the tree would have if only this planner used it: results must not
    /// depend on other planners.
    horizon: u32,
}

/// Key for which a slot's tree was planted.
#[derive(Debug, Clone, Default, PartialEq)]
enum TreeKey {
    #[default]
    Nothing,
    /// Routes with gates from a node.
    From(usize),
    /// Lengths from a node.
    Lengths(usize),
    /// Routes to the cheapest of these nodes.
    Out(Vec<usize>),
}

/// The path to the exit that is cheapest to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitRoute {
    /// The exit (m).
    pub exit: Point2<f64>,
    /// The last point of the path that is visible from its start (m), or the exit itself.
    pub waypoint: Point2<f64>,
    /// Length of the path (m).
    pub length: f64,
}

impl RouteFinder {
    /// Builds the graph for this map and radius (m), unless it exists already.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let radius = if radius.is_nan() {
            0.0
        } else {
            radius.clamp(0.0, MAX_RADIUS)
        };
        let wanted = Some((map.revision(), radius));
        if self.built_for != wanted {
            let lay = || RouteTrees::new(NavGrid::new(map, radius));
            self.route_trees = Some(map.derived().get(radius, lay));
            self.shares = map.is_shared();
            self.built_for = wanted;
            for slot in &mut self.slots {
                slot.planted = TreeKey::Nothing;
            }
        }
    }

    /// The graph of the map that was [prepared](Self::prepare) last.
    pub fn grid(&self) -> Option<&NavGrid> {
        self.route_trees
            .as_ref()
            .map(|route_trees| &route_trees.grid)
    }

    /// The shortest routes from `root` to `targets` (m), with their first legs, kept under a slot
    /// number.
    ///
    /// `None` before [`prepare`], for a root that is not finite, and in a map where the robot fits
    /// nowhere.
    ///
    /// [`prepare`]: Self::prepare
    pub fn routes<'a>(
        &'a mut self,
        map: &'a PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
    ) -> Option<Routes<'a>> {
        self.grow(map, slot, root, targets, true)
    }

    /// As [`routes`](Self::routes), but only for lengths and whole routes, and cheaper: the first
    /// leg of every path is its destination.
    pub fn lengths<'a>(
        &'a mut self,
        map: &'a PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
    ) -> Option<Routes<'a>> {
        self.grow(map, slot, root, targets, false)
    }

    fn grow<'a>(
        &'a mut self,
        map: &'a PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
        gates: bool,
    ) -> Option<Routes<'a>> {
        let route_trees = self.route_trees.as_ref()?;
        let grid = &route_trees.grid;
        let node = grid.node_at(root)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let planted = if gates {
            TreeKey::From(node)
        } else {
            TreeKey::Lengths(node)
        };
        if kept.planted != planted {
            let seed = self.shares.then_some(match planted {
                TreeKey::From(node) => Seed::From(node),
                _ => Seed::Lengths(node),
            });
            kept.plant(route_trees, seed, |tree| {
                if gates {
                    tree.plant(grid, node);
                } else {
                    tree.plant_without_gates(grid, &[node], &[]);
                }
            });
            kept.planted = planted;
        }
        for target in targets
            .into_iter()
            .filter_map(|target| grid.node_at(target))
        {
            kept.reach(route_trees, target);
        }
        Some(Routes {
            map,
            grid,
            tree: &kept.tree,
            horizon: kept.horizon,
        })
    }

    /// The path from a point to the exit (m) that is cheapest to reach past `threats`, kept under a
    /// slot number. The tree is planted anew when the exits change or `renew` is set (because the
    /// threats have moved), but not when only the point moves.
    ///
    /// `None` before [`prepare`](Self::prepare), for a point that is not finite, and when no path
    /// leads to an exit.
    pub fn way_out(
        &mut self,
        map: &PlannerMap,
        slot: usize,
        from: Point2<f64>,
        exits: impl IntoIterator<Item = Point2<f64>> + Clone,
        threats: &[Threat],
        renew: bool,
    ) -> Option<ExitRoute> {
        let route_trees = self.route_trees.as_ref()?;
        let grid = &route_trees.grid;
        let node = grid.node_at(from)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let nodes = || {
            let exits = exits.clone().into_iter();
            exits.filter_map(move |exit| grid.node_at(exit))
        };
        let is_planted = !renew
            && match &kept.planted {
                TreeKey::Out(roots) => roots.iter().copied().eq(nodes()),
                _ => false,
            };
        if !is_planted {
            let roots: Vec<usize> = nodes().collect();
            let seed = self.shares.then(|| Seed::out(&roots, threats));
            kept.plant(route_trees, seed, |tree| {
                tree.plant_without_gates(grid, &roots, threats);
            });
            kept.planted = TreeKey::Out(roots);
        }
        if !kept.reach(route_trees, node) {
            return None;
        }
        descend(map, grid, &kept.tree, from, node, exits)
    }
}

impl Slot {
    /// Replaces the tree by the one that other planners have grown from this seed, or by a new one
    /// that `plant` plants.
    fn plant(
        &mut self,
        route_trees: &RouteTrees,
        seed: Option<Seed>,
        plant: impl FnOnce(&mut RouteTree),
    ) {
        self.horizon = 0;
        match seed.as_ref().map(|seed| route_trees.tree(seed)) {
            Some(Some(known)) => self.tree = known,
            Some(None) => {
                let mut tree = RouteTree::default();
                plant(&mut tree);
                self.tree = Arc::new(tree);
            }
            // In the memory of the old tree, which has no other owner.
            None => plant(Arc::make_mut(&mut self.tree)),
        }
        self.seed = seed;
    }

    /// Grows the tree until it reaches a node; returns `false` if it cannot.
    fn reach(&mut self, route_trees: &RouteTrees, node: usize) -> bool {
        loop {
            if let Some(rank) = self.tree.rank(node) {
                self.horizon = self.horizon.max(rank + 1);
                return true;
            }
            if self.tree.is_complete() {
                self.horizon = self.tree.settled();
                return false;
            }
            let Some(seed) = &self.seed else {
                Arc::make_mut(&mut self.tree).reach(&route_trees.grid, node);
                continue;
            };
            let known = route_trees.tree(seed);
            if let Some(further) = known.filter(|known| known.settled() > self.tree.settled()) {
                self.tree = further;
                continue;
            }
            // A copy, if other planners hold the tree. It grows further than needed, so that copies
            // are rare.
            let tree = Arc::make_mut(&mut self.tree);
            let before = tree.settled();
            tree.reach(&route_trees.grid, node);
            tree.settle(&route_trees.grid, before.saturating_mul(2));
            route_trees.keep(seed, &self.tree);
        }
    }
}

/// Follows the path from a node to its root, and finds its visible part.
fn descend(
    map: &PlannerMap,
    grid: &NavGrid,
    tree: &RouteTree,
    from: Point2<f64>,
    node: usize,
    exits: impl IntoIterator<Item = Point2<f64>>,
) -> Option<ExitRoute> {
    let (tested, hidden) = last_in_sight(map, grid, tree, from, node)?;
    let root = core::iter::successors(Some(tested), |&next| tree.parent(next)).last()?;
    let exit = exits
        .into_iter()
        .find(|&exit| grid.node_at(exit) == Some(root))?;
    Some(ExitRoute {
        exit,
        waypoint: hidden.unwrap_or(exit),
        length: tree.length(node)? + (exit - grid.point(root)?).norm(),
    })
}

/// Tests the lines of sight from a point to the nodes on the path from its node to the root, up to the first that is hidden or
/// too far. Returns a node at or behind the last that was tested, and the last point in sight (m), or the first one, since a
/// robot in contact with a wall sees nothing at full width; no point if the whole path is in sight.
fn last_in_sight(
    map: &PlannerMap,
    grid: &NavGrid,
    tree: &RouteTree,
    from: Point2<f64>,
    node: usize,
) -> Option<(usize, Option<Point2<f64>>)> {
    let length = tree.length(node)?;
    let mut way = core::iter::successors(tree.parent(node), |&next| tree.parent(next));
    let (mut tested, mut last) = (node, None);
    loop {
        // Four lines of sight side by side take less time than two one after the other.
        let (mut nodes, mut points) = ([node; 4], [from; 4]);
        let mut count = 0;
        for ((slot, point), next) in nodes.iter_mut().zip(&mut points).zip(&mut way) {
            (*slot, *point) = (next, grid.point(next)?);
            tested = next;
            count += 1;
        }
        if count == 0 {
            return Some((tested, None));
        }
        let runs = map.free_runs(points.map(|point| (from, point)), grid.inflation());
        for ((&next, point), run) in nodes.iter().zip(points).zip(runs).take(count) {
            let travelled = length - tree.length(next)?;
            let in_sight = travelled < SIGHT && run >= (point - from).norm();
            if !in_sight {
                return Some((tested, last.or(Some(point))));
            }
            last = Some(point);
        }
    }
}

fn slot_of(slots: &mut Vec<Slot>, slot: usize) -> Option<&mut Slot> {
    let slot = slot.min(MAX_SLOTS - 1);
    if slots.len() <= slot {
        slots.resize_with(slot + 1, Slot::default);
    }
    slots.get_mut(slot)
}
