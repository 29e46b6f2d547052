//! Streams of a run, thinned out during reading.

use std::collections::BTreeMap;

/// Timed items by key (for example, a robot) in bounded memory: per key, one item per interval and
/// the last one. The interval grows when the items exceed the maximum weight.
#[derive(Debug, Clone)]
pub struct ThinnedSeries<T> {
    interval_ns: u64,
    /// Maximum sum of the weights of the items.
    most: usize,
    weigh: fn(&T) -> usize,
    weight: usize,
    items: Vec<Sample<T>>,
    last_kept: BTreeMap<u32, u64>,
    /// The last item of every key, if it was not stored.
    waiting: BTreeMap<u32, Sample<T>>,
}

/// One item.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sample<T> {
    pub(super) time_ns: u64,
    pub(super) key: u32,
    pub(super) item: T,
}

impl<T> ThinnedSeries<T> {
    /// Returns an empty series. Items of a key are at least `interval_ns` apart.
    pub(super) fn new(interval_ns: u64, most: usize, weigh: fn(&T) -> usize) -> Self {
        Self {
            interval_ns,
            most,
            weigh,
            weight: 0,
            items: Vec::new(),
            last_kept: BTreeMap::new(),
            waiting: BTreeMap::new(),
        }
    }

    /// Returns `true` if an item of this key and time would be stored permanently. Other items are
    /// needed only if they are the last of their key.
    pub(super) fn is_due(&self, time_ns: u64, key: u32) -> bool {
        self.last_kept
            .get(&key)
            .is_none_or(|last| time_ns >= last.saturating_add(self.interval_ns))
    }

    /// Adds an item. Items of a key whose time goes back are dropped.
    pub(super) fn push(&mut self, time_ns: u64, key: u32, item: T) {
        if self.last_kept.get(&key).is_some_and(|&last| time_ns < last) {
            return;
        }
        let sample = Sample { time_ns, key, item };
        if !self.is_due(time_ns, key) {
            self.waiting.insert(key, sample);
            return;
        }
        self.waiting.remove(&key);
        self.last_kept.insert(key, time_ns);
        self.weight += (self.weigh)(&sample.item);
        self.items.push(sample);
        while self.weight > self.most && self.items.len() > 2 * self.last_kept.len() {
            self.thin_out();
        }
    }

    /// Drops about every second item.
    fn thin_out(&mut self) {
        let first = self.items.iter().map(|s| s.time_ns).min().unwrap_or(0);
        let last = self.items.iter().map(|s| s.time_ns).max().unwrap_or(0);
        let of_a_key = (self.items.len() / self.last_kept.len().max(1)).max(2) as u64;
        let between = (last - first) / (of_a_key - 1);
        self.interval_ns = self.interval_ns.max(between).max(1).saturating_mul(2);
        self.last_kept.clear();
        self.weight = 0;
        let (interval, weigh) = (self.interval_ns, self.weigh);
        let (last_kept, weight) = (&mut self.last_kept, &mut self.weight);
        let waiting = &mut self.waiting;
        let items = core::mem::take(&mut self.items);
        for sample in items {
            let due = last_kept
                .get(&sample.key)
                .is_none_or(|last| sample.time_ns >= last.saturating_add(interval));
            if due {
                last_kept.insert(sample.key, sample.time_ns);
                *weight += weigh(&sample.item);
                self.items.push(sample);
            } else if waiting
                .get(&sample.key)
                .is_none_or(|w| w.time_ns < sample.time_ns)
            {
                waiting.insert(sample.key, sample);
            }
        }
        waiting.retain(|key, sample| last_kept.get(key).is_none_or(|last| sample.time_ns > *last));
    }

    /// Returns the items by time, including the last of every key.
    pub(super) fn finish(mut self) -> Vec<Sample<T>> {
        self.items.extend(self.waiting.into_values());
        self.items.sort_by_key(|s| (s.time_ns, s.key));
        self.items
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn items_are_an_interval_apart_and_the_last_is_there() {
        let mut sampled = ThinnedSeries::new(10, 1000, |_| 1);
        for time in 0..=27 {
            sampled.push(time, 0, time);
            sampled.push(time, 1, time);
        }
        let times: Vec<u64> = sampled
            .finish()
            .iter()
            .filter(|s| s.key == 1)
            .map(|s| s.time_ns)
            .collect();
        assert_eq!(times, [0, 10, 20, 27]);
    }

    #[test]
    fn a_time_that_goes_back_is_left_out() {
        let mut sampled = ThinnedSeries::new(0, 1000, |()| 1);
        for time in [5, 6, 3, 7] {
            sampled.push(time, 0, ());
        }
        let times: Vec<u64> = sampled.finish().iter().map(|s| s.time_ns).collect();
        assert_eq!(times, [5, 6, 7]);
    }

    proptest! {
        #[test]
        fn long_streams_are_thinned_evenly_and_keep_both_ends(
            count in 1_u64..3000,
            most in 8_usize..200,
        ) {
            let mut sampled = ThinnedSeries::new(0, most, |_| 1);
            for i in 0..count {
                sampled.push(i * 50, 0, i);
            }
            let kept = sampled.finish();
            prop_assert!(kept.len() <= most + 1);
            prop_assert_eq!(kept.first().unwrap().item, 0);
            prop_assert_eq!(kept.last().unwrap().item, count - 1);
            let gaps: Vec<u64> = kept.windows(2).map(|w| w[1].item - w[0].item).collect();
            if let Some((_, inner)) = gaps.split_last() {
                prop_assert!(inner.iter().all(|g| Some(g) == inner.first()), "{gaps:?}");
            }
            prop_assert!(kept.len() * 5 >= most.min(count as usize));
        }
    }
}
