//! Room for what processes say: where shared memory is full, whoever writes to it is killed (SIGBUS).
//!
//! iceoryx2 (0.10) reserves addresses, and pages only as they are written to, so that nobody knows
//! beforehand what a run will take: 2 MB for a robot or two, half a gigabyte for sixty, but containers
//! often have 64 MB. Therefore a run that finds too little does not begin, one that uses up what there is
//! ends while it can end in order, and who is killed all the same is told from others who are.

use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;

use super::report;

/// Where iceoryx2 puts what is shared.
const SHARED_MEMORY: &str = "/dev/shm";
/// What must be free as long as processes are being started, each of which takes some: more than all
/// that the orchestrator itself makes, and than a few of them take from one look to the next [bytes].
const LEAST_TO_START: u64 = 4 << 20;
/// What must stay free: more than small runs take up from one look to the next [bytes].
const LEAST_TO_GO_ON: u64 = 1 << 20;
/// What is sent to whoever writes where nothing can be had any more.
const SIGBUS: i32 = signal_hook::consts::SIGBUS;

/// Shared memory that is full, or nearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "shared memory is full: {free}, expected at least {needed:.1} MB; make room there, make it larger \
     (`docker run --shm-size`, `mount -o remount,size=`), or run fewer robots or missions at once",
    needed = megabytes(*needed)
)]
pub struct NoRoom {
    free: Room,
    /// [bytes]
    needed: u64,
}

/// What there is of shared memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Room {
    /// What anybody may still take [bytes].
    free: u64,
    /// All of it [bytes].
    total: u64,
}

impl Room {
    /// As it is now; `None` if it has no end, or is not there, of which others will speak.
    fn look() -> Option<Self> {
        let found = rustix::fs::statvfs(SHARED_MEMORY).ok()?;
        let room = Self {
            free: found.f_bavail.saturating_mul(found.f_frsize),
            total: found.f_blocks.saturating_mul(found.f_frsize),
        };
        (room.total > 0).then_some(room)
    }

    fn has(self, needed: u64) -> Result<(), NoRoom> {
        if self.free >= needed {
            return Ok(());
        }
        Err(NoRoom { free: self, needed })
    }
}

impl std::fmt::Display for Room {
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
pub(crate) fn check_start() -> Result<(), NoRoom> {
    Room::look().map_or(Ok(()), |room| room.has(LEAST_TO_START))
}

/// Whether a run may go on.
pub(super) fn check() -> Result<(), NoRoom> {
    Room::look().map_or(Ok(()), |room| room.has(LEAST_TO_GO_ON))
}

/// How a process ended, in words, and why if that can be told.
pub(crate) fn exit_words(status: ExitStatus) -> String {
    words(status, Room::look)
}

fn words(status: ExitStatus, look: impl FnOnce() -> Option<Room>) -> String {
    let words = report::exit_words(status);
    if status.signal() != Some(SIGBUS) {
        return words;
    }
    match look() {
        Some(room) if room.has(LEAST_TO_GO_ON).is_err() => {
            format!("{words} (SIGBUS: shared memory is full, {room})")
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
        let room = Room {
            free: 3 * MIB,
            total: 64 * MIB,
        };
        assert_eq!(room.has(LEAST_TO_GO_ON), Ok(()));
        let error = room.has(LEAST_TO_START).unwrap_err().to_string();
        let words =
            "shared memory is full: 3.1 of 67.1 MB are free in /dev/shm, expected at least 4.2 MB";
        assert!(error.starts_with(words), "{error}");
    }

    #[test]
    fn who_was_killed_for_want_of_room_is_told_from_others() {
        let full = || {
            Some(Room {
                free: 4096,
                total: 8 * MIB,
            })
        };
        let wide = || {
            Some(Room {
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
