//! Why a run in one process cannot be had, or failed.

use runtime::ProcessError;

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
