//! Chains with a high floor.
//!
//! The floor is not differentiable. In its place stands the soft minimum `−ln(Σ exp(−β C_ij)) / β`, which is lower by at
//! most `ln(n²) / β`, with a β that doubles from stage to stage. Probabilities are soft maxima of free numbers (`RoSSO`: normalised
//! absolute values), which Adam (Kingma and Ba, 2015) moves along the gradient of [`Capture::gradient`]. The result is
//! a local optimum, the best of several random starts.

use geometry::math::{exp, ln};
use rand::{Rng, RngExt as _};

use crate::capture::Capture;
use crate::chain::Chain;
use crate::times::{ChainError, TravelTimes};

/// Sharpness of the soft minimum in the first stage, and number of stages.
const FIRST_BETA: f64 = 200.0;
const STAGES: u32 = 8;
/// Steps of a stage, and length of a step in the first one; in each later one it is shorter by a factor.
const STEPS: u32 = 100;
const FIRST_LENGTH: f64 = 0.05;
const SHORTER: f64 = 0.7;
/// Decay of the means of the gradient and of its square.
const DECAY: [f64; 2] = [0.9, 0.99];

/// The chain with the highest floor of those found from this many random starts, for attacks of these durations (steps),
/// one per node. The same random stream gives the same chain on every machine.
///
/// # Errors
/// As [`Capture::new`].
pub fn optimise(
    times: &TravelTimes,
    durations: &[u32],
    starts: u32,
    random: &mut impl Rng,
) -> Result<Chain, ChainError> {
    let mut best = Chain::uniform(times.clone());
    let mut floor = Capture::new(&best, durations)?.best_response().probability;
    for _ in 0..starts {
        let mut ascent = Ascent::new(times, random);
        for stage in 0..STAGES {
            let beta = FIRST_BETA * f64::from(1_u32 << stage);
            for _ in 0..STEPS {
                let chain = ascent.chain(times);
                let capture = Capture::new(&chain, durations)?;
                let found = capture.best_response().probability;
                let by_edge = capture.gradient(&soft_weights(capture.probabilities(), beta, found));
                ascent.step(&chain, &by_edge, stage);
                if found > floor {
                    (floor, best) = (found, chain);
                }
            }
        }
    }
    Ok(best)
}

/// The derivatives of the soft minimum of values whose minimum is given.
pub(crate) fn soft_weights(values: &[f64], beta: f64, minimum: f64) -> Vec<f64> {
    let mut weights: Vec<f64> = values
        .iter()
        .map(|value| exp(-beta * (value - minimum)))
        .collect();
    let sum: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}

/// An ascent along the gradient.
struct Ascent {
    /// Logarithm of the weight of each edge, and means of its derivative and of the square of this.
    edges: Vec<Vec<[f64; 3]>>,
    /// Products of the decays over all steps.
    remain: [f64; 2],
}

impl Ascent {
    /// An ascent from a random chain.
    fn new(times: &TravelTimes, random: &mut impl Rng) -> Self {
        let edges = (0..times.nodes()).map(|node| {
            let edges = times.from(node).iter();
            edges
                .map(|_| [ln(random.random::<f64>() + 0.01), 0.0, 0.0])
                .collect()
        });
        Self {
            edges: edges.collect(),
            remain: [1.0; 2],
        }
    }

    /// The present chain.
    fn chain(&self, times: &TravelTimes) -> Chain {
        let rows = self.edges.iter().map(|row| {
            let most = row.iter().map(|edge| edge[0]).fold(f64::MIN, f64::max);
            row.iter().map(|edge| exp(edge[0] - most)).collect()
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        Chain::from_weights(times.clone(), &rows)
    }

    /// Moves along the derivatives by the probabilities of the edges.
    fn step(&mut self, chain: &Chain, by_edge: &[Vec<f64>], stage: u32) {
        let length = (0..stage).fold(FIRST_LENGTH, |length, _| length * SHORTER);
        for (remain, decay) in self.remain.iter_mut().zip(DECAY) {
            *remain *= decay;
        }
        let scale = self.remain.map(|remain| 1.0 - remain);
        for (node, (row, by_edge)) in self.edges.iter_mut().zip(by_edge).enumerate() {
            let probabilities = chain.row(node);
            let mean: f64 = by_edge.iter().zip(probabilities).map(|(d, p)| d * p).sum();
            for ((edge, derivative), probability) in row.iter_mut().zip(by_edge).zip(probabilities)
            {
                let slope = probability * (derivative - mean);
                let [value, first, second] = edge;
                *first += (1.0 - DECAY[0]) * (slope - *first);
                *second += (1.0 - DECAY[1]) * (slope * slope - *second);
                let size = (*second / scale[1]).sqrt() + 1e-12;
                *value += length * (*first / scale[0]) / size;
            }
        }
    }
}
