//! Silence of a run: the time since its last progress.

use std::time::{Duration, Instant};

use platform::proc::CpuTime;

/// State and processor time of a process, by the system.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Activity {
    /// A signal or a debugger has stopped it.
    pub(crate) is_stopped: bool,
    /// Its processor time so far.
    pub(crate) cpu: CpuTime,
}

/// The time since the last progress of a run, and what its processes did meanwhile.
#[derive(Debug)]
pub(super) struct Silence {
    progress: u64,
    since: Instant,
    /// Early in the silence: the time, and the activities of the processes.
    before: Option<(Instant, Vec<Activity>)>,
}

impl Silence {
    pub(super) fn new(now: Instant) -> Self {
        Self {
            progress: 0,
            since: now,
            before: None,
        }
    }

    /// Starts to measure again.
    pub(super) fn restart(&mut self, now: Instant) {
        (self.since, self.before) = (now, None);
    }

    /// Returns the time for which `progress` has not changed.
    pub(super) fn lasts(&mut self, progress: u64, now: Instant) -> Duration {
        if progress != self.progress {
            self.progress = progress;
            self.restart(now);
        }
        now.saturating_duration_since(self.since)
    }

    /// Returns `true` if [`Silence::begin`] was called in this silence.
    pub(super) fn has_begun(&self) -> bool {
        self.before.is_some()
    }

    /// Keeps the activities from which the silence counts processor time.
    pub(super) fn begin(&mut self, now: Instant, activities: &[Activity]) {
        self.before = Some((now, activities.to_vec()));
    }

    /// Returns the time for which a process waited for a core.
    pub(super) fn waited(&self, index: usize, now: &[Activity]) -> Duration {
        self.spent(index, now).waited
    }

    /// Returns `true` if a process computed, or waited for a core, most of the time.
    pub(super) fn is_busy(&self, index: usize, time: Instant, now: &[Activity]) -> bool {
        let spent = self.spent(index, now);
        self.before.as_ref().is_some_and(|(begun, _)| {
            let time = time.saturating_duration_since(*begun);
            !time.is_zero() && spent.ran + spent.waited > time / 2
        })
    }

    fn spent(&self, index: usize, now: &[Activity]) -> CpuTime {
        let before = self.before.as_ref().and_then(|(_, all)| all.get(index));
        let (Some(before), Some(now)) = (before, now.get(index)) else {
            return CpuTime::default();
        };
        // The threads that ended meanwhile are missing from the sum.
        CpuTime {
            ran: now.cpu.ran.saturating_sub(before.cpu.ran),
            waited: now.cpu.waited.saturating_sub(before.cpu.waited),
        }
    }
}
