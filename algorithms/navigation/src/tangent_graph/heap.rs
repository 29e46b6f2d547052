//! A priority queue of costs.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

/// The smallest cost first; of equal costs, the smaller number.
#[derive(Debug, Default)]
pub struct Heap {
    entries: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Heap {
    /// Adds a number at a cost, which is not negative.
    #[inline]
    pub fn push(&mut self, cost: f64, number: u32) {
        // Floats that are not negative are ordered as their bits; −0 would not be.
        self.entries.push(Reverse(((cost + 0.0).to_bits(), number)));
    }

    /// The number with the smallest cost.
    #[inline]
    pub fn pop(&mut self) -> Option<(f64, u32)> {
        let Reverse((bits, number)) = self.entries.pop()?;
        Some((f64::from_bits(bits), number))
    }

    /// Removes all entries.
    pub fn clear(&mut self) {
        self.entries.clear();
    }
}
