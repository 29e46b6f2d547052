//! Transition rectangles.

use std::collections::BTreeSet;

use sim_backend::shape::Aabb;

use super::cells::{Block, Cells};
use super::merge::NOBODY;

/// A rectangle of free space across the border that two rectangles share (the paper's transition
/// rectangle): as wide as the shared part of the border, as long as both rectangles together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// The rectangles that it joins, the lower number first.
    pub between: [usize; 2],
    /// The bridge itself [m].
    pub rectangle: Aabb,
}

/// The bridges between blocks that share a border, by their numbers.
pub(super) fn between(cells: &Cells, blocks: &[Block], owners: &[u32]) -> Vec<Bridge> {
    let width = cells.columns();
    let mut pairs = BTreeSet::new();
    for (cell, &owner) in owners.iter().enumerate() {
        let right = (cell % width + 1 < width).then_some(cell + 1);
        for next in right.into_iter().chain([cell + width]) {
            let other = owners.get(next).copied().unwrap_or(NOBODY);
            if owner != other && owner != NOBODY && other != NOBODY {
                pairs.insert([owner.min(other) as usize, owner.max(other) as usize]);
            }
        }
    }
    let bridge = |between: [usize; 2]| {
        let (a, b) = (blocks.get(between[0])?, blocks.get(between[1])?);
        let rectangle = cells.aabb(&across(a, b));
        Some(Bridge { between, rectangle })
    };
    pairs.into_iter().filter_map(bridge).collect()
}

/// The block over the rows (or columns) that two neighbours share, as long as both together.
fn across(a: &Block, b: &Block) -> Block {
    let beside = a.x1 < b.x0 || b.x1 < a.x0;
    if beside {
        Block {
            x0: a.x0.min(b.x0),
            x1: a.x1.max(b.x1),
            y0: a.y0.max(b.y0),
            y1: a.y1.min(b.y1),
        }
    } else {
        Block {
            x0: a.x0.max(b.x0),
            x1: a.x1.min(b.x1),
            y0: a.y0.min(b.y0),
            y1: a.y1.max(b.y1),
        }
    }
}
