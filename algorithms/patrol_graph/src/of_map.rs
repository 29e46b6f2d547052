//! Patrol graph of a map: a Voronoi diagram of its free space.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use navigation::routes::NavGrid;
use planner_view::map::PlannerMap;
use thiserror::Error;

use crate::graph::{GraphParams, MAX_NODES};

/// Reason why a map has no patrol graph.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum OfMapError {
    /// Too many nodes.
    #[error(
        "`spacing` is {spacing_m} m: expected a length with at most {MAX_NODES} nodes on this map; enlarge it"
    )]
    Spacing {
        /// The spacing (m).
        spacing_m: f64,
    },
    /// Room for one node at most.
    #[error(
        "`spacing` is {spacing_m} m: expected a length with at least 2 nodes in the free space of the map; reduce it"
    )]
    Room {
        /// The spacing (m).
        spacing_m: f64,
    },
}

/// No node.
const NONE: u32 = u32::MAX;

/// Lengths along the streets of a map (mm), and the node from which each is measured.
struct Reach {
    length: Vec<u32>,
    owner: Vec<u32>,
}

impl Reach {
    /// Measures from a street node on, as far as `most` (mm), where that is nearer than what is known.
    fn grow(&mut self, grid: &NavGrid, from: usize, owner: u32, most: u32) {
        let mut open = BinaryHeap::from([Reverse((0, from))]);
        (self.length[from], self.owner[from]) = (0, owner);
        while let Some(Reverse((length, node))) = open.pop() {
            if length > self.length[node] || self.owner[node] != owner {
                continue;
            }
            for edge in grid.edges(node) {
                let (to, through) = (edge.to as usize, length.saturating_add(edge.length));
                if through <= most && through < self.length[to] {
                    (self.length[to], self.owner[to]) = (through, owner);
                    open.push(Reverse((through, to)));
                }
            }
        }
    }
}

/// Returns the patrol graph of the free space in which a robot of this radius (m) can drive; of several such spaces the
/// largest one.
///
/// The nodes lie where the clearance is greatest, first the widest place, and no two nearer than `spacing_m` by the
/// way between them (m, > 0): in the middle of rooms, lanes and junctions, and each free place has a node within `spacing_m`. Each
/// owns the places that are nearest to it (its Voronoi cell). Nodes whose cells touch have an edge, as long as the shortest way
/// through their border.
///
/// # Errors
/// [`OfMapError`] if the spacing does not suit the map.
pub fn graph_of_map(
    map: &PlannerMap,
    radius: f64,
    spacing_m: f64,
) -> Result<GraphParams, OfMapError> {
    let grid = NavGrid::new(map, radius);
    let space = largest_space(&grid);
    let clearance = |&node: &usize| map.clearance(grid.points()[node]);
    let mut widest = space;
    widest.sort_by(|a, b| clearance(b).total_cmp(&clearance(a)).then(a.cmp(b)));
    let mut reach = Reach {
        length: vec![u32::MAX; grid.len()],
        owner: vec![NONE; grid.len()],
    };
    let most = (spacing_m * 1000.0) as u32;
    let mut params = GraphParams::default();
    for &node in &widest {
        if reach.owner[node] == NONE {
            if params.nodes.len() == MAX_NODES {
                return Err(OfMapError::Spacing { spacing_m });
            }
            reach.grow(&grid, node, params.nodes.len() as u32, most);
            let at = grid.points()[node];
            params.nodes.push([at.x, at.y]);
        }
    }
    if params.nodes.len() < 2 {
        return Err(OfMapError::Room { spacing_m });
    }
    let mut borders: Vec<([usize; 2], u32)> = Vec::new();
    for &node in &widest {
        for edge in grid.edges(node) {
            let to = edge.to as usize;
            let (a, b) = (reach.owner[node], reach.owner[to]);
            if a < b {
                let length = reach.length[node] + edge.length + reach.length[to];
                borders.push(([a as usize, b as usize], length));
            }
        }
    }
    borders.sort_unstable();
    borders.dedup_by_key(|(pair, _)| *pair);
    for (pair, length) in borders {
        params.edges.push(pair);
        params.lengths.push(f64::from(length) * 1e-3);
    }
    Ok(params)
}

/// The street nodes of the largest connected space, in order.
fn largest_space(grid: &NavGrid) -> Vec<usize> {
    let mut seen = vec![false; grid.len()];
    let mut largest = Vec::new();
    for start in 0..grid.len() {
        if core::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut space, mut next) = (vec![start], 0);
        while let Some(&node) = space.get(next) {
            next += 1;
            for edge in grid.edges(node) {
                if !core::mem::replace(&mut seen[edge.to as usize], true) {
                    space.push(edge.to as usize);
                }
            }
        }
        if space.len() > largest.len() {
            largest = space;
        }
    }
    largest.sort_unstable();
    largest
}

#[cfg(test)]
mod tests {
    use geometry::map::{ObstacleSpec, VectorMap, WorldMap};
    use geometry::shape::Shape;
    use nalgebra::Point2;

    use super::*;
    use crate::PatrolGraph;

    /// A ring of streets, 2 m wide, around a block.
    fn ring() -> PlannerMap {
        let mut map = VectorMap::empty([0.0; 2], [14.0, 14.0], 0.1);
        map.obstacles.push(ObstacleSpec {
            name: String::new(),
            shape: Shape::Rectangle {
                center: [7.0, 7.0],
                half_extents: [5.0, 5.0],
                angle: 0.0,
            },
        });
        let world = WorldMap::from_vectors(&map).unwrap();
        PlannerMap::of_world(&world, 0.2, 1).unwrap()
    }

    #[test]
    fn the_graph_of_a_ring_is_a_ring_in_the_middle_of_its_streets() {
        let params = graph_of_map(&ring(), 0.3, 4.0).unwrap();
        let graph = PatrolGraph::new(&params).unwrap();
        assert!((8..=13).contains(&graph.count()), "{params:?}");
        for node in 0..graph.count() {
            assert_eq!(graph.edges(node).len(), 2, "{node} of {params:?}");
            let [x, y] = params.nodes[node];
            let from_edge = x.min(y).min(14.0 - x).min(14.0 - y);
            assert!((0.8..1.2).contains(&from_edge), "{:?}", params.nodes[node]);
        }
        // Every free place has a node within the spacing.
        let corner = Point2::new(0.5, 13.5);
        let nearest = graph.points()[graph.nearest(corner)];
        assert!((nearest - corner).norm() < 4.0);
    }

    #[test]
    fn a_spacing_that_does_not_suit_the_map_is_named() {
        let text = |spacing_m| {
            graph_of_map(&ring(), 0.3, spacing_m)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            text(100.0),
            "`spacing` is 100 m: expected a length with at least 2 nodes in the free space of the \
             map; reduce it"
        );
        assert_eq!(
            text(0.1),
            "`spacing` is 0.1 m: expected a length with at most 500 nodes on this map; enlarge it"
        );
    }
}
