//! The chain of the strategy [`Markov`](crate::Strategy::Markov).

use patrol_chain::{BestResponse, Capture, Chain, ChainError, TravelTimes, optimise};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::graph::PatrolGraph;

/// Maximum of nodes × directed edges × steps of an attack: the optimisation takes about ten seconds.
const WORK: f64 = 4e5;
/// Random starts of the optimisation.
const STARTS: u32 = 3;

/// Attacks of one duration at the nodes of a graph, in whole steps.
///
/// A step is half of the shortest drive along an edge, or longer on a large graph. Times of drives are rounded up and the
/// duration is rounded down: the floor of a chain holds for the true ones, too.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attacks {
    times: TravelTimes,
    durations: Vec<u32>,
}

impl Attacks {
    /// Attacks of a duration (s) at any node, against a robot with this speed (m/s) that takes in addition this time (s) for each edge.
    ///
    /// # Errors
    /// [`ChainError`] for an attack that is shorter than a step, or times out of range.
    pub fn new(
        graph: &PatrolGraph,
        attack_s: f64,
        v: f64,
        turn_s: f64,
    ) -> Result<Self, ChainError> {
        let nodes = graph.count();
        let edges = || {
            let edges = (0..nodes).flat_map(|at| graph.edges(at).iter().map(move |e| (at, e)));
            edges.map(|(at, edge)| (at, edge.to, edge.length_m / v + turn_s))
        };
        let shortest_s = edges().map(|edge| edge.2).fold(f64::INFINITY, f64::min);
        let work = (nodes * edges().count()) as f64;
        let step_s = (0.5 * shortest_s).max(attack_s * work / WORK);
        // Casts of floats saturate.
        let times = edges().map(|(at, to, time_s)| (at, to, (time_s / step_s).ceil() as u32));
        let attacks = Self {
            times: TravelTimes::new(nodes, times)?,
            durations: vec![(attack_s / step_s) as u32; nodes],
        };
        Capture::new(&Chain::uniform(attacks.times.clone()), &attacks.durations)?;
        Ok(attacks)
    }

    /// A chain with a high floor, the same on every machine.
    ///
    /// # Errors
    /// None for attacks that [`Attacks::new`] accepts.
    pub fn chain(&self) -> Result<Chain, ChainError> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        optimise(&self.times, &self.durations, STARTS, &mut random)
    }

    /// The attack on a chain that is caught least often.
    ///
    /// # Errors
    /// None for the chain of these attacks.
    pub fn best(&self, chain: &Chain) -> Result<BestResponse, ChainError> {
        Ok(Capture::new(chain, &self.durations)?.best_response())
    }

    /// The chain of a random walk.
    pub fn random_walk(&self) -> Chain {
        Chain::uniform(self.times.clone())
    }
}
