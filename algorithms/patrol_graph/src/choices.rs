//! Choices of the next node, each a pure function.
//!
//! The formulas are those of the papers ([`Strategy`](crate::Strategy)) in the form of `patrolling_sim`, the program with which
//! their authors compare them, in seconds and metres instead of seconds and cells. Ties are drawn.

use geometry::math;
use rand::Rng;

use crate::graph::PatrolGraph;
use crate::params::{AssignmentParams, BayesParams};

/// Draws one of this many, at least 1, with equal probabilities.
fn draw(rng: &mut impl Rng, count: usize) -> usize {
    ((rng.next_u64() >> 32) as usize * count) >> 32
}

/// The node with the greatest value, of equal ones a drawn one; `None` without nodes.
fn greatest(rng: &mut impl Rng, nodes: impl Iterator<Item = (usize, f64)>) -> Option<usize> {
    let (mut best, mut value) = (Vec::new(), f64::NEG_INFINITY);
    for (node, worth) in nodes {
        if worth > value {
            (best, value) = (vec![node], worth);
        } else if worth == value {
            best.push(node);
        }
    }
    match best.len() {
        0 => None,
        1 => best.first().copied(),
        count => best.get(draw(rng, count)).copied(),
    }
}

/// A part of a whole from 0 to 1; 0 of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// Any neighbour of a node.
pub(crate) fn random(graph: &PatrolGraph, at: usize, rng: &mut impl Rng) -> Option<usize> {
    greatest(rng, graph.edges(at).iter().map(|edge| (edge.to, 0.0)))
}

/// Conscientious Reactive: the most idle neighbour.
pub(crate) fn conscientious(
    graph: &PatrolGraph,
    at: usize,
    idleness_s: &[f64],
    rng: &mut impl Rng,
) -> Option<usize> {
    let edges = graph.edges(at).iter();
    greatest(rng, edges.map(|edge| (edge.to, idleness_s[edge.to])))
}

/// Heuristic Conscientious Reactive: argmax over the neighbours of `(d_max − d) / d_max + I / I_max`.
pub(crate) fn heuristic(
    graph: &PatrolGraph,
    at: usize,
    idleness_s: &[f64],
    rng: &mut impl Rng,
) -> Option<usize> {
    let edges = graph.edges(at);
    let idlest = edges.iter().map(|e| idleness_s[e.to]).fold(0.0, f64::max);
    let longest = edges.iter().map(|e| e.length_m).fold(0.0, f64::max);
    let worth = |edge: &crate::Edge| {
        share(longest - edge.length_m, longest) + share(idleness_s[edge.to], idlest)
    };
    greatest(rng, edges.iter().map(|edge| (edge.to, worth(edge))))
}

/// Greedy Bayesian Strategy: argmax of G₁ exp(ln(1 / G₁) / G₂ · I / d), at most 1; with others' intentions (SEBS) times
/// 2^(R − c) / (2^R − 1), where c of the R robots head for the node.
pub(crate) fn bayesian(
    graph: &PatrolGraph,
    at: usize,
    idleness_s: &[f64],
    (intentions, robots): (&[usize], usize),
    params: &BayesParams,
    rng: &mut impl Rng,
) -> Option<usize> {
    let worth = |edge: &crate::Edge| {
        let gain = idleness_s[edge.to] / edge.length_m.max(params.edge_min);
        let exponent = -math::ln(params.g1) * (gain / params.g2).min(1.0);
        let moves = params.g1 * math::exp(exponent);
        match intentions.iter().filter(|&&node| node == edge.to).count() {
            0 => moves,
            // 2^(R − c) / (2^R − 1), without large powers.
            count => {
                let all = math::pow(2.0, -(robots as f64));
                moves * math::pow(2.0, -(count as f64)) / (1.0 - all)
            }
        }
    };
    let edges = graph.edges(at).iter();
    greatest(rng, edges.map(|edge| (edge.to, worth(edge))))
}

/// DTA-Greedy: argmax over all other nodes of `I − w_d · d − w_o ·` (distance from the first node). A node that others head for
/// counts as visited.
pub(crate) fn assignment(
    graph: &PatrolGraph,
    (at, origin): (usize, usize),
    idleness_s: &[f64],
    intentions: &[usize],
    params: &AssignmentParams,
    rng: &mut impl Rng,
) -> Option<usize> {
    let points = graph.points();
    let worth = |node: usize| {
        let idle = if intentions.contains(&node) {
            0.0
        } else {
            idleness_s[node]
        };
        let from_origin = (points[node] - points[origin]).norm();
        idle - params.distance_weight * graph.distance_m(at, node)
            - params.origin_weight * from_origin
    };
    let others = (0..graph.count()).filter(|&node| node != at);
    greatest(rng, others.map(|node| (node, worth(node))))
}

/// Heuristic Pathfinder Conscientious Cognitive: the node as [`heuristic`] chooses it, but among all, and the path to it with
/// the least sum of `(I_max − I) / I_max + (d − d_min) / (d_max − d_min)`; without the present node.
pub(crate) fn pathfinder(
    graph: &PatrolGraph,
    at: usize,
    idleness_s: &[f64],
    rng: &mut impl Rng,
) -> Vec<usize> {
    let idlest = idleness_s.iter().copied().fold(0.0, f64::max);
    let nodes = 0..graph.count();
    let far = nodes.clone().map(|node| graph.distance_m(at, node));
    let farthest = far.fold(0.0, f64::max);
    let worth = |node: usize| {
        share(farthest - graph.distance_m(at, node), farthest) + share(idleness_s[node], idlest)
    };
    let others = nodes.clone().filter(|&node| node != at);
    let Some(goal) = greatest(rng, others.map(|node| (node, worth(node)))) else {
        return Vec::new();
    };
    let lengths = || {
        nodes
            .clone()
            .flat_map(|node| graph.edges(node))
            .map(|edge| edge.length_m)
    };
    let shortest = lengths().fold(f64::INFINITY, f64::min);
    let longest = lengths().fold(0.0, f64::max);
    let cost = |edge: &crate::Edge| {
        share(idlest - idleness_s[edge.to], idlest)
            + share(edge.length_m - shortest, longest - shortest)
    };
    // Dijkstra.
    let mut costs = vec![f64::INFINITY; graph.count()];
    let mut before = vec![at; graph.count()];
    let mut open: Vec<usize> = nodes.collect();
    costs[at] = 0.0;
    while let Some(place) =
        (0..open.len()).min_by(|&a, &b| costs[open[a]].total_cmp(&costs[open[b]]))
    {
        let node = open.remove(place);
        for edge in graph.edges(node) {
            let through = costs[node] + cost(edge);
            if through < costs[edge.to] {
                costs[edge.to] = through;
                before[edge.to] = node;
            }
        }
    }
    let mut path = vec![goal];
    while let Some(&node) = path.last()
        && before[node] != at
        && path.len() < graph.count()
    {
        path.push(before[node]);
    }
    path.reverse();
    path
}
