//! The running processes of one run, awaited and ended together.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::ops::{Deref, DerefMut};
use std::os::fd::BorrowedFd;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde::Serialize;

use super::child_process::{ChildError, Executable, RunningProcess, sleep_until_readable};

/// Maximum time for processes to end by themselves.
const END_TIMEOUT: Duration = Duration::from_secs(3);
/// Maximum time for processes to end after SIGTERM.
const TERM_TIMEOUT: Duration = Duration::from_secs(1);
/// Maximum time for the system to end killed processes.
const KILL_TIMEOUT: Duration = Duration::from_secs(3);
/// Interval between two checks of an awaited condition.
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// Processes of a run, in the order of their start. Dropping the group ends them.
#[derive(Debug, Default)]
pub struct ProcessGroup(Vec<RunningProcess>);

/// Error of waiting for a group.
#[derive(Debug, thiserror::Error)]
pub enum AwaitError {
    /// A process ended before the awaited condition.
    #[error("{name} ended: {}", last_lines.join(" / "))]
    Ended {
        /// Name of the process.
        name: String,
        /// Last lines of its output.
        last_lines: Vec<String>,
    },
    /// The time limit has passed.
    #[error("the processes are not ready within {0:?}")]
    TooSlow(Duration),
}

impl ProcessGroup {
    /// Writes the configuration of a process below `root` and starts it in the next slot, with its output shown.
    ///
    /// # Errors
    /// [`ChildError`] names the process and the reason.
    pub fn start(
        &mut self,
        root: &Path,
        name: &str,
        executable: &Executable,
        config: &impl Serialize,
    ) -> Result<(), ChildError> {
        let slot = self.len();
        write_config(root, name, slot, config)?;
        let path = config_path(root, slot);
        let process = RunningProcess::start(name, slot, executable, &path, true, None)?;
        self.push(process);
        Ok(())
    }

    /// Adds a process.
    pub(super) fn push(&mut self, process: RunningProcess) {
        self.0.push(process);
    }

    /// Fails if a process has ended since the last check.
    ///
    /// # Errors
    /// [`AwaitError::Ended`] contains its name.
    pub fn check(&mut self) -> Result<(), AwaitError> {
        let ended = self.0.iter_mut().find_map(|process| {
            let has_ended = process.check_exit();
            has_ended.then_some(process)
        });
        ended.map_or(Ok(()), |process| {
            Err(AwaitError::Ended {
                name: process.name.clone(),
                last_lines: process.last_lines(),
            })
        })
    }

    /// Waits until `done` returns `true`.
    ///
    /// # Errors
    /// [`AwaitError`] if a process ends before, or it takes longer than `limit`.
    pub fn wait(
        &mut self,
        limit: Duration,
        mut done: impl FnMut() -> bool,
    ) -> Result<(), AwaitError> {
        let deadline = Instant::now() + limit;
        while !done() {
            self.check()?;
            if Instant::now() > deadline {
                return Err(AwaitError::TooSlow(limit));
            }
            std::thread::sleep(POLL_INTERVAL);
        }
        Ok(())
    }

    /// Sleeps until a process has ended or `wake` is readable, for `timeout` at most.
    pub(super) fn sleep(&self, wake: Option<BorrowedFd<'_>>, timeout: Duration) {
        let ends = self.0.iter().filter_map(RunningProcess::end);
        sleep_until_readable(ends.chain(wake), timeout);
    }

    /// Ends all processes: waits for them to end by themselves, then sends SIGTERM, then kills them. Returns the
    /// names of the killed ones.
    pub(super) fn end(&mut self) -> Vec<String> {
        let mut killed = Vec::new();
        for (signal, time) in [
            (None, END_TIMEOUT),
            (Some(Signal::TERM), TERM_TIMEOUT),
            (Some(Signal::KILL), KILL_TIMEOUT),
        ] {
            for process in &mut self.0 {
                process.check_exit();
                if let Some(signal) = signal
                    && process.exit.is_none()
                {
                    process.signal(signal);
                    if signal == Signal::KILL {
                        killed.push(process.name.clone());
                    }
                }
            }
            self.wait_for_ends(Instant::now() + time);
        }
        // This closes their stdin, whose end tells a process that the orchestrator has ended.
        self.0.clear();
        killed
    }

    fn wait_for_ends(&mut self, deadline: Instant) {
        loop {
            for process in &mut self.0 {
                process.check_exit();
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.0.iter().all(|process| process.exit.is_some()) {
                return;
            }
            self.sleep(None, left);
        }
    }
}

impl Deref for ProcessGroup {
    type Target = [RunningProcess];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for ProcessGroup {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        self.end();
    }
}

/// Writes the configuration of a process, readable by the current user only.
///
/// # Errors
/// [`ChildError`] names the process and the reason.
pub fn write_config(
    root: &Path,
    name: &str,
    slot: usize,
    config: &impl Serialize,
) -> Result<(), ChildError> {
    let write = || {
        let text = serde_json::to_vec(config)?;
        let mut file = OpenOptions::new()
            .create_new(true)
            .write(true)
            .mode(0o600)
            .open(config_path(root, slot))?;
        file.write_all(&text)
    };
    write().map_err(|source| ChildError {
        name: name.to_owned(),
        what: "cannot get its configuration",
        source,
    })
}

/// Returns the path of a process's configuration. The file name contains the slot, since process names may contain
/// any character.
pub(super) fn config_path(root: &Path, slot: usize) -> PathBuf {
    root.join(format!("process-{slot}.json"))
}
