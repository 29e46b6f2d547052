//! Errors of a run.

use std::time::Duration;

use ipc_types::bus::{BusError, ReceiveError, SendError};
use library_planner::LibraryError;
use mcap_log::LogWriteError;
use runtime::ProcessError;
use runtime::lockstep::BarrierError;
use sim_backend::world::WorldError;
use viewer::LiveError;

use super::child_process::ChildError;
use super::plan::PlanError;
use super::run_directory::RunDirectoryError;
use super::shm_usage::ShmFull;
use recorder::RecorderError;

/// Error of a run.
#[derive(Debug, thiserror::Error)]
pub enum MissionError {
    /// The run's directory cannot be created.
    #[error("run directory: {0}")]
    Space(#[from] RunDirectoryError),
    /// Shared memory lacks room for the messages of the processes.
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
    /// The directory of logs without a given path cannot be created.
    #[error("logs: cannot be created: {0}")]
    LogDirectory(std::io::Error),
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
        /// Failed operation.
        what: String,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The program of a process cannot be executed.
    #[error("process {name} {how}")]
    NotStarted {
        /// Name of the process.
        name: String,
        /// Program, reason and expectation, in words.
        how: String,
    },
    /// A process ended before the end of the run.
    #[error("process {name} {how} {when}{words}", words = quoted(last_lines))]
    Exited {
        /// Name of the process.
        name: String,
        /// Exit status in words.
        how: String,
        /// Time of the end: `before it was ready`, `at tick 17`.
        when: String,
        /// Last lines of its output.
        last_lines: Vec<String>,
    },
    /// A process did not become ready.
    #[error("process {name} was not ready within {waited:?}{words}", words = quoted(last_lines))]
    NotReady {
        /// Name of the process.
        name: String,
        /// Time that the orchestrator waited.
        waited: Duration,
        /// Last lines of its output.
        last_lines: Vec<String>,
    },
    /// A process is alive but does not answer.
    #[error("process {name} did not answer for {waited:?} at tick {tick}{words}", words = quoted(last_lines))]
    Hung {
        /// Name of the process.
        name: String,
        /// Tick that it owes.
        tick: u64,
        /// Time that the orchestrator waited.
        waited: Duration,
        /// Last lines of its output.
        last_lines: Vec<String>,
    },
    /// A run in one process is impossible or failed.
    #[error(transparent)]
    InProcess(#[from] InProcessError),
    /// The recorder's thread ended by a panic.
    #[error("the recorder's thread ended unexpectedly")]
    RecorderLost,
}

impl MissionError {
    /// Returns `true` if nothing was started: what was requested is impossible.
    pub fn is_refusal(&self) -> bool {
        match self {
            Self::Log(error) => !matches!(error, LogWriteError::Write { .. }),
            Self::LogDirectory(_) | Self::NotStarted { .. } => true,
            Self::Live(error) => matches!(error, LiveError::Listen { .. }),
            Self::InProcess(error) => match error {
                InProcessError::Hosted(error) => error.downcast_ref().is_some_and(Self::is_refusal),
                InProcessError::Process { .. } | InProcessError::Panicked { .. } => false,
                _ => true,
            },
            _ => false,
        }
    }
}

/// Error of a run in one process.
#[derive(Debug, thiserror::Error)]
pub enum InProcessError {
    /// The scenario has real-time mode.
    #[error("run.mode = \"real_time\": a run in one process supports \"lock_step\" only")]
    RealTime,
    /// A process is an external program.
    #[error(
        "processes.{name}.command: an external program cannot run inside this one; run it as \
         processes, or give {name} a `kind`"
    )]
    External {
        /// Name of the process.
        name: String,
    },
    /// The library of a process cannot be loaded.
    #[error("process {name}: {source}")]
    Library {
        /// Name of the process.
        name: String,
        /// Fault of the file.
        source: Box<LibraryError>,
    },
    /// The plan does not begin with the simulator.
    #[error("the run has no simulator")]
    NoSimulator,
    /// Processes need each other's messages of the same tick.
    #[error("processes {} wait for each other", names.join(", "))]
    Circular {
        /// Names of the processes.
        names: Vec<String>,
    },
    /// A branch changes a process whose answers others may be waiting for.
    #[error("process {name} answers requests: expected a change of a process that answers none")]
    Answers {
        /// Name of the process.
        name: String,
    },
    /// A robot cannot be at the place that a branch gives it.
    #[error("--place: at tick {tick}: {source}")]
    Place {
        /// Tick of the branch.
        tick: u64,
        /// Robot, place and what is there.
        source: Box<WorldError>,
    },
    /// The external program of a process failed; the error names it.
    #[error(transparent)]
    Hosted(Box<dyn core::error::Error + Send + Sync>),
    /// A process failed.
    #[error("process {name} failed {when}: {source}")]
    Process {
        /// Name of the process.
        name: String,
        /// Time of the failure: `before the first tick`, `at tick 17`.
        when: String,
        /// Cause.
        source: Box<ProcessError>,
    },
    /// A process panicked: a bug in Protean.
    #[error("a process of the run panicked: {message}")]
    Panicked {
        /// Message of the panic.
        message: String,
    },
}

fn quoted(lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let mut text = String::from("; its last output:");
    for line in lines {
        text.push_str("\n    ");
        text.push_str(line);
    }
    text
}
