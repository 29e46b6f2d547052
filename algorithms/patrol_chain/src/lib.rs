//! Random patrols of graphs with a guaranteed probability of capture.
//!
//! A robot at a node draws the next one from the node's row of a Markov chain. An intruder knows the chain, sees at
//! which node the robot is, and attacks a node for the duration of an attack there. The *floor* of the chain is the
//! probability that the robot comes to the attacked node in time under the best choice of both nodes: no intruder
//! without the key of the draws is captured less often, however long it has watched.
//!
//! - [`TravelTimes`]: the graph, with times as whole steps;
//! - [`Chain`]: probabilities of the next node, drawn from a key stream;
//! - [`Capture`]: probabilities of capture, the best response of an intruder, and derivatives;
//! - [`optimise`](fn@optimise): a chain with a high floor.
//!
//! The problem is that of Duan, Paccagnan and Bullo (*Stochastic strategies for robotic surveillance as Stackelberg
//! games*, IEEE TCNS 2021), with travel times as in John et al. (`RoSSO`, ICRA 2024, arXiv 2309.08742, weighted
//! formulation). The intruder sees the node that the robot leaves, not the edge that it takes. Of a team each robot draws from a
//! key of its own: the floor holds for each, so that of the team is not lower.
//!
//! ```
//! use patrol_chain::{Capture, Chain, TravelTimes};
//!
//! // A triangle: within two steps the robot is back at the node that it leaves with probability 1/2.
//! let sides = [(0, 1, 1), (1, 2, 1), (2, 0, 1)];
//! let times = TravelTimes::new(3, sides.into_iter().flat_map(|(a, b, t)| [(a, b, t), (b, a, t)]))?;
//! let chain = Chain::uniform(times);
//! let response = Capture::new(&chain, &[2, 2, 2])?.best_response();
//! assert_eq!((response.from, response.at, response.probability), (0, 0, 0.5));
//! # Ok::<(), patrol_chain::ChainError>(())
//! ```

mod capture;
mod chain;
mod optimise;
mod times;

pub use capture::{BestResponse, Capture};
pub use chain::Chain;
pub use chaotic_maps::KeyedStream;
pub use optimise::optimise;
pub use times::{ChainError, Edge, TravelTimes};

#[cfg(test)]
mod tests;
