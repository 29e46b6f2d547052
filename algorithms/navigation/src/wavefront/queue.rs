//! A priority queue for waves.

/// Buckets of the ring.
const RING: usize = 128;
/// Buckets that one step of the wave spans.
const PER_STEP: f32 = 16.0;

/// Nodes by their time, the earliest first; of equal times, the lower node.
///
/// A ring of buckets, each as wide as a sixteenth of the time that a wave takes from one cell to
/// the next. A bucket holds few entries, among which the least is searched. The order is that of a
/// heap, at a fraction of its cost.
#[derive(Debug, Clone)]
pub struct Queue {
    /// Time and node of each entry in one number: floats ≥ 0 order like their bits.
    ring: Vec<Vec<u64>>,
    in_ring: usize,
    /// Number of the current bucket.
    current: usize,
    /// Entries beyond the ring, and the number of their earliest bucket.
    later: Vec<u64>,
    later_from: usize,
    per_second: f32,
}

impl Default for Queue {
    fn default() -> Self {
        Self {
            ring: vec![Vec::new(); RING],
            in_ring: 0,
            current: 0,
            later: Vec::new(),
            later_from: usize::MAX,
            per_second: 1.0,
        }
    }
}

impl Queue {
    /// Empties the queue for a wave that takes `step` seconds (> 0) from a cell to the next.
    pub(super) fn reset(&mut self, step: f32) {
        self.ring.iter_mut().for_each(Vec::clear);
        self.in_ring = 0;
        self.current = 0;
        self.later.clear();
        self.later_from = usize::MAX;
        self.per_second = PER_STEP / step;
    }

    /// Adds a node at a time (s), ≥ 0.
    pub(super) fn push(&mut self, time: f32, node: u32) {
        self.put(u64::from(time.to_bits()) << 32 | u64::from(node));
    }

    fn put(&mut self, entry: u64) {
        // A cast saturates: times beyond all buckets share the last.
        let bucket = (time_of(entry) * self.per_second) as usize;
        let bucket = bucket.max(self.current);
        if bucket - self.current < RING {
            self.ring[bucket % RING].push(entry);
            self.in_ring += 1;
        } else {
            self.later.push(entry);
            self.later_from = self.later_from.min(bucket);
        }
    }

    /// Removes the earliest entry.
    pub(super) fn pop(&mut self) -> Option<(f32, u32)> {
        loop {
            if self.in_ring == 0 {
                if self.later.is_empty() {
                    return None;
                }
                self.current = self.later_from;
            }
            if self.later_from <= self.current {
                self.later_from = usize::MAX;
                for entry in core::mem::take(&mut self.later) {
                    self.put(entry);
                }
            }
            let bucket = &mut self.ring[self.current % RING];
            if let Some(least) = (0..bucket.len()).min_by_key(|&i| bucket[i]) {
                let entry = bucket.swap_remove(least);
                self.in_ring -= 1;
                return Some((time_of(entry), entry as u32));
            }
            self.current += 1;
        }
    }
}

fn time_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

#[cfg(test)]
mod tests {
    use core::cmp::Reverse;
    use std::collections::BinaryHeap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Entries arrive as a wave adds them: a few at the start, then each within a few steps of
        /// the last removed one.
        #[test]
        fn entries_leave_in_the_order_of_a_heap(
            seeds in prop::collection::vec(0.0_f32..1e4, 1..20),
            steps in prop::collection::vec((0.0_f32..3.0, any::<u32>()), 0..300),
            far in prop::option::of(1e4_f32..1e30),
        ) {
            let mut queue = Queue::default();
            let mut heap = BinaryHeap::new();
            queue.reset(0.5);
            for (node, &time) in seeds.iter().chain(&far).enumerate() {
                queue.push(time, node as u32);
                heap.push(Reverse((time.to_bits(), node as u32)));
            }
            let mut steps = steps.into_iter();
            while let Some((time, node)) = queue.pop() {
                prop_assert_eq!(heap.pop(), Some(Reverse((time.to_bits(), node))));
                if let Some((ahead, node)) = steps.next() {
                    queue.push(time + ahead, node);
                    heap.push(Reverse(((time + ahead).to_bits(), node)));
                }
            }
            prop_assert!(heap.is_empty());
        }
    }
}
