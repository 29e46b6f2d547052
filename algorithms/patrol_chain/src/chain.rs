//! Markov chains on a graph, and walks along them.

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

    /// The node after `node` by a number in [0, 1).
    fn next(&self, node: usize, mut unit: f64) -> usize {
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

    /// The walk of a robot with this key from a node. An ally with the key makes the same walk and knows every node of it
    /// beforehand; an observer without it knows the probabilities only.
    pub fn walk(&self, start: usize, key: [u8; 32]) -> Walk<'_> {
        Walk {
            chain: self,
            node: start,
            stream: KeyedStream::new(key),
        }
    }
}

/// The nodes after the start of a walk, without end: [`Chain::walk`].
#[derive(Debug, Clone)]
pub struct Walk<'a> {
    chain: &'a Chain,
    node: usize,
    stream: KeyedStream,
}

impl Iterator for Walk<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        self.node = self.chain.next(self.node, self.stream.next_unit()[0]);
        Some(self.node)
    }
}
