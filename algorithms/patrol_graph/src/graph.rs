//! Graph of a patrol: nodes at points, edges with lengths, shortest paths between all nodes.

use nalgebra::Point2;
use parameters::{Parameters, ParamsError, above, each, unit};
use thiserror::Error;

/// Maximum number of nodes: the shortest paths between all of them are kept.
pub const MAX_NODES: usize = 500;

parameters::table! {
    /// A graph as a scenario states it.
    ///
    /// ```
    /// use patrol_graph::{GraphParams, PatrolGraph};
    ///
    /// let triangle = GraphParams {
    ///     nodes: vec![[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]],
    ///     edges: vec![[0, 1], [1, 2], [2, 0]],
    ///     lengths: Vec::new(),
    /// };
    /// let graph = PatrolGraph::new(&triangle).unwrap();
    /// assert_eq!(graph.distance_m(0, 2), 5.0);
    /// ```
    pub struct GraphParams {
        /// The nodes to visit, x and y; at least 2. Without any, they follow from the map.
        pub nodes: Vec<[f64; 2]> [each(each(unit("m")))],
        /// Pairs of nodes, by their indices, between which robots drive in both directions. The graph is connected.
        pub edges: Vec<[usize; 2]>,
        /// Lengths of the edges, in their order; if absent, the distances between their nodes.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub lengths: Vec<f64> [each(above(0).unit("m"))],
    }
}

impl Parameters for GraphParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        if self.nodes.is_empty() && self.edges.is_empty() && self.lengths.is_empty() {
            return Ok(());
        }
        match PatrolGraph::new(self) {
            Ok(_) => Ok(()),
            Err(error) => Err(ParamsError::naming(error.to_string())),
        }
    }
}

/// Reason why nodes and edges are no patrol graph.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GraphError {
    /// A number of nodes out of its range.
    #[error("`nodes` has {0} points: expected 2 to {MAX_NODES}")]
    Count(usize),
    /// A node whose coordinates are not finite.
    #[error("`nodes[{0}]` is not finite: expected x and y in metres")]
    NotFinite(usize),
    /// An edge to a node that the graph does not have.
    #[error("`edges[{edge}]` names node {node}: expected 0 to {}", count - 1)]
    UnknownNode {
        /// Index of the edge.
        edge: usize,
        /// The named node.
        node: usize,
        /// Number of nodes.
        count: usize,
    },
    /// An edge from a node to itself.
    #[error("`edges[{edge}]` is [{node}, {node}]: expected two different nodes; remove it")]
    SelfLoop {
        /// Index of the edge.
        edge: usize,
        /// The node.
        node: usize,
    },
    /// An edge that is listed twice.
    #[error("`edges[{edge}]` is [{a}, {b}] again: expected each edge once; remove it")]
    Twice {
        /// Index of the second edge.
        edge: usize,
        /// Its first node.
        a: usize,
        /// Its second node.
        b: usize,
    },
    /// Lengths that do not belong to the edges.
    #[error("`lengths` has {lengths} values: expected one for each of the {edges} edges, or none")]
    Lengths {
        /// Number of lengths.
        lengths: usize,
        /// Number of edges.
        edges: usize,
    },
    /// An edge without a length, such as one between two nodes at the same place.
    #[error("the length of `edges[{edge}]` is {length_m} m: expected a finite length above 0")]
    Length {
        /// Index of the edge.
        edge: usize,
        /// Its length (m).
        length_m: f64,
    },
    /// A node that no way reaches from the first one.
    #[error("`nodes[{0}]` has no way to it from node 0: expected a connected graph; add an edge")]
    NotConnected(usize),
}

/// An edge from a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The node at its other end.
    pub to: usize,
    /// Its length (m), above 0.
    pub length_m: f64,
}

/// A connected graph of nodes to visit.
#[derive(Debug, Clone, PartialEq)]
pub struct PatrolGraph {
    points: Vec<Point2<f64>>,
    edges: Vec<Vec<Edge>>,
    /// Lengths of the shortest paths, row by row.
    distances: Vec<f64>,
    /// The node after the first one on these paths.
    onward: Vec<usize>,
}

impl PatrolGraph {
    /// Checks a graph and computes its shortest paths.
    ///
    /// # Errors
    /// [`GraphError`] names the node or the edge.
    pub fn new(params: &GraphParams) -> Result<Self, GraphError> {
        let count = params.nodes.len();
        if !(2..=MAX_NODES).contains(&count) {
            return Err(GraphError::Count(count));
        }
        let points: Vec<Point2<f64>> = params.nodes.iter().map(|&node| node.into()).collect();
        if let Some(node) = params
            .nodes
            .iter()
            .position(|p| !p.iter().all(|c| c.is_finite()))
        {
            return Err(GraphError::NotFinite(node));
        }
        let (given, expected) = (params.lengths.len(), params.edges.len());
        if given != 0 && given != expected {
            return Err(GraphError::Lengths {
                lengths: given,
                edges: expected,
            });
        }
        let mut edges: Vec<Vec<Edge>> = vec![Vec::new(); count];
        for (edge, &[a, b]) in params.edges.iter().enumerate() {
            if let Some(&node) = [a, b].iter().find(|&&node| node >= count) {
                return Err(GraphError::UnknownNode { edge, node, count });
            }
            if a == b {
                return Err(GraphError::SelfLoop { edge, node: a });
            }
            if edges[a].iter().any(|known| known.to == b) {
                return Err(GraphError::Twice { edge, a, b });
            }
            let straight_m = (points[b] - points[a]).norm();
            let length_m = params.lengths.get(edge).copied().unwrap_or(straight_m);
            if !(length_m > 0.0 && length_m.is_finite()) {
                return Err(GraphError::Length { edge, length_m });
            }
            edges[a].push(Edge { to: b, length_m });
            edges[b].push(Edge { to: a, length_m });
        }
        Self::with_paths(points, edges)
    }

