//! Probabilities of capture, and their derivatives.
//!
//! With the probability p of the edge from i to h and its travel time w, the probability that a robot which leaves i is
//! at j within t steps is
//!
//! ```text
//! G_ij(t) = Σ_h p_ih A_hj(t − w_ih),    A_hj(t) = 0 for t < 0;  1 for h = j;  G_hj(t) else, with G_hj(0) = 0
//! ```
//!
//! (the sum over time of `RoSSO`'s first hitting times). The probability of capture is `C_ij = G_ij(τ_j)`. Derivatives are those of
//! the recursion, backwards in time: with `λ_ij` the derivative by `C_ij`, each term of the sum passes `λ A` on to `p`
//! and `λ p` to `A`.

use crate::chain::Chain;
use crate::times::{ChainError, MAX_STEPS};

/// Probabilities of capture of a chain.
#[derive(Debug, Clone)]
pub struct Capture<'a> {
    chain: &'a Chain,
    /// For each attacked node j: `A_hj(t)` at `t * nodes + h`, up to the duration of an attack at j.
    arrivals: Vec<Vec<f64>>,
    /// `C_ij` at `j * nodes + i`.
    probabilities: Vec<f64>,
}

/// The choice of an intruder with the lowest probability of capture; the first of several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BestResponse {
    /// Node that the robot leaves when the attack begins.
    pub from: usize,
    /// Attacked node.
    pub at: usize,
    /// Probability of capture: the floor of the chain.
    pub probability: f64,
}

impl<'a> Capture<'a> {
    /// The probabilities for attacks of these durations (steps), one per node.
    ///
    /// # Errors
    /// [`ChainError::Durations`] and [`ChainError::Duration`].
    pub fn new(chain: &'a Chain, durations: &[u32]) -> Result<Self, ChainError> {
        let nodes = chain.times().nodes();
        if durations.len() != nodes {
            return Err(ChainError::Durations {
                found: durations.len(),
                nodes,
            });
        }
        let is_invalid = |steps: &u32| *steps == 0 || *steps > MAX_STEPS;
        if let Some(node) = durations.iter().position(is_invalid) {
            return Err(ChainError::Duration {
                node,
                steps: durations[node],
            });
        }
        let mut capture = Self {
            chain,
            arrivals: Vec::with_capacity(nodes),
            probabilities: Vec::with_capacity(nodes * nodes),
        };
        for (at, &duration) in durations.iter().enumerate() {
            capture.add(at, duration as usize);
        }
        Ok(capture)
    }

    /// Adds the probabilities of an attacked node.
    fn add(&mut self, at: usize, duration: usize) {
        let nodes = self.chain.times().nodes();
        let mut arrivals = vec![0.0; duration * nodes];
        for t in 0..duration {
            for from in 0..nodes {
                arrivals[t * nodes + from] = if from == at {
                    1.0
                } else {
                    self.sum(&arrivals, from, t)
                };
            }
        }
        for from in 0..nodes {
            let probability = self.sum(&arrivals, from, duration);
            self.probabilities.push(probability);
        }
        self.arrivals.push(arrivals);
    }

    /// `G(t)` of a node that is left.
    fn sum(&self, arrivals: &[f64], from: usize, t: usize) -> f64 {
        let nodes = self.chain.times().nodes();
        let terms = self
            .chain
            .row(from)
            .iter()
            .zip(self.chain.times().from(from));
        let terms = terms.filter_map(|(probability, edge)| {
            let left = t.checked_sub(edge.time as usize)?;
            Some(probability * arrivals[left * nodes + edge.to])
        });
        // The sum of no terms would be −0.
        terms.fold(0.0, |sum, term| sum + term)
    }

    /// The best response of an intruder.
    pub fn best_response(&self) -> BestResponse {
        let nodes = self.chain.times().nodes();
        let mut best = BestResponse {
            from: 0,
            at: 0,
            probability: f64::INFINITY,
        };
        for (index, &probability) in self.probabilities.iter().enumerate() {
            if probability < best.probability {
                best = BestResponse {
                    from: index % nodes,
                    at: index / nodes,
                    probability,
                };
            }
        }
        best
    }

    /// All probabilities, at `at * nodes + from`.
    pub(crate) fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The derivatives by the probabilities of the edges of a function with these derivatives by [`Self::probabilities`].
    pub(crate) fn gradient(&self, weights: &[f64]) -> Vec<Vec<f64>> {
        let times = self.chain.times();
        let nodes = times.nodes();
        let mut by_edge: Vec<Vec<f64>> = (0..nodes)
            .map(|node| vec![0.0; times.from(node).len()])
            .collect();
        let mut by_arrival = Vec::new();
        for (at, arrivals) in self.arrivals.iter().enumerate() {
            let duration = arrivals.len() / nodes;
            by_arrival.clear();
            by_arrival.extend_from_slice(&vec![0.0; arrivals.len()]);
            by_arrival.extend_from_slice(&weights[at * nodes..(at + 1) * nodes]);
            for t in (1..=duration).rev() {
                for from in (0..nodes).filter(|&from| t == duration || from != at) {
                    let weight = by_arrival[t * nodes + from];
                    for (index, edge) in times.from(from).iter().enumerate() {
                        if let Some(left) = t.checked_sub(edge.time as usize) {
                            let place = left * nodes + edge.to;
                            by_edge[from][index] += weight * arrivals[place];
                            by_arrival[place] += weight * self.chain.row(from)[index];
                        }
                    }
                }
            }
        }
        by_edge
    }
}
