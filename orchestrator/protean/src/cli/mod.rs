//! What a person types.

mod chaos;
mod check;
mod clean;
mod coverage;
mod export;
mod filter;
mod info;
mod instances;
mod latency;
mod list;
mod logs;
mod moved;
mod output;
mod patrol;
mod picture;
mod plan;
mod process;
mod recover;
mod replay;
mod report;
mod rerun;
mod run;
mod run_args;
mod run_summary;
mod schema;
mod sweep;
mod sweep_args;
mod sweep_kind;
mod sweep_output;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};
use platform::eprintln;

use scenario::kind::{Kind, find};

use output::{EXIT_INVALID, print};
use run_args::{DEFAULT_SCENARIO, OverrideArgs, RunArgs};

/// Patrol, coverage and pursuit-evasion with 2-D robots, as real processes over zero-copy shared
/// memory, recorded to MCAP.
///
/// Without a command it runs the default chase.
#[derive(Debug, Parser)]
#[command(name = "protean", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: RunArgs,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario: start its processes, record everything, print the outcome
    Run {
        /// A scenario file, or the name of a built-in scenario (see `protean list`)
        #[arg(default_value = DEFAULT_SCENARIO)]
        scenario: String,
        #[command(flatten)]
        args: RunArgs,
    },
    /// Check a scenario without running it
    Check {
        /// A scenario file, or the name of a built-in scenario
        scenario: String,
        #[command(flatten)]
        overrides: OverrideArgs,
        /// Print the scenario with everything filled in
        #[arg(long)]
        print: bool,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
    /// Print the JSON Schema of a kind of file, for editors
    Schema {
        /// The kind of file
        #[arg(value_enum)]
        file: schema::File,
    },
    /// List the built-in scenarios and the kinds of processes
    List {
        /// Print one JSON object
        #[arg(long)]
        json: bool,
        /// Print a built-in scenario's file, to copy from
        #[arg(long, value_name = "NAME")]
        show: Option<String>,
    },
    /// Draw a log as one picture: the map, the paths of the robots, captures and escapes
    #[command(after_long_help = picture::HELP)]
    Picture {
        /// A log of a run
        log: PathBuf,
        /// Write the picture to this file [default: the log's name with .svg]
        #[arg(long, short, value_name = "FILE")]
        out: Option<PathBuf>,
        /// Show the run at this simulated time (s), with what was believed then, not its end
        #[arg(long, value_name = "T")]
        at: Option<f64>,
        /// Overwrite the picture if it exists
        #[arg(long)]
        force: bool,
    },
    /// Say what a log holds and in what condition it is
    #[command(after_long_help = info::HELP)]
    Info {
        /// A log
        log: PathBuf,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
        /// Show no progress
        #[arg(long, short)]
        quiet: bool,
    },
    /// Save what is left of a log that ends in the middle or is damaged
    #[command(after_long_help = recover::HELP)]
    Recover(recover::RecoverArgs),
    /// Write a part of a log into a new one: some time, some topics
    #[command(after_long_help = filter::HELP)]
    Filter(filter::FilterArgs),
    /// Write the messages of a log as tables
    #[command(after_long_help = export::HELP)]
    Export(export::ExportArgs),
    /// Make one page for a browser of a log: the mission animated, events, figures, latencies
    #[command(after_long_help = report::HELP)]
    Report(report::ReportArgs),
    /// Play a log: send its messages once more, to viewers and processes, or to a process under test
    #[command(after_long_help = replay::HELP)]
    Replay(replay::ReplayArgs),
    /// Do the run in a log again and prove that it is the same
    #[command(after_long_help = rerun::HELP)]
    Rerun(rerun::RerunArgs),
    /// Measure how long it takes from the state of the world to the commands for it, hop by hop
    #[command(after_long_help = latency::HELP)]
    Latency(latency::LatencyArgs),
    /// Plan minimum-time trajectories for every instance of a file, and check them
    #[command(after_long_help = plan::HELP)]
    Plan(plan::PlanArgs),
    /// Make random instances to plan
    #[command(after_long_help = instances::HELP)]
    Instances(instances::InstancesArgs),
    /// The sub-goals of a coverage, the rectangles that they lie in, and what they cover
    #[command(subcommand)]
    Coverage(coverage::CoverageCommand),
    /// The waypoints of a patrol: plan laps, predict them with the key
    #[command(subcommand)]
    Patrol(patrol::PatrolCommand),
    /// Run an experiment: many missions from one file, and one table of results
    #[command(args_conflicts_with_subcommands = true, after_long_help = sweep_args::HELP)]
    Sweep(sweep_args::SweepArgs),
    /// Kill, stop, slow down and double processes of runs, and check what must hold all the same
    #[command(after_long_help = chaos::HELP)]
    Chaos(chaos::ChaosArgs),
    /// Remove what runs that were killed have left behind
    Clean {
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
    /// Print the messages for planners in another language
    Messages {
        /// As a Python module of ctypes structures, for the iceoryx2 package
        #[arg(long, required = true)]
        python: bool,
    },
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Be one process of a run (the orchestrator calls this)
    #[command(hide = true)]
    Process {
        /// Kind of the process
        kind: String,
        /// Its configuration
        #[arg(long)]
        config: PathBuf,
    },
}

/// Runs the command line with these kinds of processes; returns the exit code.
///
/// The main function of `protean` is `main_with(KINDS.to_vec())`; a program of somebody else adds its own kinds:
///
/// ```no_run
/// # use protean::{kinds, main_with};
/// # fn own_kind() -> scenario::kind::Kind { kinds::KINDS[0] }
/// let mut all = kinds::KINDS.to_vec();
/// all.push(own_kind()); // kinds::planner::<OwnPlanner>()
/// main_with(all);
/// ```
pub fn main_with(kinds: Vec<Kind>) -> ExitCode {
    // As long as the program, which ends with the command.
    let kinds: &'static [Kind] = kinds.leak();
    if let Some(name) = twice(kinds) {
        eprintln!("error: this program has two kinds of processes called {name:?}");
        return ExitCode::from(EXIT_INVALID);
    }
    platform::descriptors::raise_limit();
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    if let Some(message) = moved::message(&arguments) {
        eprintln!("{message}");
        return ExitCode::from(EXIT_INVALID);
    }
    output::exit_code(command(kinds, Cli::parse()))
}

/// A name that two kinds have.
fn twice(kinds: &[Kind]) -> Option<&'static str> {
    let mut rest = kinds;
    while let [kind, others @ ..] = rest {
        if find(others, kind.name).is_some() {
            return Some(kind.name);
        }
        rest = others;
    }
    None
}

