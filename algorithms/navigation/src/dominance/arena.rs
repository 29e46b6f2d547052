//! Data that depend only on the map: the medium of waves, the exits and the paths to them.

use geometry::region::Region;

use super::DominanceParams;
use crate::wavefront::{Lattice, Medium, SIGHT, Source, Wave};
use planner_view::map::PlannerMap;

/// The free space of a map with its exits.
#[derive(Debug, Clone)]
pub struct Arena {
    medium: Medium,
    exits: Vec<Exit>,
    /// Pairs of near places with an obstacle between them.
    hidden: Vec<(u32, u32)>,
}

/// One exit.
#[derive(Debug, Clone)]
struct Exit {
    region: Region,
    nodes: Vec<u32>,
    /// Length of the shortest path to the exit from each node (m), as the time of a wave of 1 m/s.
    path: Wave,
}

impl Arena {
    /// The arena for robots of this radius (m), with exits that evaders reach with their centre.
    /// Pursuers stop evaders within `reach` (m) at most, also through walls.
    pub fn new(
        map: &PlannerMap,
        params: &DominanceParams,
        radius: f64,
        exits: &[Region],
        reach: f64,
    ) -> Self {
        let lattice = Lattice::new(map, params.pitch, radius);
        let medium = Medium::new(map, lattice, SIGHT);
        let lattice = medium.lattice();
        let exits = exits
            .iter()
            .map(|region| {
                let nodes = nodes_of(lattice, region);
                let sources: Vec<Source> = nodes
                    .iter()
                    .filter_map(|&node| lattice.point(node as usize))
                    .map(|at| Source::new(at, 1.0, 0))
                    .collect();
                let mut path = Wave::default();
                path.spread(&medium, map, &sources, None);
                Exit {
                    region: *region,
                    nodes,
                    path,
                }
            })
            .collect();
        let hidden = hidden(map, &medium, reach);
        Self {
            medium,
            exits,
            hidden,
        }
    }

    /// The pairs of places (the second a node) such that a pursuer at the second could stop an evader
    /// at the first through a wall, if each is anywhere in its cell.
    pub(super) fn hidden(&self) -> &[(u32, u32)] {
        &self.hidden
    }

    /// The region of an exit.
    pub fn exit(&self, exit: usize) -> Option<&Region> {
        self.exits.get(exit).map(|exit| &exit.region)
    }

    /// The places where robots fit.
    pub fn lattice(&self) -> &Lattice {
        self.medium.lattice()
    }

    /// The medium in which waves between these places travel.
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    /// Number of exits.
    pub fn exits(&self) -> usize {
        self.exits.len()
    }

    /// The nodes that lie in an exit; none if no robot fits into it.
    pub fn exit_nodes(&self, exit: usize) -> &[u32] {
        self.exits.get(exit).map_or(&[], |exit| &exit.nodes)
    }

    /// The shortest paths to an exit, as a wave of 1 m/s from it: its times are lengths (m).
    pub fn way_to(&self, exit: usize) -> Option<&Wave> {
        self.exits.get(exit).map(|exit| &exit.path)
    }
}

/// Maximum distance of a robot from the centre of its cell (m).
pub fn within_cell(lattice: &Lattice) -> f64 {
    core::f64::consts::FRAC_1_SQRT_2 * lattice.pitch()
}

/// The pairs of places with an obstacle between them whose distance may be less than `reach` (m).
fn hidden(map: &PlannerMap, medium: &Medium, reach: f64) -> Vec<(u32, u32)> {
    let lattice = medium.lattice();
    let reach = reach + within_cell(lattice);
    // A line whose cells have this clearance at their centres crosses no obstacle.
    let free = core::f64::consts::FRAC_1_SQRT_2 * map.clearance_grid().frame.resolution;
    let mut hidden = Vec::new();
    for from in 0..medium.places() {
        let Some(at) = medium.point(from) else {
            continue;
        };
        if map.clearance(at) > reach {
            continue;
        }
        lattice.for_each_within(at, reach, |to, _| {
            let is_hidden = |to| !map.line_is_clear(at, to, free);
            if lattice.point(to).is_some_and(is_hidden) {
                hidden.push((from as u32, to as u32));
            }
        });
    }
    hidden
}

/// The nodes whose centre lies in a region; for a region smaller than a cell, the nearest node.
fn nodes_of(lattice: &Lattice, region: &Region) -> Vec<u32> {
    let mut nodes = Vec::new();
    let (center, reach) = (region.center(), region.bounding_radius());
    lattice.for_each_within(center, reach, |node, _| {
        if lattice.point(node).is_some_and(|p| region.contains(p)) {
            nodes.push(node as u32);
        }
    });
    if nodes.is_empty() {
        let near = lattice.nearest(center, reach.max(lattice.pitch()));
        nodes.extend(near.map(|node| node as u32));
    }
    nodes
}
