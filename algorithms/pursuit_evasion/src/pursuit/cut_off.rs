//! Places that cut a target off from the exits.
//!
//! Pursuers that all drive at an evader end up behind it, one after the other. Instead they take
//! places on its escape paths: a *cut* of the street graph, the removal of whose places leaves no
//! path from the target to an exit. A greedy search finds it: the shortest remaining escape path
//! gets a place, the graph's nodes within a pursuer's [`block_radius`] of the place are removed, and
//! so on until no path is left. (Removing the found path to get the next, different one is the
//! strictest form of the penalty method for alternative routes.)
//!
//! On a path, only places that some pursuer reaches in time are useful, i.e. not later than the
//! target at its highest speed. A cut of the first such places is the tightest possible one, but
//! there are many streets near the target. Towards the exits they join, and fewer places suffice.
//! Cuts are therefore tried at the first places, and at a quarter, a half, three quarters and all of
//! the remaining path to the exit. The first cut for which there are enough pursuers is used. If
//! there is none (more exits than places), the shortest escape paths are cut and the rest stay open.
//!
//! One pursuer always drives at the target. Otherwise a complete cut would have no pursuer to close
//! it, and a target that does not move would be surrounded for ever.
//!
//! [`block_radius`]: super::params::AssignmentParams::block_radius

use core::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::{Mutex, PoisonError};

use nalgebra::Point2;
use navigation::routes::{NavGrid, RouteFinder, RouteTree};
use planner_view::map::PlannerMap;

use super::matching::{milliseconds, one_each};

/// Candidate places of cuts, as shares of the path from the first place reached in time to the
/// exit.
const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Number of allotments that planners of a shared map keep for each other: those of several runs at once.
const MAX_KEPT: usize = 16;

/// Length (mm) that means "no path", and node that means "none".
const NONE: u32 = u32::MAX;

/// Evader to cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaderState {
    /// Position (m).
    pub at: Point2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
}

/// Pursuer that can take a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitBlocker {
    /// Position (m).
    pub at: Point2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
    /// Slot of its trees in the route finder.
    pub slot: usize,
}

/// Places that block escape paths.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cut {
    /// Places (m), in the order of the search.
    pub places: Vec<Point2<f64>>,
    /// `true` if no escape path is left.
    pub complete: bool,
}

/// Inputs that determine an allotment, besides the graph: exits (m), target, blockers and their radius (m).
type Siege = (Vec<Point2<f64>>, EvaderState, Vec<ExitBlocker>, f64);

/// Places of blockers; `None` for those that drive at the target.
type Places = Vec<Option<Point2<f64>>>;

/// Allotments of the planners that share a map, the newest first: all pursuers of a target have the same.
type Known = Mutex<VecDeque<(Siege, Places)>>;

/// Finds a cut.
#[derive(Debug, Clone, Default)]
pub struct CutSearch {
    /// Per node, the length of its shortest path to an exit (mm) without blocked nodes; [`NONE`] if it is blocked itself.
    ahead: Vec<u32>,
    length: Vec<u32>,
    parent: Vec<u32>,
    /// Nodes on the frontier, with the minimum length of a path through them (mm).
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    /// Path found last: places (m) and the length up to them (m).
    way: Vec<(Point2<f64>, f64)>,
}

