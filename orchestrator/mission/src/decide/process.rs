//! Supervision state of one process.

use std::time::{Duration, Instant};

use ipc_types::topics::{OptimiserPlan, Service as _};
use runtime::declaration::Flow;

use super::{Action, Failure, OnFailure};
use crate::plan::Launch;

/// A supervised process.
#[derive(Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "independent properties of its kind"
)]
pub(super) struct Process {
    pub(super) is_simulator: bool,
    pub(super) on_failure: OnFailure,
    pub(super) ready_timeout: Duration,
    /// Indices of the processes whose messages of a tick it waits for.
    pub(super) upstream: Vec<usize>,
    pub(super) makes_plans: bool,
    pub(super) needs_plans: bool,
    pub(super) drives_robots: bool,
    pub(super) participation: Participation,
    pub(super) failures: u32,
    /// Failure for which it is being killed.
    pub(super) killed_for: Option<Failure>,
    /// Ticks done at the last sign of progress.
    pub(super) done: u64,
    /// Time of the last sign of progress.
    pub(super) since: Instant,
}

/// Participation of a process in the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Participation {
    /// The process takes part.
    Active,
    /// It is to be restarted at this time.
    Failed { due: Instant },
    /// It has been restarted and must be ready by this time.
    Starting { until: Instant },
    /// It has failed and stays ended.
    GivenUp,
}

impl Process {
    /// Creates a process, one of `all`, that takes part.
    pub(super) fn new(launch: &Launch, all: &[Launch], now: Instant) -> Self {
        let config = &launch.config;
        let is_simulator = config.index == 0;
        let position = |up: &u32| all.iter().position(|launch| launch.config.index == *up);
        Self {
            is_simulator,
            // A run needs its simulator.
            on_failure: if is_simulator {
                OnFailure::Abort
            } else {
                launch.supervision.on_failure
            },
            ready_timeout: Duration::from_secs_f64(launch.supervision.ready_timeout_s),
            upstream: config.upstream.iter().filter_map(position).collect(),
            makes_plans: launch.writes(Flow::Answers(OptimiserPlan::NAME)),
            needs_plans: launch.reads(Flow::Answers(OptimiserPlan::NAME)),
            drives_robots: !config.robots.is_empty(),
            participation: Participation::Active,
            failures: 0,
            killed_for: None,
            done: 0,
            since: now,
        }
    }

    /// Returns the action that logs an event of it; `kind` is one of
    /// [`ProcessEvent`](ipc_types::messages::process::ProcessEvent).
    pub(super) fn log_event(&self, kind: u32, tick: u64, reason: &str) -> Action {
        Action::Log {
            kind,
            tick,
            failures: self.failures,
            reason: reason.to_owned(),
        }
    }
}
