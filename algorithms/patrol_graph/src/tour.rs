//! Closed walks through nodes of a graph: the travelling salesman by nearest neighbours and 2-opt.

use crate::graph::PatrolGraph;

/// Returns an order in which a robot visits these nodes and returns to the first one, by shortest paths. It begins
/// at the first node, continues with the nearest node that is left, and is then improved by exchanges of two legs (2-opt)
/// until none makes it shorter. Not always the shortest: with the triangle inequality the first step alone is within
/// (⌈log₂ n⌉ + 1) / 2 of it (Rosenkrantz, Stearns and Lewis, *An analysis of several heuristics for the traveling
/// salesman problem*, 1977).
pub fn tour(graph: &PatrolGraph, nodes: &[usize]) -> Vec<usize> {
    let Some((&first, rest)) = nodes.split_first() else {
        return Vec::new();
    };
    let (mut order, mut left, mut at) = (vec![first], rest.to_vec(), first);
    while !left.is_empty() {
        let mut nearest = (f64::INFINITY, 0);
        for (place, &node) in left.iter().enumerate() {
            let distance = graph.distance_m(at, node);
            if distance < nearest.0 {
                nearest = (distance, place);
            }
        }
        at = left.remove(nearest.1);
        order.push(at);
    }
    while shortened(graph, &mut order) {}
    order
}

/// Length of a closed walk through nodes, in this order, by shortest paths (m).
pub(crate) fn length_m(graph: &PatrolGraph, order: &[usize]) -> f64 {
    let next = order.iter().cycle().skip(1);
    let legs = order.iter().zip(next);
    legs.map(|(&from, &to)| graph.distance_m(from, to)).sum()
}

/// Reverses the first part whose reversal makes the walk shorter by more than rounding.
fn shortened(graph: &PatrolGraph, order: &mut [usize]) -> bool {
    let count = order.len();
    for first in 0..count.saturating_sub(1) {
        for last in first + 1..count {
            let (a, b) = (order[first], order[first + 1]);
            let (c, d) = (order[last], order[(last + 1) % count]);
            let present = graph.distance_m(a, b) + graph.distance_m(c, d);
            let other = graph.distance_m(a, c) + graph.distance_m(b, d);
            if other < present - 1e-9 {
                order[first + 1..=last].reverse();
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::GraphParams;
    use geometry::math::cos;

    #[test]
    fn a_tour_of_a_ring_goes_round_it() {
        let count = 12;
        let angle = |node: usize| node as f64 / count as f64 * core::f64::consts::TAU;
        let graph = PatrolGraph::new(&GraphParams {
            nodes: (0..count)
                .map(|node| [cos(angle(node)), cos(angle(node) - 1.5)])
                .collect(),
            edges: (0..count).map(|node| [node, (node + 1) % count]).collect(),
            lengths: vec![1.0; count],
        })
        .unwrap();
        // In another order than that of the ring.
        let nodes: Vec<usize> = (0..count).map(|place| place * 5 % count).collect();
        let order = tour(&graph, &nodes);
        assert_eq!(length_m(&graph, &order), 12.0);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..count).collect::<Vec<_>>());
        assert_eq!(tour(&graph, &[]), Vec::<usize>::new());
        assert_eq!(length_m(&graph, &tour(&graph, &[3])), 0.0);
    }
}
