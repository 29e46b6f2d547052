//! Route trees that are kept between ticks.

use nalgebra::Point2;

use super::nav_grid::{NavGrid, NavParams};
use super::route_tree::{RouteTree, Routes, Threat};
use crate::map::PlannerMap;

/// Most trees that are kept; a slot beyond it shares the last one.
const MAX_SLOTS: usize = 256;

/// Radii above this [m] are taken as this; no arena holds such a robot, a broken message may.
const MAX_RADIUS: f64 = 10.0;

/// Keeps a [`NavGrid`] of the current map and one [`RouteTree`] per slot, and plants a tree anew
/// only when its root has come to another node, or the map or the robot's radius has changed.
#[derive(Debug, Clone)]
pub struct Wayfinder {
    params: NavParams,
    built_for: Option<(u64, f64)>,
    grid: Option<NavGrid>,
    slots: Vec<Slot>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    planted: Planted,
    tree: RouteTree,
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
    /// The exit [m].
    pub exit: Point2<f64>,
    /// The last point of the way that can be seen from where it begins [m], or the exit itself.
    pub waypoint: Point2<f64>,
    /// Length of the way [m].
    pub length: f64,
}

impl Wayfinder {
    /// A way-finder without a map.
    pub fn new(params: NavParams) -> Self {
        Self {
            params,
            built_for: None,
            grid: None,
            slots: Vec::new(),
        }
    }

    /// Builds the graph for this map and radius [m], unless it is the one already built.
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        let radius = if radius.is_nan() {
            0.0
        } else {
            radius.clamp(0.0, MAX_RADIUS)
        };
        let wanted = Some((map.revision(), radius));
        if self.built_for != wanted {
            self.grid = Some(NavGrid::new(map, &self.params, radius));
            self.built_for = wanted;
            for slot in &mut self.slots {
                slot.planted = Planted::Nothing;
            }
        }
    }

    /// The shortest ways from `root` to `targets` [m], with their first legs, kept under a slot
    /// number.
    ///
    /// `None` before [`prepare`], for a root that is not finite, and in a map where the robot fits
    /// nowhere.
    ///
    /// [`prepare`]: Self::prepare
    pub fn routes(
        &mut self,
        map: &PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
    ) -> Option<Routes<'_>> {
        self.grow(map, slot, root, targets, true)
    }

    /// As [`routes`](Self::routes), but good only for lengths and whole ways, and cheaper: the
    /// first leg of every way is its destination.
    pub fn lengths(
        &mut self,
        map: &PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
    ) -> Option<Routes<'_>> {
        self.grow(map, slot, root, targets, false)
    }

    fn grow(
        &mut self,
        map: &PlannerMap,
        slot: usize,
        root: Point2<f64>,
        targets: impl IntoIterator<Item = Point2<f64>>,
        gates: bool,
    ) -> Option<Routes<'_>> {
        let grid = self.grid.as_ref()?;
        let node = grid.node_at(root)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let planted = if gates {
            Planted::From(node)
        } else {
            Planted::Lengths(node)
        };
        if kept.planted != planted {
            if gates {
                kept.tree.plant(grid, node);
            } else {
                kept.tree.plant_without_gates(grid, &[node], &[]);
            }
            kept.planted = planted;
        }
        for target in targets
            .into_iter()
            .filter_map(|target| grid.node_at(target))
        {
            kept.tree.reach(map, grid, target);
        }
        Some(Routes {
            grid,
            tree: &kept.tree,
        })
    }

    /// The way from a point to the exit [m] that is cheapest to reach past `threats`, kept under a
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
        let grid = self.grid.as_ref()?;
        let node = grid.node_at(from)?;
        let kept = slot_of(&mut self.slots, slot)?;
        let roots = exits
            .clone()
            .into_iter()
            .filter_map(|exit| grid.node_at(exit))
            .collect();
        let planted = Planted::Out(roots);
        if let Planted::Out(roots) = &planted
            && (renew || kept.planted != planted)
        {
            kept.tree.plant_without_gates(grid, roots, threats);
            kept.planted = planted;
        }
        if !kept.tree.reach(map, grid, node) {
            return None;
        }
        descend(map, grid, &kept.tree, from, node, exits)
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
        in_sight = travelled < grid.sight() && map.line_is_clear(from, point, grid.inflation());
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