impl CutSearch {
    /// Returns the places of the blockers, a [cut](Self::cut) at the minimum sum of driving times.
    pub(super) fn places(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        exits: impl IntoIterator<Item = Point2<f64>>,
        evader: &EvaderState,
        blockers: &[ExitBlocker],
        block_radius: f64,
    ) -> Places {
        let exits: Vec<_> = exits.into_iter().collect();
        let siege: Siege = (exits.clone(), *evader, blockers.to_vec(), block_radius);
        let inflation = finder.grid().map(NavGrid::inflation);
        let known = map.derived().get(inflation, Known::default);
        let lock = || known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, places)) = lock().iter().find(|(known, _)| *known == siege) {
            return places.clone();
        }
        let cut = self.cut(map, finder, exits, evader, blockers, block_radius);
        let places = allot(map, finder, blockers, &cut, evader.at);
        let mut known = lock();
        known.push_front((siege, places.clone()));
        known.truncate(MAX_KEPT);
        places
    }

    /// Returns a cut between a target and the exits (m), with fewer places than blockers.
    ///
    /// `finder` must have been prepared for the map. The cut is empty for fewer than two blockers,
    /// and empty and complete if no path leads out.
    pub fn cut(
        &mut self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        exits: impl IntoIterator<Item = Point2<f64>>,
        evader: &EvaderState,
        blockers: &[ExitBlocker],
        block_radius: f64,
    ) -> Cut {
        let most = blockers.len().saturating_sub(1);
        let Some(grid) = finder.grid().filter(|_| most > 0) else {
            return Cut::default();
        };
        let exits = exits.into_iter();
        let exits: Vec<usize> = exits.filter_map(|exit| grid.node_at(exit)).collect();
        // Shortest paths to the exits, without blocked nodes.
        let key = (grid.inflation().to_bits(), exits.clone());
        let to_exit = &*map.derived().get(key, || {
            let mut tree = RouteTree::default();
            tree.plant_without_gates(grid, &exits, &[]);
            tree.settle(grid, u32::MAX);
            let ahead = |node| tree.length_mm(node).unwrap_or(NONE);
            (0..grid.len()).map(ahead).collect::<Vec<u32>>()
        });
        let Some(start) = grid.node_at(evader.at) else {
            return Cut::default();
        };
        self.ahead.clone_from(to_exit);
        let is_open = finder
            .grid()
            .is_some_and(|grid| self.way_out(grid, &exits, start));
        if !is_open {
            return Cut {
                complete: true,
                ..Cut::default()
            };
        }
        let shortest = self.way.clone();
        let mut tight = None;
        for share in SHARES {
            self.ahead.clone_from(to_exit);
            self.way.clone_from(&shortest);
            let mut cut = Cut::default();
            while !cut.complete && cut.places.len() < most {
                let place = self.place(map, finder, evader.v_max, blockers, share);
                cut.places.push(place);
                let is_last = cut.places.len() == most;
                cut.complete = !finder.grid().is_some_and(|grid| {
                    self.block(grid, start, place, block_radius);
                    if is_last {
                        self.is_open(grid, &exits, start)
                    } else {
                        self.way_out(grid, &exits, start)
                    }
                });
            }
            if cut.complete {
                return cut;
            }
            tight.get_or_insert(cut);
        }
        tight.unwrap_or_default()
    }

    /// Finds the shortest path from a node to an exit past the blocked nodes; returns `true` if
    /// there is one.
    ///
    /// A\* with the unblocked lengths as heuristic. They are consistent: blocking only makes paths
    /// longer.
    fn way_out(&mut self, grid: &NavGrid, exits: &[usize], start: usize) -> bool {
        self.way.clear();
        self.length.clear();
        self.length.resize(grid.len(), NONE);
        self.parent.clear();
        self.parent.resize(grid.len(), NONE);
        self.queue.clear();
        let ahead = self.ahead[start];
        if ahead == NONE {
            return false;
        }
        self.queue.push(Reverse((ahead, start as u32)));
        self.length[start] = 0;
        while let Some(Reverse((estimate, node))) = self.queue.pop() {
            let node = node as usize;
            let length = self.length[node];
            if estimate > length.saturating_add(self.ahead[node]) {
                continue;
            }
            if exits.contains(&node) {
                self.retrace(grid, node);
                return true;
            }
            for edge in grid.edges(node) {
                let to = edge.to as usize;
                let reached = length.saturating_add(edge.length);
                let ahead = self.ahead[to];
                if ahead != NONE && reached < self.length[to] {
                    self.length[to] = reached;
                    self.parent[to] = node as u32;
                    let estimate = reached.saturating_add(ahead);
                    self.queue.push(Reverse((estimate, edge.to)));
                }
            }
        }
        false
    }

    /// Returns `true` if [`Self::way_out`] would find a path; blocks the nodes that it reaches, so that
    /// each is reached once.
    fn is_open(&mut self, grid: &NavGrid, exits: &[usize], start: usize) -> bool {
        let mut frontier = Vec::new();
        if core::mem::replace(&mut self.ahead[start], NONE) != NONE {
            frontier.push(start as u32);
        }
        while let Some(node) = frontier.pop() {
            let node = node as usize;
            if exits.contains(&node) {
                return true;
            }
            let mut least = NONE;
            for edge in grid.edges(node) {
                let ahead = core::mem::replace(&mut self.ahead[edge.to as usize], NONE);
                if ahead == NONE {
                    continue;
                }
                frontier.push(edge.to);
                // The next one is the nearest to an exit.
                if least <= ahead {
                    let last = frontier.len() - 1;
                    frontier.swap(last, last - 1);
                }
                least = least.min(ahead);
            }
        }
        false
    }

    fn retrace(&mut self, grid: &NavGrid, exit: usize) {
        let mut node = exit;
        while let (Some(point), Some(&length)) = (grid.point(node), self.length.get(node)) {
            self.way.push((point, f64::from(length) / 1000.0));
            match self.parent.get(node) {
                Some(&parent) if parent != NONE => node = parent as usize,
                _ => break,
            }
        }
        self.way.reverse();
    }

    /// Returns the place on the last path at `share` of its remainder behind the first place that
    /// some blocker reaches in time.
    fn place(
        &self,
        map: &PlannerMap,
        finder: &mut RouteFinder,
        v_max: f64,
        blockers: &[ExitBlocker],
        share: f64,
    ) -> Point2<f64> {
        let last = self.way.len().saturating_sub(1);
        let mut first = last;
        for blocker in blockers {
            // Only a place before the current one is an improvement.
            let ahead = self.way.get(..first).unwrap_or_default();
            let places = ahead.iter().map(|&(place, _)| place);
            let routes = finder.routes(map, blocker.slot, blocker.at, places);
            let Some(routes) = routes else {
                continue;
            };
            let in_time = ahead.iter().position(|&(place, length)| {
                routes
                    .distance_to(place)
                    .is_some_and(|distance| distance * v_max <= length * blocker.v_max)
            });
            first = in_time.unwrap_or(first);
        }
        let index = first + ((last - first) as f64 * share).round() as usize;
        self.way
            .get(index)
            .map_or_else(Point2::origin, |&(place, _)| place)
    }

    /// Removes the nodes around a place from the graph, but never the target's node.
    fn block(&mut self, grid: &NavGrid, start: usize, place: Point2<f64>, radius: f64) {
        for (node, (point, ahead)) in grid.points().iter().zip(&mut self.ahead).enumerate() {
            let offset = point - place;
            if offset.x.abs() <= radius && offset.norm() <= radius && node != start {
                *ahead = NONE;
            }
        }
        // Required if the radius is less than half a block of the graph.
        if let Some(node) = grid.node_at(place).filter(|&node| node != start)
            && let Some(ahead) = self.ahead.get_mut(node)
        {
            *ahead = NONE;
        }
    }
}

