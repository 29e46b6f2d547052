//! Patrols of graphs.
//!
//! - [`PatrolGraph`]: nodes to visit and edges between them, with all shortest paths;
//! - [`graph_of_map`]: the graph of the free space of a map;
//! - [`Strategy`]: the strategies of the literature; [`Walker`]: a robot that walks a graph by one of them;
//! - [`Attacks`]: the chain of the strategy `markov`, and its floor;
//! - [`LastVisits`]: the idleness of nodes, as the robots of a team share it;
//! - [`tour`](fn@tour): closed walks through nodes, on which robots follow each other; [`parts`](fn@parts): division among robots.

mod choices;
mod graph;
mod idleness;
mod markov;
mod of_map;
mod params;
mod parts;
mod tour;
mod walker;

#[cfg(test)]
mod tests;

pub use graph::{Edge, GraphError, GraphParams, MAX_NODES, PatrolGraph};
pub use idleness::LastVisits;
pub use markov::Attacks;
pub use of_map::{OfMapError, graph_of_map};
pub use params::{AssignmentParams, BayesParams, MarkovParams, Strategy};
pub use parts::parts;
pub use tour::tour;
pub use walker::{Seen, Walker};
