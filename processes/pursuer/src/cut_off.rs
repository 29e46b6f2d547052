//! Places that cut a target off from the exits.
//!
//! Pursuers that all drive at an evader end up behind it, one after the other. Instead they take
//! the places that its ways out lead through: a *cut* of the street graph, the removal of whose
//! places leaves no way from the target to an exit. It is found greedily: the shortest way out that
//! is left gets a place, the graph's nodes within a pursuer's [`block_radius`] of the place are
//! taken out, and so on until no way is left. (Taking out what was found to get the next, different
//! way is the penalty method for alternative routes in its strictest form.)
//!
//! On a way, no place is of use before the first one at which some pursuer is in time, i.e. not
//! later than the target driving there at its highest speed. A cut of such first places is as tight
//! as can be held, but near the target the streets are many; towards the exits they join, and
//! fewer places do. So cuts are tried at the first places, and at a quarter, a half, three quarters
//! and all of the remaining way to the exit, and the first is taken for which there are places
//! enough. If there is none (more exits than places), the shortest ways out are cut and the rest
//! stay open; also if guards stand at the exits, where a cut would add nothing.
//!
//! One pursuer always drives at the target: a cut that is held by all has nobody to close it, and a
//! target that does not move would be besieged for ever.
//!
//! [`block_radius`]: crate::params::AssignmentParams::block_radius

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::Point2;
use navigation::routes::{NavGrid, RouteFinder, RouteTree};
use planner_view::map::PlannerMap;

use crate::matching::{milliseconds, one_each};

/// Where cuts are tried, as shares of the way from the first place in time to the exit.
const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A length (mm) that means "no way", and a node that means "none".
const NONE: u32 = u32::MAX;

/// Whom to cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaderState {
    /// Where it is (m).
    pub at: Point2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
    /// Whether the exits are guarded, so that they need not be blocked.
    pub guarded: bool,
}

/// Someone who can take a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitBlocker {
    /// Where it is (m).
    pub at: Point2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
    /// Where the route finder keeps its ways.
    pub slot: usize,
}

/// Places that block ways out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cut {
    /// The places (m), in the order in which they were found.
    pub places: Vec<Point2<f64>>,
    /// Whether no way out is left.
    pub complete: bool,
}

/// Finds cuts, in memory that is used again.
#[derive(Debug, Clone, Default)]
pub struct CutSearch {
    /// The shortest ways to the exits, nothing blocked.
    to_exit: RouteTree,
    exits: Vec<usize>,
    /// Revision, number of nodes and exits that these were found for.
    built_for: Option<(u64, usize, Vec<usize>)>,
    blocked: Vec<bool>,
    length: Vec<u32>,
    parent: Vec<u32>,
    /// Nodes on the rim, with the least length of a way through them (mm).
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    /// The way found last: places (m) and the length up to there (m).
    way: Vec<(Point2<f64>, f64)>,
}

