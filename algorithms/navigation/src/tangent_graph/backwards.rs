//! Costs from every departure to a goal, by a search against the direction of travel.

use super::graph::{Graph, NONE};
use super::heap::Heap;

/// Costs (m) from every vertex to a goal that some vertices (`seeds`) reach at known costs.
pub fn backwards(
    graph: &Graph,
    seeds: impl Iterator<Item = (u32, f64)>,
    costs: &mut Vec<f64>,
    heap: &mut Heap,
) {
    costs.clear();
    costs.resize(graph.vertices.len(), f64::INFINITY);
    heap.clear();
    for (vertex, cost) in seeds {
        if vertex != NONE && cost < costs[vertex as usize] {
            costs[vertex as usize] = cost;
            heap.push(cost, vertex);
        }
    }
    while let Some((cost, vertex)) = heap.pop() {
        if cost > costs[vertex as usize] {
            continue;
        }
        for (before, step) in graph.before(vertex) {
            let through = cost + step;
            if through < costs[before as usize] {
                costs[before as usize] = through;
                heap.push(through, before);
            }
        }
    }
}
