//! `protean bench`: what a run costs, each figure beside its baseline, measured in the same run.
//!
//! * [`chase`]: how much faster than reality the whole chase runs, and which process takes what;
//! * [`start`]: how long a run takes to begin, what memory and log it needs;
//! * [`ticks`]: lock-step ticks per second against the same exchange on bare iceoryx2 and futexes;
//! * [`hop`]: one message from one process to another against bare iceoryx2;
//! * [`in_process`]: games per second of runs in one process against runs with processes;
//! * [`recorder`]: writing a log against the bare `mcap` crate, and what a log adds to a chase.
//!
//! Everything is real: processes of this very program, shared memory, the kernel's scheduler. The
//! machine's other work shows in the figures; ratios are taken between neighbours in time.

pub mod chase;
mod crew;
mod error;
pub mod hop;
pub mod in_process;
pub mod link;
pub mod pinning;
mod probe;
mod raw;
pub mod recorder;
mod report;
mod session;
mod shared;
pub mod start;
pub(crate) mod stats;
pub mod ticks;

pub use error::BenchError;
pub use raw::planner as raw_planner;
pub(crate) use report::load;
pub use report::{Baseline, Figure, Goal, Report};
pub use stats::{Spread, paired_ratio};

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Something that `protean bench` measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// Real-time factor of the chase, and where its time goes.
    Chase,
    /// Time to the first tick, memory, size of the log.
    Start,
    /// Lock-step ticks per second.
    Ticks,
    /// One message between two processes.
    Hop,
    /// Games per second of runs in one process.
    InProcess,
    /// Writing a log, and its share of a run.
    Recorder,
}

impl Item {
    /// Every item, in the order in which they are measured.
    pub const ALL: [Self; 6] = [
        Self::Chase,
        Self::Start,
        Self::Ticks,
        Self::Hop,
        Self::InProcess,
        Self::Recorder,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chase => "chase",
            Self::Start => "start",
            Self::Ticks => "ticks",
            Self::Hop => "hop",
            Self::InProcess => "in-process",
            Self::Recorder => "recorder",
        }
    }
}

/// How to measure.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Fewer repetitions: a first impression within seconds.
    pub quick: bool,
    /// Set from outside (Ctrl-C) to end in order.
    pub interrupted: Arc<AtomicBool>,
}

impl Options {
    /// `full` repetitions, or `quick` ones.
    pub(crate) fn repeats(&self, full: usize, quick: usize) -> usize {
        if self.quick { quick } else { full }
    }

    pub(crate) fn check(&self) -> Result<(), BenchError> {
        if self.interrupted.load(Ordering::SeqCst) {
            Err(BenchError::Interrupted)
        } else {
            Ok(())
        }
    }
}

/// Longest time for one item; what is not measured by then is an error.
const ITEM_WITHIN: Duration = Duration::from_secs(120);

/// When an item must be done.
#[derive(Debug, Clone, Copy)]
struct Deadline(Instant);

impl Deadline {
    fn new() -> Self {
        Self(Instant::now() + ITEM_WITHIN)
    }

    fn check(self, what: &str) -> Result<(), BenchError> {
        if Instant::now() < self.0 {
            return Ok(());
        }
        Err(BenchError::TooSlow {
            what: what.to_owned(),
            limit: ITEM_WITHIN,
        })
    }
}

/// Measures the items one after the other; `say` is told what is going on.
///
/// A failed item does not keep the others from being measured: its error is in the report.
pub fn run(items: &[Item], options: &Options, mut say: impl FnMut(&str)) -> Report {
    let mut report = Report::new();
    for &item in items {
        let measured = match item {
            Item::Chase => chase::measure(options, &mut say),
            Item::Start => start::measure(options, &mut say),
            Item::Ticks => ticks::measure(options, &mut say),
            Item::Hop => hop::measure(options, &mut say),
            Item::InProcess => in_process::measure(options, &mut say),
            Item::Recorder => recorder::measure(options, &mut say),
        };
        match measured {
            Ok(figures) => report.figures.extend(figures),
            Err(BenchError::Interrupted) => {
                report.interrupted = true;
                break;
            }
            Err(error) => report.errors.push((item.name(), error.to_string())),
        }
    }
    report
}
