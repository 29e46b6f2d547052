//! Division of a graph into connected parts of about equal length.

use crate::graph::PatrolGraph;

/// Returns this many parts of a graph, at most one per node: every node is in one of them, and each is connected.
///
/// They grow from nodes that are far from each other (the first is the farthest from node 0, each further one the
/// farthest from those before): the part with the least length takes the node that its shortest edge leads to. This stands
/// for the multilevel bisection of Portugal and Rocha, *MSP algorithm: multi-robot patrolling based on territory
/// allocation using balanced graph partitioning* (2010), with the same aim.
pub fn parts(graph: &PatrolGraph, count: usize) -> Vec<Vec<usize>> {
    let count = count.clamp(1, graph.count());
    let mut owner: Vec<Option<usize>> = vec![None; graph.count()];
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut sizes_m = vec![0.0; count];
    for part in 0..count {
        let from: Vec<usize> = if parts.is_empty() {
            vec![0]
        } else {
            parts.iter().map(|part| part[0]).collect()
        };
        let mut farthest = (-1.0, 0);
        for node in 0..graph.count() {
            let distances = from.iter().map(|&other| graph.distance_m(other, node));
            let distance = distances.fold(f64::INFINITY, f64::min);
            if distance > farthest.0 {
                farthest = (distance, node);
            }
        }
        owner[farthest.1] = Some(part);
        parts.push(vec![farthest.1]);
    }
    for _ in count..graph.count() {
        // Of the parts that can grow the one with the least length.
        let mut grown: Option<(f64, usize, usize, f64)> = None;
        for (part, nodes) in parts.iter().enumerate() {
            let edges = nodes.iter().flat_map(|&node| graph.edges(node));
            let free = edges.filter(|edge| owner[edge.to].is_none());
            let shortest = free.min_by(|a, b| a.length_m.total_cmp(&b.length_m));
            if let Some(edge) = shortest
                && grown.is_none_or(|(size, ..)| sizes_m[part] < size)
            {
                grown = Some((sizes_m[part], part, edge.to, edge.length_m));
            }
        }
        // A connected graph has such an edge while a node is left.
        if let Some((_, part, node, length_m)) = grown {
            owner[node] = Some(part);
            parts[part].push(node);
            sizes_m[part] += length_m;
        }
    }
    parts
}
