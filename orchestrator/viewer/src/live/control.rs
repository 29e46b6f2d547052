//! Control by the pages of a server: the pause, the single steps and the pace of the run or replay that it shows.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

/// Time without a page after which a paused run goes on.
const ALONE: Duration = Duration::from_secs(10);
/// Limits of a pace (simulated s per s).
const PACES: std::ops::RangeInclusive<f64> = 0.001..=1000.0;

/// Wish of the pages.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Wish {
    /// `true` if the world goes on by single steps only.
    #[serde(rename = "paused")]
    pub is_paused: bool,
    /// Single steps asked for so far.
    pub steps: u32,
    /// Pace (simulated s per s); infinite: as fast as possible.
    pub pace: f64,
}

/// Order of a page.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Order {
    /// Hold the world after the tick in progress.
    Pause,
    /// Go on by one tick, and hold the world there.
    Step,
    /// Go on.
    Go,
    /// Go on at this pace (simulated s per s), once the world is not held.
    Pace(f64),
}

/// Order that cannot be obeyed.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("pace is {0}: expected a factor from 0.001 to 1000")]
pub(super) struct PaceError(f64);

/// Control by the pages, which the run or the replay asks at its own pace.
#[derive(Debug)]
pub struct Control {
    held: Mutex<Held>,
    alone: Duration,
}

#[derive(Debug)]
struct Held {
    wish: Wish,
    /// Number of open pages.
    pages: usize,
    /// Time of the last order or leave of a page.
    since: Instant,
}

impl Control {
    /// Begins at this pace (simulated s per s); infinite: as fast as possible.
    pub(super) fn new(pace: f64) -> Self {
        Self::with_timeout(pace, ALONE)
    }

    fn with_timeout(pace: f64, alone: Duration) -> Self {
        let wish = Wish {
            is_paused: false,
            steps: 0,
            pace,
        };
        let held = Held {
            wish,
            pages: 0,
            since: Instant::now(),
        };
        Self {
            held: Mutex::new(held),
            alone,
        }
    }

    fn lock(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what pages have asked for. Without a page for ten seconds, a paused run goes on.
    pub fn wish(&self) -> Wish {
        let mut held = self.lock();
        if held.wish.is_paused && held.pages == 0 && held.since.elapsed() >= self.alone {
            held.wish.is_paused = false;
        }
        held.wish
    }

    /// Takes an order.
    ///
    /// # Errors
    /// [`PaceError`] for a pace out of range.
    pub(super) fn obey(&self, order: Order) -> Result<Wish, PaceError> {
        let mut held = self.lock();
        match order {
            Order::Pause => held.wish.is_paused = true,
            Order::Go => held.wish.is_paused = false,
            Order::Step => {
                held.wish.is_paused = true;
                held.wish.steps += 1;
            }
            Order::Pace(pace) if PACES.contains(&pace) => held.wish.pace = pace,
            Order::Pace(pace) => return Err(PaceError(pace)),
        }
        held.since = Instant::now();
        Ok(held.wish)
    }

    /// Counts an open page, until the value is dropped.
    pub(super) fn enter(&self) -> impl Drop {
        self.lock().pages += 1;
        OpenPage(self)
    }
}

struct OpenPage<'a>(&'a Control);

impl Drop for OpenPage<'_> {
    fn drop(&mut self) {
        let mut held = self.0.lock();
        held.pages = held.pages.saturating_sub(1);
        held.since = Instant::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_hold_the_world_and_let_it_go() {
        let control = Control::new(1.0);
        let obey = |text: &str| control.obey(serde_json::from_str(text).unwrap());
        let wish = |is_paused, steps, pace| Wish {
            is_paused,
            steps,
            pace,
        };
        assert_eq!(obey("\"pause\""), Ok(wish(true, 0, 1.0)));
        assert_eq!(obey("\"step\""), Ok(wish(true, 1, 1.0)));
        assert_eq!(obey("{\"pace\":4}"), Ok(wish(true, 1, 4.0)));
        assert_eq!(obey("\"go\""), Ok(wish(false, 1, 4.0)));
        for pace in [0.0, -1.0, 1e4, f64::NAN] {
            let error = control.obey(Order::Pace(pace)).unwrap_err().to_string();
            assert!(error.contains("expected a factor from 0.001"), "{error}");
        }
        assert_eq!(control.wish(), wish(false, 1, 4.0));
        for text in ["\"stop\"", "{}", "{\"pace\":\"fast\"}", ""] {
            assert!(serde_json::from_str::<Order>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_paused_run_goes_on_once_all_pages_have_left() {
        let control = Control::with_timeout(1.0, Duration::ZERO);
        let page = control.enter();
        control.obey(Order::Pause).unwrap();
        assert!(control.wish().is_paused, "a page is open");
        drop(page);
        assert!(!control.wish().is_paused);
        let patient = Control::new(1.0);
        patient.obey(Order::Pause).unwrap();
        assert!(patient.wish().is_paused, "a page may come back");
    }
}
