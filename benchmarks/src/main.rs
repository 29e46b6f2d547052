//! Measurements of whole runs, each with its baseline in the same run of this program.
//!
//! * [`chase`]: real-time factor of the whole chase, and CPU time by process;
//! * [`start`]: start time of a run, its memory and the size of its log;
//! * [`ticks`]: lock-step ticks per second against the same exchange on bare iceoryx2 and futexes;
//! * [`links`]: latency of one message between two processes over Protean's bus, bare iceoryx2, a
//!   socket and a pipe;
//! * [`in_process`]: games per second of runs in one process against runs with processes, and the
//!   share of the log.
//!
//! The processes are real: this program links `protean` and executes itself for `protean run` and
//! for every process. Other load on the machine affects the figures; ratios are taken between
//! measurements that are close in time.

mod chase;
mod in_process;
mod link;
mod links;
mod probe;
mod report;
mod session;
mod spread;
mod start;
mod ticks;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};

use self::report::{Figure, Report};

/// Any error; its text is reported.
type Failure = Box<dyn std::error::Error + Send + Sync>;
type Result<T> = std::result::Result<T, Failure>;

/// Measure whole runs on this machine, with their baselines
///
/// The table has a line per figure: the median with the extremes of the repetitions, the baseline
/// measured in the same run, the ratio to it (median over pairs measured back to back), the goal. With
/// --json, one object: version, machine, load, figures: [{item, name, value, min, max, unit,
/// baseline: {name, value} or null, ratio, goal, met}], errors: [{item, error}]. Exit code: 0 measured
/// (whether or not goals are met), 1 an item failed. Other load on
/// the machine affects the figures: see the load.
#[derive(Debug, Parser)]
#[command(name = "benchmarks", version)]
struct Cli {
    /// Items to measure [default: all]
    items: Vec<Item>,
    #[command(flatten)]
    options: Options,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Options of a measurement.
#[derive(Debug, Clone, Copy, clap::Args)]
struct Options {
    /// Fewer repetitions: a first impression
    #[arg(long)]
    quick: bool,
}

impl Options {
    /// Returns `full` repetitions, or `quick` ones.
    fn repeats(self, full: usize, quick: usize) -> usize {
        if self.quick { quick } else { full }
    }
}

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Item {
    /// Real-time factor of the scenario `chase`, recorder on, on all processors and pinned to one
    /// (baseline: real time at 20 Hz); latency of every hop; CPU time per tick of every process
    Chase,
    /// Time to the first tick and its parts; memory of every process (PSS, RSS); log written per
    /// simulated second
    Start,
    /// Lock-step ticks/s of 8 trivial planner processes (baseline: the same exchange on bare
    /// iceoryx2 and a futex page), on all processors and pinned to one
    Ticks,
    /// Latency of messages as large as those of the chase between two processes, unpinned, on one core and
    /// on two: Protean's bus, a Unix domain socket, a pipe, polled iceoryx2 (baseline: bare iceoryx2 with
    /// event wake-up)
    Links,
    /// Games/s of one core with `run --in-process` in a sweep, CPU per tick (baseline: the same games
    /// with processes, one at a time); cost of a log
    InProcess,
}

impl Item {
    /// Returns the name on the command line.
    fn name(self) -> &'static str {
        match self {
            Self::Chase => "chase",
            Self::Start => "start",
            Self::Ticks => "ticks",
            Self::Links => "links",
            Self::InProcess => "in-process",
        }
    }

    fn measure(self, options: Options) -> Result<Vec<Figure>> {
        match self {
            Self::Chase => chase::measure(options),
            Self::Start => start::measure(options),
            Self::Ticks => ticks::measure(options),
            Self::Links => links::measure(options),
            Self::InProcess => in_process::measure(options),
        }
    }
}

fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    let word = |at: usize| words.get(at).and_then(|word| word.to_str());
    match (word(0), word(1), words.get(3)) {
        (Some("process"), Some(ticks::RUNTIME_PLANNER), Some(config)) => {
            ticks::runtime_planner(Path::new(config))
        }
        (Some("process"), Some(ticks::RAW_PLANNER), Some(config)) => {
            ticks::raw_planner(Path::new(config))
        }
        (Some("process"), Some(link::SINK_KIND), Some(config)) => link::sink(Path::new(config)),
        (Some("process" | "run"), ..) => protean::main_with(kinds::KINDS.to_vec()),
        _ => measure(&Cli::parse()),
    }
}

/// Measures one item after the other; continues after a failed item.
fn measure(cli: &Cli) -> ExitCode {
    ipc_types::bus::quiet_transport();
    let all = Item::value_variants();
    let items = if cli.items.is_empty() {
        all
    } else {
        &cli.items
    };
    let mut report = Report::new();
    for item in items {
        match item.measure(cli.options) {
            Ok(figures) => report.figures.extend(figures),
            Err(error) => report.errors.push((item.name(), error.to_string())),
        }
    }
    if cli.json {
        println!("{}", report.json());
    } else {
        println!("{}", report.text());
    }
    ExitCode::from(u8::from(!report.errors.is_empty()))
}

/// Reports progress on stderr.
fn say(what: &str) {
    eprintln!("measuring {what}");
}
