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
}

/// One exit.
#[derive(Debug, Clone)]
struct Exit {
    nodes: Vec<u32>,
    /// Length of the shortest path to the exit from each node (m), as the time of a wave of 1 m/s.
    path: Wave,
}

impl Arena {
    /// The arena for robots of this radius (m), with exits that evaders reach with their centre.
    pub fn new(map: &PlannerMap, params: &DominanceParams, radius: f64, exits: &[Region]) -> Self {
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
                Exit { nodes, path }
            })
            .collect();
        Self { medium, exits }
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
