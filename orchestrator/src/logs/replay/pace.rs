//! When a message is due, and how well that was kept.

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::statistics::Distribution;

/// Percentiles of a time [µs].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Median.
    pub p50: f64,
    /// Of a hundred, one is longer.
    pub p99: f64,
    /// Longest.
    pub max: f64,
}

/// The schedule of a replay.
pub(super) struct Pace {
    /// Times as fast as recorded; infinite: as fast as possible.
    pub(super) rate: f64,
    /// A log time, and when it is or was due.
    anchor: (u64, Instant),
    /// When the last message went out, and its log time.
    last: Option<(u64, Instant)>,
    jitter: Option<Distribution>,
    lateness: Option<Distribution>,
}

impl Pace {
    pub(super) fn new(rate: f64, time: u64) -> Self {
        Self {
            rate,
            anchor: (time, Instant::now()),
            last: None,
            jitter: Distribution::new(),
            lateness: Distribution::new(),
        }
    }

    /// From now on, beginning with this log time: after a pause, a jump or a change of the rate.
    pub(super) fn restart(&mut self, time: u64) {
        self.anchor = (time, Instant::now());
        self.last = None;
    }

    /// When a message is due.
    pub(super) fn due(&self, time: u64) -> Instant {
        let after = time.saturating_sub(self.anchor.0) as f64 * 1e-9 / self.rate;
        // A log may claim to last longer than clocks go.
        let after = Duration::try_from_secs_f64(after.min(1e9)).unwrap_or_default();
        self.anchor.1 + after
    }

    /// The log time of now.
    pub(super) fn time(&self) -> u64 {
        let passed = self.anchor.1.elapsed().as_secs_f64() * self.rate * 1e9;
        self.anchor.0.saturating_add(passed as u64)
    }

    /// A message went out.
    pub(super) fn sent(&mut self, time: u64) {
        if self.rate.is_infinite() {
            return;
        }
        let now = Instant::now();
        let nanoseconds = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        if let Some((before, at)) = self.last {
            let recorded = time.saturating_sub(before) as f64 / self.rate;
            let actual = nanoseconds(now - at) as f64;
            if let Some(jitter) = &mut self.jitter {
                jitter.record((actual - recorded).abs() as u64);
            }
        }
        let late = now.saturating_duration_since(self.due(time));
        if let Some(lateness) = &mut self.lateness {
            lateness.record(nanoseconds(late));
        }
        self.last = Some((time, now));
    }

    /// |actual − recorded| time between two messages; nothing if they were sent without a pace.
    pub(super) fn jitter(&self) -> Option<Spread> {
        spread(self.jitter.as_ref()?)
    }

    /// How long after they were due messages went out.
    pub(super) fn lateness(&self) -> Option<Spread> {
        spread(self.lateness.as_ref()?)
    }
}

fn spread(times: &Distribution) -> Option<Spread> {
    let found = times.percentiles();
    (found.count > 0).then_some(Spread {
        p50: found.p50,
        p99: found.p99,
        max: found.max,
    })
}
