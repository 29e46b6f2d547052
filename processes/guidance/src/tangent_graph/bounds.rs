//! How far it is at least from every departure to every track, for the search to go straight to
//! its goal.

use super::graph::{Graph, NONE};
use super::heap::Heap;

/// Most numbers of the table; a graph with more is searched by straight-line distances.
const MAX_NUMBERS: usize = 1 << 23;

/// Lower bounds on the cost [m] from a vertex to landing anywhere on a track.
#[derive(Debug)]
pub(super) struct Bounds {
    tracks: usize,
    table: Vec<f32>,
}

impl Bounds {
    /// By one search per track against the direction of travel; `None` for a graph that is too
    /// large.
    pub fn new(graph: &Graph) -> Option<Self> {
        let (vertices, tracks) = (graph.vertices.len(), graph.tracks());
        if vertices.saturating_mul(tracks) > MAX_NUMBERS {
            return None;
        }
        let mut landing = vec![Vec::new(); tracks];
        for (i, vertex) in graph.vertices.iter().enumerate() {
            landing[vertex.to_track as usize].push((i as u32, vertex.length));
        }
        let mut table = vec![f32::INFINITY; vertices * tracks];
        let mut costs = Vec::new();
        let mut heap = Heap::default();
        for (track, seeds) in landing.iter().enumerate() {
            backwards(graph, seeds.iter().copied(), &mut costs, &mut heap);
            for (row, &cost) in table.chunks_exact_mut(tracks).zip(&costs) {
                // Rounded down, so that it stays a bound.
                if cost.is_finite() {
                    row[track] = (cost as f32).next_down();
                }
            }
        }
        Some(Self { tracks, table })
    }

    /// The bounds from a vertex to every track.
    #[inline]
    pub fn of(&self, vertex: u32) -> &[f32] {
        let begin = vertex as usize * self.tracks;
        &self.table[begin..begin + self.tracks]
    }
}

/// Costs [m] from every vertex to a goal that some vertices (`seeds`) reach at known costs.
pub(super) fn backwards(
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