    /// Adds the shortest paths (Floyd and Warshall).
    fn with_paths(points: Vec<Point2<f64>>, edges: Vec<Vec<Edge>>) -> Result<Self, GraphError> {
        let count = points.len();
        let mut distances = vec![f64::INFINITY; count * count];
        let mut onward: Vec<usize> = (0..count * count).map(|pair| pair % count).collect();
        for (from, edges) in edges.iter().enumerate() {
            distances[from * count + from] = 0.0;
            for edge in edges {
                distances[from * count + edge.to] = edge.length_m;
            }
        }
        for via in 0..count {
            let row: Vec<f64> = distances[via * count..][..count].to_vec();
            for from in 0..count {
                let first = distances[from * count + via];
                for (to, &second) in row.iter().enumerate() {
                    let pair = from * count + to;
                    if first + second < distances[pair] {
                        distances[pair] = first + second;
                        onward[pair] = onward[from * count + via];
                    }
                }
            }
        }
        match distances[..count].iter().position(|d| d.is_infinite()) {
            Some(node) => Err(GraphError::NotConnected(node)),
            None => Ok(Self {
                points,
                edges,
                distances,
                onward,
            }),
        }
    }

    /// Number of nodes, at least 2.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// Positions of the nodes (m).
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The edges from a node, in the order of the parameters; none from an unknown node.
    pub fn edges(&self, node: usize) -> &[Edge] {
        self.edges.get(node).map_or(&[], Vec::as_slice)
    }

    /// Length of the shortest path between two nodes (m); infinite for an unknown node.
    pub fn distance_m(&self, from: usize, to: usize) -> f64 {
        let known = from < self.count() && to < self.count();
        let pair = known.then_some(from * self.count() + to);
        pair.map_or(f64::INFINITY, |pair| self.distances[pair])
    }

    /// The node after `from` on the shortest path to another one; `to` itself for equal or unknown nodes.
    pub fn onward(&self, from: usize, to: usize) -> usize {
        let known = from < self.count() && to < self.count();
        let pair = known.then_some(from * self.count() + to);
        pair.map_or(to, |pair| self.onward[pair])
    }

    /// The node nearest to a point (m), of equal ones the first.
    pub fn nearest(&self, at: Point2<f64>) -> usize {
        let mut nearest = (f64::INFINITY, 0);
        for (node, point) in self.points.iter().enumerate() {
            let distance = (point - at).norm();
            if distance < nearest.0 {
                nearest = (distance, node);
            }
        }
        nearest.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(nodes: &[[f64; 2]], edges: &[[usize; 2]]) -> GraphParams {
        GraphParams {
            nodes: nodes.to_vec(),
            edges: edges.to_vec(),
            lengths: Vec::new(),
        }
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn shortest_paths_lead_over_other_nodes() {
        let mut square = params(&SQUARE, &[[0, 1], [1, 2], [2, 3], [3, 0]]);
        square.lengths = vec![1.0, 1.0, 1.0, 5.0];
        let graph = PatrolGraph::new(&square).unwrap();
        assert_eq!(graph.distance_m(0, 3), 3.0);
        assert_eq!((graph.onward(0, 3), graph.onward(3, 0)), (1, 2));
        assert_eq!((graph.onward(2, 2), graph.onward(0, 9)), (2, 9));
        assert_eq!(graph.distance_m(0, 9), f64::INFINITY);
        assert_eq!(graph.nearest(Point2::new(0.9, 0.8)), 2);
        assert_eq!(
            graph.edges(0)[1],
            Edge {
                to: 3,
                length_m: 5.0
            }
        );
    }

    #[test]
    fn faults_name_the_node_or_the_edge() {
        let text = |params: &GraphParams| PatrolGraph::new(params).unwrap_err().to_string();
        assert_eq!(
            text(&params(&SQUARE[..1], &[])),
            "`nodes` has 1 points: expected 2 to 500"
        );
        assert_eq!(
            text(&params(&[[0.0, 0.0], [f64::NAN, 1.0]], &[])),
            "`nodes[1]` is not finite: expected x and y in metres"
        );
        assert_eq!(
            text(&params(&SQUARE, &[[0, 1], [1, 4]])),
            "`edges[1]` names node 4: expected 0 to 3"
        );
        assert_eq!(
            text(&params(&SQUARE, &[[2, 2]])),
            "`edges[0]` is [2, 2]: expected two different nodes; remove it"
        );
        assert_eq!(
            text(&params(&SQUARE, &[[0, 1], [1, 0]])),
            "`edges[1]` is [1, 0] again: expected each edge once; remove it"
        );
        assert_eq!(
            text(&params(&[[0.0, 0.0], [0.0, 0.0]], &[[0, 1]])),
            "the length of `edges[0]` is 0 m: expected a finite length above 0"
        );
        assert_eq!(
            text(&params(&SQUARE, &[[0, 1], [2, 3]])),
            "`nodes[2]` has no way to it from node 0: expected a connected graph; add an edge"
        );
        let mut short = params(&SQUARE, &[[0, 1], [1, 2]]);
        short.lengths = vec![1.0];
        assert_eq!(
            text(&short),
            "`lengths` has 1 values: expected one for each of the 2 edges, or none"
        );
    }
}
