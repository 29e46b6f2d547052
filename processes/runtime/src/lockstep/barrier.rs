//! Layout of the barrier: its words, their writers and the shared mapping.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use memmap2::{MmapOptions, MmapRaw};
use rustix::thread::futex;

/// Maximum number of processes of a run, including the simulator.
pub const MAX_SLOTS: usize = 64;

/// Magic number of files with a tick barrier of this layout.
const MAGIC: u32 = 0x5052_5434;

/// Faults that make the barrier unusable.
#[derive(Debug, thiserror::Error)]
pub enum BarrierError {
    /// The file cannot be created, opened or mapped.
    #[error("tick barrier {path}: {source}")]
    File {
        /// The file in shared memory.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a tick barrier of this version.
    #[error("tick barrier {path}: not a tick barrier of this version ({reason})")]
    Layout {
        /// The file in shared memory.
        path: PathBuf,
        /// Description of the difference.
        reason: String,
    },
    /// The run has more processes than the barrier has slots.
    #[error("{processes} processes, more than the maximum of {MAX_SLOTS}")]
    TooManyProcesses {
        /// Processes of the run.
        processes: usize,
    },
}

/// Phase of the run; written by the orchestrator only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Phase {
    /// Processes open their ports.
    Start = 0,
    /// Every port exists: processes connect their ports.
    Connect = 1,
    /// The map has been sent: processes build their data from it.
    Prepare = 2,
    /// Time runs.
    Run = 3,
    /// All processes end.
    Stop = 4,
}

/// State of a process; written by the process, or by the orchestrator when it finds it dead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum SlotState {
    /// Free slot.
    Empty = 0,
    /// The process has not opened its ports yet.
    Starting = 1,
    /// Its ports are open.
    Ready = 2,
    /// Its ports are connected; it takes part in every tick from now on.
    Connected = 3,
    /// Ended on request.
    Stopped = 4,
    /// It ended with an error.
    Failed = 5,
    /// The orchestrator found it dead; no process waits for it any more.
    Dead = 6,
    /// It has built its data of the map and waits for its first tick.
    Prepared = 7,
}

impl SlotState {
    fn from_word(word: u32) -> Self {
        match word {
            1 => Self::Starting,
            2 => Self::Ready,
            3 => Self::Connected,
            4 => Self::Stopped,
            5 => Self::Failed,
            6 => Self::Dead,
            7 => Self::Prepared,
            _ => Self::Empty,
        }
    }

    /// Returns `true` if ticks wait for the process.
    pub fn takes_part(self) -> bool {
        matches!(self, Self::Connected | Self::Prepared)
    }

    /// Returns `true` if the process takes part or may do so later.
    pub fn is_alive(self) -> bool {
        matches!(self, Self::Starting | Self::Ready) || self.takes_part()
    }
}

/// Words of one process, on a separate cache line.
#[repr(C, align(64))]
pub(super) struct Slot {
    /// [`SlotState`].
    pub state: AtomicU32,
    /// Ticks done; futex of the processes downstream. Of the simulator: its waits for a due tick, progress for the
    /// orchestrator.
    pub done: AtomicU32,
    /// 1 if the simulator waits for this process at every tick.
    pub in_loop: AtomicU32,
    /// 1 if other processes wait for this one, so that `done` needs a wake-up call.
    pub watched: AtomicU32,
}

/// The shared words. All zero is the valid initial state.
#[repr(C)]
pub(super) struct Words {
    pub magic: AtomicU32,
    pub slots: AtomicU32,
    /// [`Phase`]; futex of all processes.
    pub phase: Line,
    /// Ticks posted by the simulator; futex of the processes without upstream.
    pub tick: Line,
    /// Number of arrivals, never reset (a late arrival of the last tick would otherwise count for
    /// this one); futex of the simulator.
    pub arrived: Line,
    /// Number of arrivals at which the simulator is woken.
    pub target: Line,
    /// Number of ticks whose messages have all been sent; written by the simulator.
    pub completed: Line,
    /// Number of ticks in the log; futex of a simulator that waits for the recorder.
    pub recorded: Line,
    /// Incremented when the recorder has records to read; its futex.
    pub record_due: Line,
    /// Requests of processes that start in the middle of a run: the simulator connects to them.
    pub joins: Line,
    /// Number of requests that the simulator has served; futex of the processes that wait for that.
    pub joined: Line,
    /// Twice the number of single steps that the orchestrator has asked for; plus 1 while it holds the world.
    pub hold: Line,
    /// Pace in lock-step (simulated s per s), the bits of an `f32`; 0: as fast as possible.
    pub pace: Line,
    /// 1 when the game is over. It wakes no process; the recorder and the orchestrator poll it.
    pub over: Line,
    pub slot: [Slot; MAX_SLOTS],
}

/// Word on a separate cache line, so that a wait on one does not slow down another.
#[repr(C, align(64))]
pub(super) struct Line(pub AtomicU32);

/// A mapping of the barrier.
pub struct TickBarrier {
    map: MmapRaw,
    path: PathBuf,
}

impl TickBarrier {
    /// Returns the path of the barrier of a run with this prefix.
    pub fn path_for(prefix: &str) -> PathBuf {
        Path::new("/dev/shm").join(format!("{prefix}turn"))
    }