/// Assigns the places of a cut to the blockers, at the minimum sum of driving times; `None` for
/// those that drive at the target at `at` (m) itself.
fn allot(
    map: &PlannerMap,
    finder: &mut RouteFinder,
    blockers: &[ExitBlocker],
    cut: &Cut,
    at: Point2<f64>,
) -> Places {
    let count = blockers.len();
    let goals: Vec<_> = (0..count)
        .map(|column| cut.places.get(column).copied())
        .collect();
    let mut costs = Vec::with_capacity(count * count);
    for blocker in blockers {
        let places = goals.iter().map(|goal| goal.unwrap_or(at));
        let routes = finder.routes(map, blocker.slot, blocker.at, places.clone());
        costs.extend(places.map(|place| {
            let distance = routes
                .and_then(|routes| routes.distance_to(place))
                .unwrap_or((place - blocker.at).norm());
            milliseconds(distance / blocker.v_max)
        }));
    }
    let chosen = one_each(&costs, count, count);
    chosen
        .into_iter()
        .map(|column| goals.get(column).copied().flatten())
        .collect()
}

#[cfg(test)]
mod tests {
    use testing::{Arena, EXIT, RADIUS};

    use super::*;

    #[test]
    fn a_graph_is_open_exactly_if_it_has_a_path() {
        let grid = NavGrid::new(&Arena::city().map(), RADIUS);
        let exits = [grid.node_at(EXIT).unwrap()];
        let start = grid.node_at(Point2::new(-4.5, 1.5)).unwrap();
        let mut search = CutSearch::default();
        let mut open = 0;
        for round in 0..200_usize {
            // A pattern that blocks the more nodes the later the round.
            let is_blocked = |node: usize| (node * (2 * round + 7919)) % 1009 < 4 * round;
            let ahead = |node| if is_blocked(node) { NONE } else { 0 };
            search.ahead = (0..grid.len()).map(ahead).collect();
            let has_path = search.way_out(&grid, &exits, start);
            assert_eq!(search.is_open(&grid, &exits, start), has_path, "{round}");
            open += u32::from(has_path);
        }
        assert!((40..160).contains(&open), "{open}");
    }
}
