//! The medium in which a wave travels.

use nalgebra::Point2;
use planner_view::map::PlannerMap;

use super::bends::Bends;
use super::lattice::Lattice;

/// Steps along one axis: +x, +y, −x, −y.
const STEPS: [(i64, i64); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// The places that a wave passes: the nodes of a lattice, with four neighbours each, and the bends
/// of shortest paths, whose numbers follow those of the nodes.
#[derive(Debug, Clone)]
pub struct Medium {
    lattice: Lattice,
    /// Per node and step, the neighbour; where there is none, [`Medium::nowhere`].
    neighbours: Vec<[u32; 4]>,
    bends: Bends,
}

impl Medium {
    /// The medium on a lattice of this map. For `sight` (m) see [`SIGHT`](super::SIGHT).
    pub fn new(map: &PlannerMap, lattice: Lattice, sight: f64) -> Self {
        let bends = Bends::new(map, &lattice, sight);
        let nowhere = lattice.len() + bends.len();
        let neighbours = (0..lattice.len())
            .map(|node| {
                STEPS.map(|(dx, dy)| lattice.beside(node, dx, dy).unwrap_or(nowhere) as u32)
            })
            .collect();
        Self {
            lattice,
            neighbours,
            bends,
        }
    }

    /// The nodes.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Position of a node or bend (m).
    pub(crate) fn point(&self, place: usize) -> Option<Point2<f64>> {
        match place.checked_sub(self.lattice.len()) {
            None => self.lattice.point(place),
            Some(bend) => self.bends.points().get(bend).copied(),
        }
    }

    /// The neighbours of a node in the order of the steps +x, +y, −x, −y; [`Medium::nowhere`] where
    /// there is none.
    pub(super) fn neighbours(&self, node: usize) -> [u32; 4] {
        self.neighbours
            .get(node)
            .copied()
            .unwrap_or([self.nowhere() as u32; 4])
    }

    /// The bends of shortest paths.
    pub(super) fn bends(&self) -> &Bends {
        &self.bends
    }

    /// Number of nodes and bends.
    pub(crate) fn places(&self) -> usize {
        self.lattice.len() + self.bends.len()
    }

    /// A number beyond those of nodes and bends: a place that no wave reaches.
    pub(super) fn nowhere(&self) -> usize {
        self.lattice.len() + self.bends.len()
    }
}