    /// Creates the barrier for a run (orchestrator only), readable by the current user only.
    ///
    /// # Errors
    /// [`BarrierError::File`] if it exists or shared memory is not available,
    /// [`BarrierError::TooManyProcesses`] if the run does not fit.
    pub fn create(prefix: &str, processes: usize) -> Result<Self, BarrierError> {
        if processes > MAX_SLOTS {
            return Err(BarrierError::TooManyProcesses { processes });
        }
        let path = Self::path_for(prefix);
        let failed = |source| BarrierError::File {
            path: path.clone(),
            source,
        };
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create_new(true)
            .mode(0o600)
            .open(&path)
            .map_err(failed)?;
        // Allocated now: a full /dev/shm is an error here and not a SIGBUS at the first write.
        rustix::fs::fallocate(
            &file,
            rustix::fs::FallocateFlags::empty(),
            0,
            size_of::<Words>() as u64,
        )
        .map_err(|e| failed(e.into()))?;
        let barrier = Self::map(&file, path)?;
        barrier
            .words()
            .slots
            .store(processes as u32, Ordering::Relaxed);
        barrier.words().magic.store(MAGIC, Ordering::Release);
        Ok(barrier)
    }

    /// Opens the barrier of a run.
    ///
    /// # Errors
    /// [`BarrierError::File`] if it does not exist, [`BarrierError::Layout`] if it is of another version.
    pub fn open(prefix: &str) -> Result<Self, BarrierError> {
        let path = Self::path_for(prefix);
        let failed = |source| BarrierError::File {
            path: path.clone(),
            source,
        };
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .open(&path)
            .map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        if length != size_of::<Words>() as u64 {
            let reason = format!("{length} bytes: expected {}", size_of::<Words>());
            return Err(BarrierError::Layout { path, reason });
        }
        let barrier = Self::map(&file, path)?;
        let magic = barrier.words().magic.load(Ordering::Acquire);
        if magic != MAGIC {
            let reason = format!("magic {magic:#x}: expected {MAGIC:#x}");
            return Err(BarrierError::Layout {
                path: barrier.path.clone(),
                reason,
            });
        }
        Ok(barrier)
    }

    fn map(file: &File, path: PathBuf) -> Result<Self, BarrierError> {
        let map = MmapOptions::new()
            .len(size_of::<Words>())
            .map_raw(file)
            .map_err(|source| BarrierError::File {
                path: path.clone(),
                source,
            })?;
        Ok(Self { map, path })
    }

    /// Number of processes of the run.
    pub fn processes(&self) -> usize {
        (self.words().slots.load(Ordering::Relaxed) as usize).min(MAX_SLOTS)
    }

    // A mapping starts at a barrier boundary, which is a multiple of every alignment up to 4096.
    #[allow(clippy::cast_ptr_alignment)]
    pub(super) fn words(&self) -> &Words {
        // SAFETY: the mapping is barrier-aligned (≥ the alignment of `Words`), exactly
        // `size_of::<Words>()` bytes long and lives as long as `self`. `Words` consists of
        // `AtomicU32` only, for which every bit pattern is valid and concurrent access from other
        // processes is defined. The file is never truncated while mapped: only the owner of the run
        // removes it, by unlinking.
        unsafe { &*self.map.as_ptr().cast::<Words>() }
    }

    pub(super) fn slot(&self, index: usize) -> &Slot {
        // Indices come from the run's configuration, checked against `processes` at start-up; a
        // wrong one must not read past the barrier.
        &self.words().slot[index.min(MAX_SLOTS - 1)]
    }

    /// Returns the state of a process.
    pub fn state(&self, slot: usize) -> SlotState {
        SlotState::from_word(self.slot(slot).state.load(Ordering::Acquire))
    }

    /// Returns the number of ticks that a process has done.
    pub fn ticks_done(&self, slot: usize) -> u64 {
        u64::from(self.slot(slot).done.load(Ordering::Acquire))
    }

    /// Returns the phase of the run.
    pub fn phase(&self) -> Phase {
        match self.words().phase.0.load(Ordering::Acquire) {
            0 => Phase::Start,
            1 => Phase::Connect,
            2 => Phase::Prepare,
            3 => Phase::Run,
            _ => Phase::Stop,
        }
    }

    /// Ticks posted so far.
    pub fn ticks_posted(&self) -> u64 {
        u64::from(self.words().tick.0.load(Ordering::Acquire))
    }

    /// Returns `true` if the simulator has reported the end of the game.
    pub fn is_over(&self) -> bool {
        self.words().over.0.load(Ordering::Acquire) != 0
    }
}

impl core::fmt::Debug for TickBarrier {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("TickBarrier")
            .field("path", &self.path)
            .field("phase", &self.phase())
            .field("ticks_posted", &self.ticks_posted())
            .finish_non_exhaustive()
    }
}

/// Sleeps while `word` is `seen`, at most for `timeout`. It may wake early without a reason.
pub(super) fn sleep_while(word: &AtomicU32, seen: u32, timeout: Duration) {
    let timeout = rustix::thread::Timespec {
        tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(timeout.subsec_nanos()),
    };
    // Not FUTEX_PRIVATE: the word is shared between processes. Every outcome (woken, changed
    // already, timed out, interrupted by a signal) means: look again.
    let _ = futex::wait(word, futex::Flags::empty(), seen, Some(&timeout));
}

/// Wakes all processes that sleep on `word`.
pub(super) fn wake_all(word: &AtomicU32) {
    let _ = futex::wake(word, futex::Flags::empty(), i32::MAX as u32);
}
