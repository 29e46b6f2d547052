//! Graphs with travel times.

use thiserror::Error;

/// Maximum number of nodes.
const MAX_NODES: usize = 1000;
/// Maximum travel time and duration of an attack (steps).
pub(crate) const MAX_STEPS: u32 = 10_000;

/// Reason why a graph or chain is invalid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ChainError {
    /// The number of nodes is out of range.
    #[error("the number of nodes is {0}: expected 1 to {MAX_NODES}")]
    Nodes(usize),
    /// An edge leads from or to a node that the graph lacks.
    #[error("an edge names node {node}: expected 0 to {}", .nodes - 1)]
    Node {
        /// The node.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The travel time of an edge is out of range.
    #[error("the travel time from node {from} to {to} is {time}: expected 1 to {MAX_STEPS} steps")]
    Time {
        /// First node.
        from: usize,
        /// Second node.
        to: usize,
        /// Travel time (steps).
        time: u32,
    },
    /// Two edges lead from one node to another.
    #[error("the edge from node {from} to {to} is there twice: remove one")]
    Twice {
        /// First node.
        from: usize,
        /// Second node.
        to: usize,
    },
    /// No walk leads from one node to another.
    #[error("node {to} cannot be reached from node {from}: add edges")]
    Unreachable {
        /// First node.
        from: usize,
        /// Second node.
        to: usize,
    },
    /// The number of durations differs from that of the nodes.
    #[error("the number of durations of attacks is {found}: expected {nodes}, one per node")]
    Durations {
        /// Number of durations.
        found: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The duration of an attack is out of range.
    #[error("the duration of an attack at node {node} is {steps}: expected 1 to {MAX_STEPS} steps")]
    Duration {
        /// The node.
        node: usize,
        /// Duration (steps).
        steps: u32,
    },
}

/// An edge from a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The node to which it leads.
    pub to: usize,
    /// Travel time (steps, at least 1).
    pub time: u32,
}

/// A graph with travel times; from each node a walk leads to each other one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TravelTimes {
    /// Edges from each node, by the node to which they lead.
    edges: Vec<Vec<Edge>>,
}

impl TravelTimes {
    /// A graph from directed edges: node, node to which it leads, travel time (steps). An edge from a node to itself is a
    /// wait there.
    ///
    /// # Errors
    /// [`ChainError`] for nodes and times out of range, and for a graph that is not strongly connected.
    pub fn new(
        nodes: usize,
        edges: impl IntoIterator<Item = (usize, usize, u32)>,
    ) -> Result<Self, ChainError> {
        if nodes == 0 || nodes > MAX_NODES {
            return Err(ChainError::Nodes(nodes));
        }
        let mut from_each: Vec<Vec<Edge>> = vec![Vec::new(); nodes];
        for (from, to, time) in edges {
            if let Some(&node) = [from, to].iter().find(|&&node| node >= nodes) {
                return Err(ChainError::Node { node, nodes });
            }
            if time == 0 || time > MAX_STEPS {
                return Err(ChainError::Time { from, to, time });
            }
            match from_each[from].binary_search_by_key(&to, |edge| edge.to) {
                Ok(_) => return Err(ChainError::Twice { from, to }),
                Err(at) => from_each[from].insert(at, Edge { to, time }),
            }
        }
        let mut to_each = vec![Vec::new(); nodes];
        for (from, edges) in from_each.iter().enumerate() {
            for edge in edges {
                to_each[edge.to].push(from);
            }
        }
        if let Some(to) = unreached(nodes, |node| from_each[node].iter().map(|edge| edge.to)) {
            return Err(ChainError::Unreachable { from: 0, to });
        }
        if let Some(from) = unreached(nodes, |node| to_each[node].iter().copied()) {
            return Err(ChainError::Unreachable { from, to: 0 });
        }
        // The only node of a graph returns to itself, too.
        if from_each[0].is_empty() {
            return Err(ChainError::Unreachable { from: 0, to: 0 });
        }
        Ok(Self { edges: from_each })
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.edges.len()
    }

    /// The edges from a node, by the node to which they lead.
    pub fn from(&self, node: usize) -> &[Edge] {
        &self.edges[node]
    }
}

/// The first node to which no walk leads from node 0.
fn unreached<I: Iterator<Item = usize>>(nodes: usize, next: impl Fn(usize) -> I) -> Option<usize> {
    let mut is_reached = vec![false; nodes];
    is_reached[0] = true;
    let mut open = vec![0];
    while let Some(node) = open.pop() {
        for to in next(node) {
            if !core::mem::replace(&mut is_reached[to], true) {
                open.push(to);
            }
        }
    }
    is_reached.iter().position(|reached| !reached)
}