impl CutSearch {
    /// A cut between a target and the exits (m), of fewer places than there are blockers.
    ///
    /// `finder` must have been prepared for the map. Nothing with fewer than two blockers, and
    /// nothing (but complete) where no way leads out.
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
        let exits = exits
            .into_iter()
            .filter_map(|exit| grid.node_at(exit))
            .collect();
        let nodes = grid.len();
        self.prepare(map.revision(), grid, exits);
        let Some(start) = grid.node_at(evader.at) else {
            return Cut::default();
        };
        let mut tight = None;
        for share in SHARES {
            if evader.guarded && share >= 1.0 {
                break;
            }
            self.blocked.clear();
            self.blocked.resize(nodes, false);
            let mut cut = Cut::default();
            loop {
                cut.complete = !finder.grid().is_some_and(|grid| self.way_out(grid, start));
                if cut.complete || cut.places.len() >= most {
                    break;
                }
                let place = self.place(map, finder, evader.v_max, blockers, share);
                if let Some(grid) = finder.grid() {
                    self.block(grid, start, place, block_radius);
                }
                cut.places.push(place);
            }
            if cut.complete {
                return cut;
            }
            tight.get_or_insert(cut);
        }
        tight.unwrap_or_default()
    }

    /// Measures the ways to the exits, unless that has been done.
    fn prepare(&mut self, revision: u64, grid: &NavGrid, exits: Vec<usize>) {
        let wanted = (revision, grid.len(), exits);
        if self.built_for.as_ref() == Some(&wanted) {
            return;
        }
        self.to_exit.plant_without_gates(grid, &wanted.2, &[]);
        self.to_exit.settle(grid, u32::MAX);
        self.exits.clone_from(&wanted.2);
        self.built_for = Some(wanted);
    }

    /// Finds the shortest way from a node to an exit past the blocked nodes; whether there is one.
    ///
    /// A\* with the unblocked lengths, which are consistent: blocking only makes ways longer.
    fn way_out(&mut self, grid: &NavGrid, start: usize) -> bool {
        self.way.clear();
        self.length.clear();
        self.length.resize(grid.len(), NONE);
        self.parent.clear();
        self.parent.resize(grid.len(), NONE);
        self.queue.clear();
        let Some(ahead) = self.to_exit.length_mm(start) else {
            return false;
        };
        self.queue.push(Reverse((ahead, start as u32)));
        self.length[start] = 0;
        while let Some(Reverse((estimate, node))) = self.queue.pop() {
            let node = node as usize;
            let length = self.length[node];
            let ahead = self.to_exit.length_mm(node).unwrap_or(NONE);
            if estimate > length.saturating_add(ahead) {
                continue;
            }
            if self.exits.contains(&node) && !self.blocked[node] {
                self.retrace(grid, node);
                return true;
            }
            for edge in grid.edges(node) {
                let to = edge.to as usize;
                let reached = length.saturating_add(edge.length);
                if !self.blocked[to]
                    && reached < self.length[to]
                    && let Some(ahead) = self.to_exit.length_mm(to)
                {
                    self.length[to] = reached;
                    self.parent[to] = node as u32;
                    let estimate = reached.saturating_add(ahead);
                    self.queue.push(Reverse((estimate, edge.to)));
                }
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

    /// The place on the way that was found last: `share` of what remains of it behind the first
    /// place where some blocker is in time.
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
            // Only an earlier place than the one found is of interest.
            let ahead = self.way.get(..first).unwrap_or_default();
            let places = ahead.iter().map(|&(place, _)| place);
            let routes = finder.lengths(map, blocker.slot, blocker.at, places);
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

    /// Takes the nodes around a place out of the graph, but never the one the target is at.
    fn block(&mut self, grid: &NavGrid, start: usize, place: Point2<f64>, radius: f64) {
        for (node, (point, blocked)) in grid.points().iter().zip(&mut self.blocked).enumerate() {
            if node != start && (point - place).norm() <= radius {
                *blocked = true;
            }
        }
        // Even if the radius is less than half a block of the graph.
        if let Some(node) = grid.node_at(place).filter(|&node| node != start)
            && let Some(blocked) = self.blocked.get_mut(node)
        {
            *blocked = true;
        }
    }
}

/// The places of a cut given to the blockers, one each at the least sum of driving times; `None`
/// for those that shall drive at the target at `at` (m) itself.
pub fn allot(
    map: &PlannerMap,
    finder: &mut RouteFinder,
    blockers: &[ExitBlocker],
    cut: &Cut,
    at: Point2<f64>,
) -> Vec<Option<Point2<f64>>> {
    let count = blockers.len();
    let goals: Vec<_> = (0..count)
        .map(|column| cut.places.get(column).copied())
        .collect();
    let mut costs = Vec::with_capacity(count * count);
    for blocker in blockers {
        let places = goals.iter().map(|goal| goal.unwrap_or(at));
        let routes = finder.lengths(map, blocker.slot, blocker.at, places.clone());
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
