//! Patrols of graphs.
//!
//! - [`PatrolGraph`]: nodes to visit and edges between them, with all shortest paths;
//! - [`tour`]: closed walks through nodes, on which robots follow each other.

mod graph;
mod tour;

pub use graph::{Edge, GraphError, GraphParams, MAX_NODES, PatrolGraph};
pub use tour::tour;
