//! Route trees that are kept between ticks.

use std::sync::Arc;

use nalgebra::Point2;

use super::nav_grid::{NavGrid, SIGHT};
use super::route_tree::{RouteTree, Routes, Threat};
use super::ways::{Seed, Ways};
use planner_view::map::PlannerMap;

/// Most trees that are kept; a slot beyond it shares the last one.
const MAX_SLOTS: usize = 256;

/// Radii above this (m) are taken as this; no arena holds such a robot, a broken message may.
const MAX_RADIUS: f64 = 10.0;

/// Keeps the graph of the current map (one for all planners that share the map) and one
/// [`RouteTree`] per slot, and plants a tree anew
/// only when its root has come to another node, or the map or the robot's radius has changed.
#[derive(Debug, Clone, Default)]
pub struct Wayfinder {
    built_for: Option<(u64, f64)>,
    ways: Option<Arc<Ways>>,
    /// Whether other planners use the same trees.
    shares: bool,
    slots: Vec<Slot>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    planted: Planted,
    /// What the tree grew from, if others use it too.
    seed: Option<Seed>,
    tree: Arc<RouteTree>,
    /// How far the tree would have grown if it were used here alone (nodes): answers must not
    /// depend on others.
    horizon: u32,
}

/// What a slot's tree was planted for.
#[derive(Debug, Clone, Default, PartialEq)]
enum Planted {
    #[default]
    Nothing,
    /// Ways with gates from a node.
    From(usize),
    /// Lengths from a node.
    Lengths(usize),
    /// Ways to the cheapest of these nodes.
    Out(Vec<usize>),
}

/// The way to the exit that is cheapest to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WayOut {
    /// The exit (m).
    pub exit: Point2<f64>,
    /// The last point of the way that can be seen from where it begins (m), or the exit itself.
    pub waypoint: Point2<f64>,
    /// Length of the way (m).
    pub length: f64,
}

impl Wayfinder {
    /// Builds the graph for this map and radius (m), unless it is the one already built.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let radius = if radius.is_nan() {
            0.0
        } else {
            radius.clamp(0.0, MAX_RADIUS)
        };
        let wanted = Some((map.revision(), radius));
        if self.built_for != wanted {
            let lay = || Ways::new(NavGrid::new(map, radius));
            self.ways = Some(map.derived().get(radius, lay));
            self.shares = map.is_shared();
            self.built_for = wanted;
            for slot in &mut self.slots {
                slot.planted = Planted::Nothing;
            }
        }
    }

    /// The graph of the map that was [prepared](Self::prepare) last.
    pub fn grid(&self) -> Option<&NavGrid> {
        self.ways.as_ref().map(|ways| &ways.grid)
    }

    /// The shortest ways from `root` to `targets` (m), with their first legs, kept under a slot
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

    /// As [`routes`](Self::routes), but good only for lengths and whole ways, and cheaper: the
    /// first leg of every way is its destination.
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
        let ways = self.ways.as_ref()?;
        let grid = &ways.grid;
        let node = grid.node_at(root)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let planted = if gates {
            Planted::From(node)
        } else {
            Planted::Lengths(node)
        };
        if kept.planted != planted {
            let seed = self.shares.then_some(match planted {
                Planted::From(node) => Seed::From(node),
                _ => Seed::Lengths(node),
            });
            kept.plant(ways, seed, |tree| {
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
            kept.reach(ways, target);
        }
        Some(Routes {
            map,
            grid,
            tree: &kept.tree,
            horizon: kept.horizon,
        })
    }

    /// The way from a point to the exit (m) that is cheapest to reach past `threats`, kept under a
    /// slot number; planted anew when the exits change or `renew` is set (because the threats have
    /// moved), but not when only the point moves.
    ///
    /// `None` before [`prepare`](Self::prepare), for a point that is not finite, and when no way
    /// leads out.
    pub fn way_out(
        &mut self,
        map: &PlannerMap,
        slot: usize,
        from: Point2<f64>,
        exits: impl IntoIterator<Item = Point2<f64>> + Clone,
        threats: &[Threat],
        renew: bool,
    ) -> Option<WayOut> {
        let ways = self.ways.as_ref()?;
        let grid = &ways.grid;
        let node = grid.node_at(from)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let nodes = || {
            let exits = exits.clone().into_iter();
            exits.filter_map(move |exit| grid.node_at(exit))
        };
        let is_planted = !renew
            && match &kept.planted {
                Planted::Out(roots) => roots.iter().copied().eq(nodes()),
                _ => false,
            };
        if !is_planted {
            let roots: Vec<usize> = nodes().collect();
            let seed = self.shares.then(|| Seed::out(&roots, threats));
            kept.plant(ways, seed, |tree| {
                tree.plant_without_gates(grid, &roots, threats);
            });
            kept.planted = Planted::Out(roots);
        }
        if !kept.reach(ways, node) {
            return None;
        }
        descend(map, grid, &kept.tree, from, node, exits)
    }
}

