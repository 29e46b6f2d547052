//! Why a run failed.

use std::time::Duration;

use ipc_types::bus::{BusError, ReceiveError, SendError};
use mcap_log::LogWriteError;
use runtime::ProcessError;
use runtime::lockstep::BarrierError;
use viewer::LiveError;

use super::child_process::ChildError;
use super::plan::PlanError;
use super::run_directory::RunDirectoryError;
use super::shm_usage::ShmFull;
use recorder::RecorderError;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum MissionError {
    /// The run's directory cannot be had.
    #[error("run directory: {0}")]
    Space(#[from] RunDirectoryError),
    /// The processes have no room for what they say.
    #[error(transparent)]
    Room(#[from] ShmFull),
    /// The scenario cannot be launched.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The bus cannot be set up.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The tick barrier cannot be set up.
    #[error(transparent)]
    Barrier(#[from] BarrierError),
    /// The log cannot be created.
    #[error(transparent)]
    Log(#[from] LogWriteError),
    /// Live viewers cannot be served.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// The recorder failed.
    #[error(transparent)]
    Recorder(#[from] RecorderError),
    /// A process could not be started.
    #[error(transparent)]
    Child(#[from] ChildError),
    /// An obstacle event could not be sent.
    #[error(transparent)]
    Send(#[from] SendError),
    /// The processes' status could not be read.
    #[error(transparent)]
    Receive(#[from] ReceiveError),
    /// A system call failed.
    #[error("{what}: {source}")]
    System {
        /// What was attempted.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A process ended before its time.
    #[error("process {name} {how} {when}{words}", words = quoted(last_words))]
    Exited {
        /// Name of the process.
        name: String,
        /// Its exit status in words.
        how: String,
        /// `before it was ready`, `at tick 17`.
        when: String,
        /// What it wrote to stderr last.
        last_words: Vec<String>,
    },
    /// A process did not become ready.
    #[error("process {name} was not ready within {waited:?}{words}", words = quoted(last_words))]
    NotReady {
        /// Name of the process.
        name: String,
        /// How long it was waited for.
        waited: Duration,
        /// What it wrote to stderr last.
        last_words: Vec<String>,
    },
    /// A process is alive but no longer answers.
    #[error("process {name} did not answer for {waited:?} at tick {tick}{words}", words = quoted(last_words))]
    Hung {
        /// Name of the process.
        name: String,
        /// The tick it owes.
        tick: u64,
        /// How long it was waited for.
        waited: Duration,
        /// What it wrote to stderr last.
        last_words: Vec<String>,
    },
    /// A run in one process cannot be had, or failed.
    #[error(transparent)]
    InProcess(#[from] InProcessError),
    /// The recorder's thread ended by a panic.
    #[error("the recorder's thread ended unexpectedly")]
    RecorderLost,
}

/// Why a run in one process cannot be had, or failed.
#[derive(Debug, thiserror::Error)]
pub enum InProcessError {
    /// Time passes by the clock.
    #[error("run.mode = \"real_time\": a run in one process knows \"lock_step\" only")]
    RealTime,
    /// A process is a program of the user's.
    #[error(
        "processes.{name}.command: a program of its own cannot run inside this one; run it as \
         processes, or give {name} a `kind`"
    )]
    External {
        /// Name of the process.
        name: String,
    },
    /// The plan begins with another process than the simulator.
    #[error("the run has no simulator")]
    NoSimulator,
    /// Processes need each other's output of the same tick.
    #[error("processes {} wait for each other", names.join(", "))]
    Circular {
        /// Their names.
        names: Vec<String>,
    },
    /// A process failed.
    #[error("process {name} failed {when}: {source}")]
    Process {
        /// Its name.
        name: String,
        /// `before the first tick`, `at tick 17`.
        when: String,
        /// Why.
        source: ProcessError,
    },
    /// A process panicked: a bug in Protean.
    #[error("a process of the run panicked: {message}")]
    Panicked {
        /// What the panic said.
        message: String,
    },
}

fn quoted(lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let mut text = String::from("; it said last:");
    for line in lines {
        text.push_str("\n    ");
        text.push_str(line);
    }
    text
}
