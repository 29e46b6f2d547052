//! Transition rectangles.

use std::collections::BTreeSet;

use geometry::shape::Aabb;
use thiserror::Error;

use super::SAME;
use super::cells::{Block, Cells};
use super::merge::UNOWNED;
use crate::workplace::Workplace;

/// Reason why a bridge cannot be added.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BridgeError {
    /// An unknown rectangle.
    #[error(
        "bridge to rectangle {rectangle}: the workplace is divided into rectangles 0 to {last}: name \
         two of those"
    )]
    NoSuchRectangle {
        /// Actual index.
        rectangle: usize,
        /// The largest index.
        last: usize,
    },
    /// The rectangles are already joined.
    #[error(
        "bridge between rectangles {} and {}: they are the same or share a border, which has a bridge \
         already; leave this one out", .between[0], .between[1]
    )]
    Joined {
        /// The rectangles.
        between: [usize; 2],
    },
    /// The bridge crosses an obstacle, leaves the workplace, or has no inside.
    #[error(
        "bridge from ({}, {}) to ({}, {}): not all of it is free for the robot's centre; keep it \
         inside the workplace and out of the obstacles grown by the robot's radius",
        .rectangle.min.x, .rectangle.min.y, .rectangle.max.x, .rectangle.max.y
    )]
    NotFree {
        /// The bridge (m).
        rectangle: Aabb,
    },
    /// The bridge does not reach a rectangle.
    #[error(
        "bridge from ({}, {}) to ({}, {}): it does not overlap rectangle {other}; make it longer",
        .rectangle.min.x, .rectangle.min.y, .rectangle.max.x, .rectangle.max.y
    )]
    Apart {
        /// The bridge (m).
        rectangle: Aabb,
        /// The rectangle that it does not reach.
        other: usize,
    },
}

/// Returns `true` if a rectangle (m) has an inside, lies in the workplace and meets no grown obstacle.
pub fn is_free(rectangle: &Aabb, workplace: &Workplace) -> bool {
    let inner = workplace.inner();
    let (low, high) = (rectangle.min - inner.min, inner.max - rectangle.max);
    // All comparisons are false for NaN.
    depth(rectangle, rectangle) > SAME
        && low.x.min(low.y).min(high.x).min(high.y) >= -SAME
        && workplace
            .inflated()
            .iter()
            .all(|o| depth(rectangle, o) <= SAME)
}

/// Overlap of two rectangles (m), along the axis with the smaller one; negative if they are apart.
pub fn depth(a: &Aabb, b: &Aabb) -> f64 {
    let overlap = a.max.inf(&b.max) - a.min.sup(&b.min);
    overlap.x.min(overlap.y)
}

/// A rectangle of free space across the border that two rectangles share (the paper's transition
/// rectangle): as wide as the shared part of the border, as long as both rectangles together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// The rectangles that it joins, the lower number first.
    pub between: [usize; 2],
    /// The bridge itself (m).
    pub rectangle: Aabb,
}

/// The bridges between blocks that share a border, by their numbers.
pub fn between(cells: &Cells, blocks: &[Block], owners: &[u32]) -> Vec<Bridge> {
    let width = cells.columns();
    let mut pairs = BTreeSet::new();
    for (cell, &owner) in owners.iter().enumerate() {
        let right = (cell % width + 1 < width).then_some(cell + 1);
        for next in right.into_iter().chain([cell + width]) {
            let other = owners.get(next).copied().unwrap_or(UNOWNED);
            if owner != other && owner != UNOWNED && other != UNOWNED {
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
