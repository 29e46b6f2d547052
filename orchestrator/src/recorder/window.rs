//! Which ticks are complete when nobody waits for anybody.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Ticks that the log stays behind however long they take: what is said of a tick may come until
/// the next but one.
const LEAST: u64 = 2;

/// Lets a tick count as complete a while after it was the newest. Told in time and not in ticks: of
/// a world that cannot keep its pace the ticks get long, and a log that waits for a number of them
/// would lag by as much.
#[derive(Debug)]
pub(super) struct Window {
    wait: Duration,
    /// Ticks that became the newest, and when that was seen; in order.
    seen: VecDeque<(Instant, u64)>,
    /// The last that has been so for long enough.
    aged: Option<u64>,
}

impl Window {
    pub(super) fn new(wait: Duration) -> Self {
        Self {
            wait,
            seen: VecDeque::new(),
            aged: None,
        }
    }

    /// The last complete tick, if the newest one now is `newest`; `None` before the first. Never
    /// goes back as long as neither of its arguments does.
    pub(super) fn complete(&mut self, newest: u64, now: Instant) -> Option<u64> {
        if self.seen.back().is_none_or(|&(_, tick)| tick < newest) {
            self.seen.push_back((now, newest));
        }
        while let Some(&(at, tick)) = self.seen.front()
            && now.saturating_duration_since(at) >= self.wait
        {
            self.aged = Some(tick);
            // The newest stays, so that it is not taken for a new one.
            if self.seen.len() == 1 {
                break;
            }
            self.seen.pop_front();
        }
        Some(self.aged?.min(newest.checked_sub(LEAST)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAIT: Duration = Duration::from_millis(250);

    #[test]
    fn a_tick_is_complete_a_while_after_it_came_however_many_follow() {
        for period_ms in [1_u64, 2, 50, 100] {
            let (mut window, start) = (Window::new(WAIT), Instant::now());
            for tick in 0..1000 {
                let now = start + Duration::from_millis(tick * period_ms);
                let complete = window.complete(tick, now);
                let wanted = tick.checked_sub(LEAST.max(250_u64.div_ceil(period_ms)));
                assert_eq!(complete, wanted, "tick {tick} of {period_ms} ms");
            }
        }
    }

    #[test]
    fn a_world_that_stands_still_is_written_up_to_its_last_ticks_but_one() {
        let (mut window, start) = (Window::new(WAIT), Instant::now());
        assert_eq!(window.complete(7, start), None);
        let later = start + WAIT;
        assert_eq!(window.complete(7, later), Some(5));
        assert_eq!(window.complete(7, later + WAIT), Some(5));
        assert_eq!(window.complete(8, later + WAIT), Some(6));
        let mut early = Window::new(Duration::ZERO);
        assert_eq!(
            early.complete(1, start),
            None,
            "nothing is complete before tick 2"
        );
        assert_eq!(early.complete(2, start), Some(0));
    }
}
