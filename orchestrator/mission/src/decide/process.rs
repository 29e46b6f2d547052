//! A process as its decisions need it.

use std::time::{Duration, Instant};

use runtime::kind::Product;

use super::{Action, Failure, OnFailure};
use crate::plan::Launch;

/// A process as it is supervised.
#[derive(Debug)]
pub(super) struct Process {
    pub(super) is_simulator: bool,
    pub(super) on_failure: OnFailure,
    pub(super) ready_timeout: Duration,
    /// Processes of the list whose messages of a tick it waits for.
    pub(super) upstream: Vec<usize>,
    pub(super) makes_plans: bool,
    pub(super) drives_robots: bool,
    pub(super) standing: Standing,
    pub(super) failures: u32,
    /// Why it is being killed.
    pub(super) killed_for: Option<Failure>,
    /// Ticks done when more of them were last found.
    pub(super) done: u64,
    /// When that was.
    pub(super) since: Instant,
}

/// Part of a process in the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// It takes part.
    Present,
    /// It is to be started again at this time.
    Away { due: Instant },
    /// It has been started again and must be ready by then.
    Starting { until: Instant },
    /// It does not come back.
    Gone,
}

impl Process {
    /// A process that takes part, one of these.
    pub(super) fn new(launch: &Launch, all: &[Launch], now: Instant) -> Self {
        let config = &launch.config;
        let is_simulator = config.index == 0;
        let position = |up: &u32| all.iter().position(|launch| launch.config.index == *up);
        Self {
            is_simulator,
            // Without the world there is no run.
            on_failure: if is_simulator {
                OnFailure::Abort
            } else {
                launch.supervision.on_failure
            },
            ready_timeout: Duration::from_secs_f64(launch.supervision.ready_timeout_s),
            upstream: config.upstream.iter().filter_map(position).collect(),
            makes_plans: launch.makes(Product::Plans),
            drives_robots: !config.robots.is_empty(),
            standing: Standing::Present,
            failures: 0,
            killed_for: None,
            done: 0,
            since: now,
        }
    }

    /// The action that tells the log of it; `kind` is one of [`ProcessEvent`](ipc_types::messages::process::ProcessEvent).
    pub(super) fn tell(&self, kind: u32, tick: u64, reason: &str) -> Action {
        Action::Tell {
            kind,
            tick,
            failures: self.failures,
            reason: reason.to_owned(),
        }
    }
}
