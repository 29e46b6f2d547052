//! The rim of a growing tree of shortest ways.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

/// Costs [mm] that the ring covers, a power of two: nothing but an edge past a threat is longer.
const RING: u32 = 1024;

/// Stands for "none".
const NONE: u32 = u32::MAX;

/// Nodes with what the ways to them cost, taken in the order of cost and, where that is the same,
/// of the node.
///
/// Costs are whole millimetres and an edge is short, so that most entries lie within a ring of lists,
/// one per millimetre; the rest are in a heap. Nothing may be put in that costs less than what was
/// taken last.
#[derive(Debug, Clone)]
pub(super) struct Frontier {
    /// Per cost modulo [`RING`], the entry that came last, or [`NONE`].
    heads: Vec<u32>,
    /// A bit per list that is not empty.
    filled: [u64; RING as usize / 64],
    entries: Vec<Entry>,
    /// The first of the entries that are free, or [`NONE`].
    free: u32,
    /// Entries in the ring.
    count: u32,
    /// Cost of what was taken last [mm]: the ring holds this and up to `RING` − 1 more.
    base: u32,
    /// Cost in the upper half, node in the lower.
    far: BinaryHeap<Reverse<u64>>,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    /// The next of the same cost, or of those that are free.
    next: u32,
}

impl Default for Frontier {
    fn default() -> Self {
        Self {
            heads: Vec::new(),
            filled: [0; RING as usize / 64],
            entries: Vec::new(),
            free: NONE,
            count: 0,
            base: 0,
            far: BinaryHeap::new(),
        }
    }
}

impl Frontier {
    /// Takes everything out, to begin at a cost of 0.
    pub(super) fn clear(&mut self) {
        self.heads.clear();
        self.heads.resize(RING as usize, NONE);
        self.filled = [0; RING as usize / 64];
        self.entries.clear();
        self.free = NONE;
        self.count = 0;
        self.base = 0;
        self.far.clear();
    }

    /// Whether nothing is in it.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0 && self.far.is_empty()
    }

    /// Puts a node in.
    pub(super) fn push(&mut self, cost: u32, node: u32) {
        let list = (cost % RING) as usize;
        let near = cost.wrapping_sub(self.base) < RING;
        let Some(head) = self.heads.get_mut(list).filter(|_| near) else {
            let key = u64::from(cost) << 32 | u64::from(node);
            self.far.push(Reverse(key));
            return;
        };
        let entry = Entry { node, next: *head };
        if let Some(free) = self.entries.get_mut(self.free as usize) {
            *head = self.free;
            self.free = free.next;
            *free = entry;
        } else {
            *head = self.entries.len() as u32;
            self.entries.push(entry);
        }
        self.filled[list / 64] |= 1 << (list % 64);
        self.count += 1;
    }

    /// Takes the cheapest node out, the lowest of several; its cost [mm] comes with it.
    pub(super) fn pop(&mut self) -> Option<(u32, u32)> {
        let near = self.nearest();
        let far = self.far.peek().map(|Reverse(key)| *key);
        let taken = match (near, far) {
            (Some((cost, node)), far)
                if far.is_none_or(|far| (u64::from(cost) << 32 | u64::from(node)) <= far) =>
            {
                self.take(cost, node);
                (cost, node)
            }
            (_, Some(far)) => {
                self.far.pop();
                ((far >> 32) as u32, far as u32)
            }
            (_, None) => return None,
        };
        self.base = taken.0;
        Some(taken)
    }

    /// Cost and node of the cheapest entry of the ring.
    fn nearest(&self) -> Option<(u32, u32)> {
        if self.count == 0 {
            return None;
        }
        let begin = self.base % RING;
        let words = self.filled.len() as u32;
        // Around the ring, and once more through the lists below the first in its word.
        for step in 0..=words {
            let word = (begin / 64 + step) % words;
            let mut bits = self.filled[word as usize];
            if step == 0 {
                bits &= u64::MAX << (begin % 64);
            }
            if bits != 0 {
                let list = word * 64 + bits.trailing_zeros();
                let cost = self.base + (list.wrapping_sub(begin) % RING);
                let mut lowest = NONE;
                let mut at = self.heads[list as usize];
                while let Some(entry) = self.entries.get(at as usize) {
                    lowest = lowest.min(entry.node);
                    at = entry.next;
                }
                return Some((cost, lowest));
            }
        }
        None
    }

    /// Takes one entry of this node out of the list of this cost, which holds it.
    fn take(&mut self, cost: u32, node: u32) {
        let list = (cost % RING) as usize;
        let (mut before, mut at) = (NONE, self.heads[list]);
        while let Some(&entry) = self.entries.get(at as usize) {
            if entry.node == node {
                if let Some(before) = self.entries.get_mut(before as usize) {
                    before.next = entry.next;
                } else {
                    self.heads[list] = entry.next;
                }
                self.entries[at as usize].next = self.free;
                self.free = at;
                break;
            }
            (before, at) = (at, entry.next);
        }
        if self.heads[list] == NONE {
            self.filled[list / 64] &= !(1 << (list % 64));
        }
        self.count -= 1;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn nodes_come_in_the_order_of_a_heap(
            steps in proptest::collection::vec(
                (0_u32..4, proptest::collection::vec((prop_oneof![1_u32..5, 1_u32..3000, Just(900_000)], 0_u32..50), 0..6)),
                1..200,
            ),
        ) {
            let mut frontier = Frontier::default();
            frontier.clear();
            let mut heap = BinaryHeap::new();
            let mut base = 0;
            for (pops, pushes) in steps {
                for (more, node) in pushes {
                    frontier.push(base + more, node);
                    heap.push(Reverse((base + more, node)));
                }
                for _ in 0..pops {
                    let expected = heap.pop().map(|Reverse(entry)| entry);
                    prop_assert_eq!(frontier.pop(), expected);
                    base = expected.map_or(base, |(cost, _)| cost);
                }
                prop_assert_eq!(frontier.is_empty(), heap.is_empty());
            }
        }
    }
}
