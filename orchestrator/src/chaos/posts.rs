//! When the world came how far: what a log owes.

use ipc_types::clock::monotonic_ns;
use kit::lockstep::TurnPage;

use super::mission::Mission;
use crate::census;

/// Looks at the turn page of a mission now and then.
#[derive(Debug, Default)]
pub(super) struct Posts {
    page: Option<TurnPage>,
    /// Ticks posted, and when that was seen [ns], as often as it had changed.
    seen: Vec<(u64, u64)>,
}

impl Posts {
    /// Looks how far the world is.
    pub(super) fn look(&mut self, mission: &Mission) {
        if self.page.is_none() {
            let mut prefixes = mission.roots().into_iter().map(|r| census::prefix_of(&r));
            self.page = prefixes.find_map(|prefix| TurnPage::open(&prefix).ok());
        }
        if let Some(page) = &self.page {
            self.note(page.ticks_posted(), monotonic_ns());
        }
    }

    fn note(&mut self, ticks: u64, at_ns: u64) {
        let known = self.seen.last().map_or(0, |&(ticks, _)| ticks);
        if ticks > known {
            self.seen.push((ticks, at_ns));
        }
    }

    /// Time from the first tick beyond so many until then [s]; 0 if there was none.
    pub(super) fn age_beyond(&self, ticks: u64, at_ns: u64) -> f64 {
        let beyond = self.seen.iter().find(|&&(seen, _)| seen > ticks);
        beyond.map_or(0.0, |&(_, seen_ns)| {
            at_ns.saturating_sub(seen_ns) as f64 * 1e-9
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_tick_that_is_missing_counts() {
        let mut posts = Posts::default();
        assert_eq!(posts.age_beyond(0, 5_000_000_000), 0.0);
        for (ticks, at_s) in [(0, 1), (3, 2), (3, 3), (5, 4), (9, 8)] {
            posts.note(ticks, at_s * 1_000_000_000);
        }
        for (kept, age_s) in [(0, 8.0), (2, 8.0), (3, 6.0), (4, 6.0), (8, 2.0), (9, 0.0)] {
            assert_eq!(posts.age_beyond(kept, 10_000_000_000), age_s, "{kept}");
        }
    }
}
