//! Markov chains on a graph.

use chaotic_maps::{KeyedStream, Source as _};

use crate::times::TravelTimes;

/// Probabilities of the next node, for each node.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    times: TravelTimes,
    /// For each node the probabilities of its edges, each row with sum 1.
    rows: Vec<Vec<f64>>,
}

impl Chain {
    /// The chain that takes each edge of a node with the same probability: a random walk.
    pub fn uniform(times: TravelTimes) -> Self {
        let weights: Vec<Vec<f64>> = (0..times.nodes())
            .map(|node| vec![1.0; times.from(node).len()])
            .collect();
        Self::from_weights(times, &weights)
    }

    /// The chain of positive weights of the edges: each row is divided by its sum.
    pub(crate) fn from_weights(times: TravelTimes, weights: &[Vec<f64>]) -> Self {
        let rows = weights.iter().map(|row| {
            let sum: f64 = row.iter().sum();
            row.iter().map(|weight| weight / sum).collect()
        });
        Self {
            rows: rows.collect(),
            times,
        }
    }

    /// The graph.
    pub fn times(&self) -> &TravelTimes {
        &self.times
    }

    /// Probabilities of the edges from a node, in the order of [`TravelTimes::from`].
    pub fn row(&self, node: usize) -> &[f64] {
        &self.rows[node]
    }

    /// The node after a node, drawn from a key stream. An ally with the key draws the same nodes and knows every one of
    /// them beforehand; an observer without it knows the probabilities only.
    pub fn draw(&self, node: usize, stream: &mut KeyedStream) -> usize {
        let mut unit = stream.next_unit()[0];
        let edges = self.times.from(node);
        let mut last = edges[0].to;
        for (edge, probability) in edges.iter().zip(self.row(node)) {
            if *probability > 0.0 {
                last = edge.to;
                unit -= probability;
                if unit < 0.0 {
                    break;
                }
            }
        }
        last
    }
}
