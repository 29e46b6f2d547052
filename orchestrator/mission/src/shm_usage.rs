//! Free shared memory. Where it is full, the system kills a process that writes to it (SIGBUS).
//!
//! iceoryx2 (0.10) reserves addresses, but takes pages only when they are written to. The need of a run is therefore
//! unknown in advance: 2 MB for one or two robots, 500 MB for sixty; containers often have 64 MB. A run does not start
//! with too little free memory, and ends in order while some memory is left. If a process is killed by SIGBUS, the
//! error contains the reason.

use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;

use super::child_process;

/// Directory in which iceoryx2 places shared memory.
const SHARED_MEMORY: &str = "/dev/shm";
/// Minimum of free memory while processes are being started (bytes): more than the orchestrator itself takes, and
/// than a few processes take between two checks.
const MIN_FREE_TO_START: u64 = 4 << 20;
/// Minimum of free memory during a run (bytes): more than small runs take between two checks.
const MIN_FREE_TO_GO_ON: u64 = 1 << 20;
/// Signal to a process that writes to shared memory without a free page.
const SIGBUS: i32 = signal_hook::consts::SIGBUS;

/// Error of shared memory that is full or nearly full.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "shared memory is full: {free}: expected at least {needed:.1} MB; free some, enlarge it \
     (`docker run --shm-size`, `mount -o remount,size=`), or run fewer robots or missions at once",
    needed = megabytes(*needed)
)]
pub struct ShmFull {
    free: ShmUsage,
    /// Required free memory (bytes).
    needed: u64,
}

/// Usage of shared memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ShmUsage {
    /// Free memory (bytes).
    free: u64,
    /// Total memory (bytes).
    total: u64,
}

impl ShmUsage {
    /// Measures the current usage; `None` without a limit, or without shared memory, which the bus reports.
    fn measure() -> Option<Self> {
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

/// Checks that there is memory to start a process.
pub(crate) fn check_start() -> Result<(), ShmFull> {
    ShmUsage::measure().map_or(Ok(()), |usage| usage.has(MIN_FREE_TO_START))
}

/// Checks that there is memory to continue a run.
pub(super) fn check() -> Result<(), ShmFull> {
    ShmUsage::measure().map_or(Ok(()), |usage| usage.has(MIN_FREE_TO_GO_ON))
}

/// Describes an exit in words, with the reason if shared memory is full.
pub(super) fn explain_exit(status: ExitStatus) -> String {
    describe(status, ShmUsage::measure)
}

fn describe(status: ExitStatus, look: impl FnOnce() -> Option<ShmUsage>) -> String {
    let words = child_process::describe_exit(status);
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
    fn the_error_contains_free_and_required_memory() {
        let usage = ShmUsage {
            free: 3 * MIB,
            total: 64 * MIB,
        };
        assert_eq!(usage.has(MIN_FREE_TO_GO_ON), Ok(()));
        let error = usage.has(MIN_FREE_TO_START).unwrap_err().to_string();
        let words =
            "shared memory is full: 3.1 of 67.1 MB are free in /dev/shm: expected at least 4.2 MB";
        assert!(error.starts_with(words), "{error}");
    }

    #[test]
    fn an_exit_by_full_shared_memory_has_its_reason() {
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
            describe(signal(SIGBUS), full),
            "was ended by signal 7 (SIGBUS: shared memory is full, 0.0 of 8.4 MB are free in /dev/shm)"
        );
        for look in [wide(), None] {
            let words = describe(signal(SIGBUS), || look);
            assert_eq!(words, "was ended by signal 7 (SIGBUS)");
        }
        assert_eq!(describe(signal(9), full), "was ended by signal 9");
        let exited = ExitStatus::from_raw(3 << 8);
        assert_eq!(describe(exited, full), "ended with exit code 3");
    }
}