fn command(kinds: &'static [Kind], cli: Cli) -> ExitCode {
    match cli.command {
        None => run::run(kinds, DEFAULT_SCENARIO, &cli.run),
        Some(Command::Run { scenario, args }) => run::run(kinds, &scenario, &args),
        Some(Command::Check {
            scenario,
            overrides,
            print,
            json,
        }) => check::check(kinds, &scenario, &overrides, print, json),
        Some(Command::Schema { file }) => schema::schema(kinds, file),
        Some(Command::List { json, show }) => list::list(kinds, json, show.as_deref()),
        Some(Command::Picture {
            log,
            out,
            at,
            force,
        }) => picture::picture(&log, out, at, force),
        Some(Command::Info { log, json, quiet }) => info::info(&log, json, quiet),
        Some(Command::Recover(args)) => recover::run(&args),
        Some(Command::Filter(args)) => filter::run(args),
        Some(Command::Export(args)) => export::run(args),
        Some(Command::Report(args)) => report::run(kinds, &args),
        Some(Command::Replay(args)) => replay::run(kinds, args),
        Some(Command::Rerun(args)) => rerun::run(kinds, &args),
        Some(Command::Latency(args)) => latency::run(kinds, &args),
        Some(Command::Plan(args)) => plan::plan(&args),
        Some(Command::Instances(args)) => instances::instances(&args),
        Some(Command::Coverage(command)) => coverage::coverage(kinds, &command),
        Some(Command::Patrol(command)) => patrol::patrol(kinds, command),
        Some(Command::Sweep(args)) => sweep::sweep(kinds, &args),
        Some(Command::Chaos(args)) => chaos::run(kinds, &args),
        Some(Command::Clean { json }) => clean::clean(json),
        Some(Command::Messages { python: _ }) => {
            print(ipc_types::python::module().trim_end());
            ExitCode::SUCCESS
        }
        Some(Command::Completions { shell }) => {
            clap_complete::generate(
                shell,
                &mut Cli::command(),
                "protean",
                &mut std::io::stdout(),
            );
            ExitCode::SUCCESS
        }
        Some(Command::Process { kind, config }) => process::run(kinds, &kind, &config),
    }
}
