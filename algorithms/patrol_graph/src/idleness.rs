//! Idleness of the nodes of a graph, as robots share it.

use nalgebra::Point2;

use crate::graph::PatrolGraph;

/// Times of the last visits of nodes. All count as visited at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct LastVisits(Vec<f64>);

impl LastVisits {
    /// Nodes of a graph at the start of a patrol (s).
    pub fn new(graph: &PatrolGraph, start_s: f64) -> Self {
        Self(vec![start_s; graph.count()])
    }

    /// A robot is at a point (m) at a time (s): it visits the nodes within a distance of it (m).
    pub fn robot_at(&mut self, graph: &PatrolGraph, at: Point2<f64>, within_m: f64, time_s: f64) {
        for (last_s, node) in self.0.iter_mut().zip(graph.points()) {
            if (node - at).norm() <= within_m {
                *last_s = time_s;
            }
        }
    }

    /// Idleness of the nodes at a time (s).
    pub fn idleness_s(&self, time_s: f64) -> Vec<f64> {
        self.0.iter().map(|last_s| time_s - last_s).collect()
    }
}
