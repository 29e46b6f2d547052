//! Lengths of the shortest routes between all places.

use std::sync::{Arc, OnceLock};

use nalgebra::Point2;
use planner_view::map::PlannerMap;

use super::nav_grid::NavGrid;
use super::route_tree::RouteTree;

/// Maximum number of lengths that are kept for a map, 2 bytes each.
const MAX_KEPT: usize = 1 << 24;

/// A length that means "no path".
const UNREACHED: u16 = u16::MAX;

/// Key of [`Lengths`] among the values derived from a map.
#[derive(PartialEq)]
struct Key(f64);

/// Lengths of the shortest routes from places of a map. Routes from one place are computed once for all planners that
/// share the map, if the map is small: a query then takes no search.
#[derive(Debug)]
pub struct Lengths {
    grid: NavGrid,
    /// By their roots; empty if there are too many.
    kept: Vec<OnceLock<Arc<[u16]>>>,
}

/// Lengths of the routes from the last place that was asked for.
#[derive(Debug, Clone, Default)]
pub struct LengthsFrom {
    root: Option<usize>,
    /// Per node, the length (cm).
    lengths: Arc<[u16]>,
}

/// End of routes, of the same map as their begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteEnd {
    node: usize,
    /// Length (m) from the node to the end.
    beyond: f64,
}

impl LengthsFrom {
    /// Returns the length of the way to an end (m), to the accuracy of the grid; infinite if there is none.
    pub fn to(&self, end: Option<RouteEnd>) -> f64 {
        let end = end.filter(|_| self.root.is_some());
        let length = end.and_then(|end| Some((*self.lengths.get(end.node)?, end.beyond)));
        match length {
            Some((length, beyond)) if length != UNREACHED => f64::from(length) / 100.0 + beyond,
            _ => f64::INFINITY,
        }
    }
}

impl Lengths {
    /// Returns the lengths of a map for a robot of this radius (m).
    pub fn of_map(map: &PlannerMap, radius: f64) -> Arc<Self> {
        map.derived().get(Key(radius), || {
            let grid = NavGrid::new(map, radius);
            let is_small = grid.len().saturating_mul(grid.len()) <= MAX_KEPT;
            let count = if is_small { grid.len() } else { 0 };
            let kept = (0..count).map(|_| OnceLock::new()).collect();
            Self { grid, kept }
        })
    }

    /// Changes `from` to the lengths from this point (m). Returns `false` for a point that is not finite, and in a map
    /// where the robot fits nowhere. `from` must be of the same map.
    pub fn start(&self, at: Point2<f64>, from: &mut LengthsFrom) -> bool {
        let root = self.grid.node_at(at);
        if root != from.root {
            from.root = root;
            if let Some(root) = root {
                from.lengths = match self.kept.get(root) {
                    Some(kept) => Arc::clone(kept.get_or_init(|| self.grow(root))),
                    None => self.grow(root),
                };
            }
        }
        root.is_some()
    }

    /// Returns a point (m) as the end of routes; `None` as [`Self::start`] returns `false`.
    pub fn end(&self, at: Point2<f64>) -> Option<RouteEnd> {
        let node = self.grid.node_at(at)?;
        let beyond = (at - self.grid.point(node)?).norm();
        Some(RouteEnd { node, beyond })
    }

    /// Returns the lengths of the routes from a node (cm).
    fn grow(&self, root: usize) -> Arc<[u16]> {
        let mut tree = RouteTree::default();
        tree.plant_without_gates(&self.grid, &[root], &[]);
        tree.settle(&self.grid, u32::MAX);
        let lengths = (0..self.grid.len()).map(|node| {
            let length = tree.length_mm(node).map(|mm| (mm + 5) / 10);
            length.map_or(UNREACHED, |cm| cm.min(u32::from(UNREACHED - 1)) as u16)
        });
        lengths.collect()
    }
}
