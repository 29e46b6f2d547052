//! The missions of an experiment: every cell with every seed.

use super::seeds::Seeds;

/// One mission of an experiment. Missions are ordered as the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MissionId {
    /// Index of its cell.
    pub cell: usize,
    /// Its seed.
    pub seed: u64,
}

/// Returns all missions, in the order of the results.
pub fn missions(cells: usize, seeds: &Seeds) -> impl Iterator<Item = MissionId> {
    (0..cells).flat_map(|cell| seeds.iter().map(move |seed| MissionId { cell, seed }))
}
