//! Shared memory that is left for messages. Where it is full, a process that writes to it is killed (SIGBUS).
//!
//! iceoryx2 (0.10) reserves addresses, and pages only as they are written to, so that it is not
//! known beforehand what a run will take: 2 MB for a robot or two, half a gigabyte for sixty, but containers
//! often have 64 MB. Therefore a run that finds too little does not begin, one that uses up what there is
//! ends while it can end in order, and a process that is killed all the same is told from others.

use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;

use super::child_process;

/// Where iceoryx2 puts what is shared.
const SHARED_MEMORY: &str = "/dev/shm";
/// What must be free as long as processes are being started, each of which takes some: more than all
/// that the orchestrator itself makes, and than a few of them take from one look to the next (bytes).
const MIN_FREE_TO_START: u64 = 4 << 20;
/// What must stay free: more than small runs take up from one look to the next (bytes).
const MIN_FREE_TO_GO_ON: u64 = 1 << 20;
/// Signal to a process that writes where no memory is left.
const SIGBUS: i32 = signal_hook::consts::SIGBUS;

/// Shared memory that is full, or nearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "shared memory is full: {free}, expected at least {needed:.1} MB; make room there, make it larger \
     (`docker run --shm-size`, `mount -o remount,size=`), or run fewer robots or missions at once",
    needed = megabytes(*needed)
)]
pub struct ShmFull {
    free: ShmUsage,
    /// (bytes)
    needed: u64,
}

/// Use of shared memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ShmUsage {
    /// What may still be taken (bytes).
    free: u64,
    /// All of it (bytes).
    total: u64,
}

impl ShmUsage {
    /// The present one; `None` if there is no limit or no shared memory, which the bus reports.
    fn look() -> Option<Self> {
        let found = rustix::fs::statvfs(SHARED_MEMORY).ok()?;
        let usage = Self {
            free: found.f_bavail.saturating_mul(found.f_frsize),
            total: found.f_blocks.saturating_mul(found.f_frsize),
        };
        (usage.total > 0).then_some(usage)
    }

    fn has(self, needed: u64) -> Result<(), ShmFull> {
        if self.free >= needed {
            return Ok(());
        }
        Err(ShmFull { free: self, needed })
    }
}

impl std::fmt::Display for ShmUsage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (free, total) = (megabytes(self.free), megabytes(self.total));
        write!(
            formatter,
            "{free:.1} of {total:.1} MB are free in {SHARED_MEMORY}"
        )
    }
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 * 1e-6
}

/// Whether another process may be started.
pub(crate) fn check_start() -> Result<(), ShmFull> {
    ShmUsage::look().map_or(Ok(()), |usage| usage.has(MIN_FREE_TO_START))
}

/// Whether a run may go on.
pub(super) fn check() -> Result<(), ShmFull> {
    ShmUsage::look().map_or(Ok(()), |usage| usage.has(MIN_FREE_TO_GO_ON))
}

/// How a process ended, in words, with the reason if shared memory is it.
pub(super) fn explain_exit(status: ExitStatus) -> String {
    words(status, ShmUsage::look)
}

fn words(status: ExitStatus, look: impl FnOnce() -> Option<ShmUsage>) -> String {
    let words = child_process::exit_words(status);
    if status.signal() != Some(SIGBUS) {
        return words;
    }
    match look() {
        Some(usage) if usage.has(MIN_FREE_TO_GO_ON).is_err() => {
            format!("{words} (SIGBUS: shared memory is full, {usage})")
        }
        _ => format!("{words} (SIGBUS)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    #[test]
    fn what_is_missing_is_told() {
        let usage = ShmUsage {
            free: 3 * MIB,
            total: 64 * MIB,
        };
        assert_eq!(usage.has(MIN_FREE_TO_GO_ON), Ok(()));
        let error = usage.has(MIN_FREE_TO_START).unwrap_err().to_string();
        let words =
            "shared memory is full: 3.1 of 67.1 MB are free in /dev/shm, expected at least 4.2 MB";
        assert!(error.starts_with(words), "{error}");
    }

    #[test]
    fn a_process_killed_for_want_of_memory_is_told_from_others() {
        let full = || {
            Some(ShmUsage {
                free: 4096,
                total: 8 * MIB,
            })
        };
        let wide = || {
            Some(ShmUsage {
                free: 7 * MIB,
                total: 8 * MIB,
            })
        };
        let signal = |number| ExitStatus::from_raw(number);
        assert_eq!(
            words(signal(SIGBUS), full),
            "was ended by signal 7 (SIGBUS: shared memory is full, 0.0 of 8.4 MB are free in /dev/shm)"
        );
        for look in [wide(), None] {
            let words = words(signal(SIGBUS), || look);
            assert_eq!(words, "was ended by signal 7 (SIGBUS)");
        }
        assert_eq!(words(signal(9), full), "was ended by signal 9");
        let exited = ExitStatus::from_raw(3 << 8);
        assert_eq!(words(exited, full), "ended with exit code 3");
    }
}