impl Slot {
    /// Takes another tree: the one that others have grown from this seed, or a new one, which
    /// `plant` plants.
    fn plant(&mut self, ways: &Ways, seed: Option<Seed>, plant: impl FnOnce(&mut RouteTree)) {
        self.horizon = 0;
        match seed.as_ref().map(|seed| ways.tree(seed)) {
            Some(Some(known)) => self.tree = known,
            Some(None) => {
                let mut tree = RouteTree::default();
                plant(&mut tree);
                self.tree = Arc::new(tree);
            }
            // In the memory of the old one, which nobody else has.
            None => plant(Arc::make_mut(&mut self.tree)),
        }
        self.seed = seed;
    }

    /// Grows the tree until it reaches a node; whether it does.
    fn reach(&mut self, ways: &Ways, node: usize) -> bool {
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
                Arc::make_mut(&mut self.tree).reach(&ways.grid, node);
                continue;
            };
            let known = ways.tree(seed);
            if let Some(further) = known.filter(|known| known.settled() > self.tree.settled()) {
                self.tree = further;
                continue;
            }
            // A copy, if others look at it; so that copies are rare, it grows further than needed.
            let tree = Arc::make_mut(&mut self.tree);
            let before = tree.settled();
            tree.reach(&ways.grid, node);
            tree.settle(&ways.grid, before.saturating_mul(2));
            ways.keep(seed, &self.tree);
        }
    }
}

/// Follows the way from a node to its root, and finds how far it can be seen.
fn descend(
    map: &PlannerMap,
    grid: &NavGrid,
    tree: &RouteTree,
    from: Point2<f64>,
    node: usize,
    exits: impl IntoIterator<Item = Point2<f64>>,
) -> Option<WayOut> {
    let length = tree.length(node)?;
    let mut waypoint = grid.point(node)?;
    let (mut root, mut in_sight) = (node, true);
    while let Some(next) = tree.parent(root) {
        root = next;
        if !in_sight {
            continue;
        }
        let point = grid.point(root)?;
        let travelled = length - tree.length(root)?;
        // The first step is taken on trust: a robot that hugs a wall sees nothing at full width.
        in_sight = travelled < SIGHT && map.line_is_clear(from, point, grid.inflation());
        if in_sight || waypoint == grid.point(node)? {
            waypoint = point;
        }
    }
    let exit = exits
        .into_iter()
        .find(|&exit| grid.node_at(exit) == Some(root))?;
    if in_sight {
        waypoint = exit;
    }
    Some(WayOut {
        exit,
        waypoint,
        length: length + (exit - grid.point(root)?).norm(),
    })
}

fn slot_of(slots: &mut Vec<Slot>, slot: usize) -> Option<&mut Slot> {
    let slot = slot.min(MAX_SLOTS - 1);
    if slots.len() <= slot {
        slots.resize_with(slot + 1, Slot::default);
    }
    slots.get_mut(slot)
}
