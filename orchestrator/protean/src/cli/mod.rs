//! The command line.

mod branch;
mod cat;
mod check;
mod clean;
mod common;
mod comparison_text;
mod dataflow;
mod decided;
mod diff;
mod export;
mod help;
mod import;
mod info;
mod lab;
mod latency;
mod list;
mod logs;
mod new;
mod output;
mod picture;
mod plan;
mod plan_generate;
mod process;
mod recover;
mod replay;
mod report;
mod run;
mod run_args;
mod run_summary;
mod schema;
mod sweep;
mod sweep_args;
mod sweep_kind;
mod sweep_output;
mod test;
mod tips;
mod verify;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use platform::eprintln;

use scenario::kind::{Kind, find};

use common::JsonArg;
#[cfg(test)]
pub(crate) use dataflow::Dataflow;
#[cfg(test)]
pub(crate) use help::HEADINGS;
use output::{EXIT_FAILED, EXIT_INVALID, print};
use run_args::{DEFAULT_SCENARIO, RunArgs};

/// Simulate, record and measure missions of 2-D robots: pursuit-evasion, patrol and coverage.
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
    /// Run a scenario and record its log
    Run {
        /// Scenario file, or name of a built-in scenario (see `protean list`)
        #[arg(default_value = DEFAULT_SCENARIO)]
        scenario: String,
        #[command(flatten)]
        args: RunArgs,
    },
    /// Check a scenario without running it
    Check(check::CheckArgs),
    /// Write a scenario file to start from
    #[command(after_long_help = new::HELP)]
    New(new::NewArgs),
    /// List built-in scenarios and kinds of processes
    List {
        #[command(flatten)]
        json: JsonArg,
    },
    /// Write an HTML page about a log: animation, events, figures
    #[command(after_long_help = report::HELP)]
    Report(report::ReportArgs),
    /// Draw a log as an SVG picture: map, paths, captures and escapes
    #[command(after_long_help = picture::HELP)]
    Picture(picture::PictureArgs),
    /// Summarise a log and check its integrity
    #[command(after_long_help = info::HELP)]
    Info(info::InfoArgs),
    /// Print the messages of a log as lines of JSON
    #[command(after_long_help = cat::HELP)]
    Cat(cat::CatArgs),
    /// Write the messages of a log to CSV or Parquet files
    #[command(after_long_help = export::HELP)]
    Export(export::ExportArgs),
    /// Repair a truncated or damaged log
    #[command(after_long_help = recover::HELP)]
    Recover(recover::RecoverArgs),
    /// Publish a log again, or test processes against it
    #[command(after_long_help = replay::HELP)]
    Replay(replay::ReplayArgs),
    /// Make a log of robots in a ROS 2 bag, to test processes against
    #[command(after_long_help = import::HELP)]
    Import(import::ImportArgs),
    /// Run the scenario of a log again and compare every message
    #[command(after_long_help = verify::HELP)]
    Verify(verify::VerifyArgs),
    /// Name the first difference of two runs and the process behind it
    #[command(after_long_help = diff::HELP)]
    Diff(diff::DiffArgs),
    /// Let the run of a log go on from a moment with a change
    #[command(after_long_help = branch::HELP)]
    Branch(branch::BranchArgs),
    /// Find the moment from which on the outcomes of a run were settled
    #[command(after_long_help = decided::HELP)]
    Decided(decided::DecidedArgs),
    /// Run an experiment: many missions, one table of results
    #[command(
        args_conflicts_with_subcommands = true,
        subcommand_negates_reqs = true,
        after_long_help = sweep_args::HELP
    )]
    Sweep(sweep_args::SweepArgs),
    /// Run missions as tests of what is expected of them
    #[command(after_long_help = test::HELP)]
    Test(test::TestArgs),
    /// Reproduce the published results of four papers, with verdicts
    #[command(after_long_help = lab::HELP)]
    Reproduce(lab::LabArgs),
    /// Plan minimum-time trajectories for the instances of a file
    #[command(
        args_conflicts_with_subcommands = true,
        subcommand_negates_reqs = true,
        after_long_help = plan::HELP
    )]
    Plan(plan::PlanArgs),
    /// Measure the latency from world state to command, and its parts
    #[command(after_long_help = latency::HELP)]
    Latency(latency::LatencyArgs),
    /// Remove processes, shared memory and files of killed runs
    Clean {
        #[command(flatten)]
        json: JsonArg,
    },
    /// Print a schema (scenarios, experiments) or a C header
    Schema {
        /// File type that the schema describes
        #[arg(value_enum)]
        subject: schema::SchemaOf,
    },
    /// Print a completion script for a shell
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Run a planner in C or C++ as one process of a run: `command = ["protean", "planner", "LIBRARY"]`
    #[command(hide = true)]
    Planner {
        /// Shared library of the planner
        library: PathBuf,
    },
    /// Run as one process of a run (called by the orchestrator)
    #[command(hide = true)]
    Process {
        /// Kind of the process
        kind: String,
        /// Configuration file
        #[arg(long)]
        config: PathBuf,
    },
}

/// Returns the definition of the command line.
pub fn program() -> clap::Command {
    tips::with_negative_numbers(help::with_headings(Cli::command()))
}

/// Runs the command line with these kinds of processes; returns the exit code.
///
/// The main function of `protean` is `main_with(KINDS.to_vec())`; another program adds its own kinds:
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
    if let Some(name) = duplicate(kinds) {
        eprintln!("error: this program has two kinds of processes named {name:?}");
        return ExitCode::from(EXIT_INVALID);
    }
    // A declaration registers its topics; their logs can then be read.
    for kind in kinds {
        kind.declaration();
    }
    platform::descriptors::raise_limit();
    platform::signals::keep_ends_of_children();
    platform::signals::refuse_large_files();
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut program = help::for_terminal(program());
    let cli = program
        .try_get_matches_from_mut(std::env::args_os())
        .and_then(|matches| Cli::from_arg_matches(&matches).map_err(|e| e.format(&mut program)))
        .unwrap_or_else(|error| tips::improved(error, &arguments).exit());
    let code = output::exit_code(command(kinds, cli));
    // Shared memory is limited as files are; the errors of the system do not name the limit.
    if code == ExitCode::from(EXIT_FAILED)
        && let Some(limits) = platform::limits::in_force()
    {
        eprintln!("note: {limits}");
    }
    code
}

/// Returns the completion script of a shell; it completes the names of the built-in scenarios, too.
fn completions(shell: clap_complete::Shell) -> String {
    // As long as the program, which ends with the command.
    let names = scenario::list()
        .into_iter()
        .map(|scenario| &*scenario.name.leak());
    let names = clap::builder::PossibleValuesParser::new(names);
    let mut program = program();
    for command in ["run", "check"] {
        program = program.mut_subcommand(command, |command| {
            command.mut_arg("scenario", |argument| argument.value_parser(names.clone()))
        });
    }
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program, "protean", &mut script);
    String::from_utf8_lossy(&script).trim_end().to_owned()
}

/// Returns a name that two kinds share.
fn duplicate(kinds: &[Kind]) -> Option<&'static str> {
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
    let Some(command) = cli.command else {
        return run::run(kinds, DEFAULT_SCENARIO, &cli.run);
    };
    match command {
        Command::Run { scenario, args } => run::run(kinds, &scenario, &args),
        Command::Check(args) => check::run(kinds, &args),
        Command::New(args) => new::run(&args),
        Command::List { json } => list::list(kinds, json.json),
        Command::Report(args) => report::run(&args),
        Command::Picture(args) => picture::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Cat(args) => cat::run(args),
        Command::Export(args) => export::run(&args),
        Command::Recover(args) => recover::run(&args),
        Command::Replay(args) => replay::run(kinds, args),
        Command::Import(args) => import::run(kinds, args),
        Command::Verify(args) => verify::run(kinds, &args),
        Command::Diff(args) => diff::run(kinds, &args),
        Command::Branch(args) => branch::run(kinds, &args),
        Command::Decided(args) => decided::run(kinds, &args),
        Command::Sweep(args) => sweep::sweep(kinds, &args),
        Command::Test(args) => test::run(kinds, &args),
        Command::Reproduce(args) => lab::execute("reproduce", &args),
        Command::Plan(args) => plan::run(&args),
        Command::Latency(args) => latency::run(kinds, &args),
        Command::Clean { json } => clean::clean(json.json),
        Command::Schema { subject } => schema::schema(kinds, subject),
        Command::Completions { shell } => {
            print(&completions(shell));
            ExitCode::SUCCESS
        }
        Command::Planner { library } => library_planner::run(&library),
        Command::Process { kind, config } => process::run(kinds, &kind, &config),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn completion_scripts_know_the_built_in_scenarios() {
        for shell in [clap_complete::Shell::Bash, clap_complete::Shell::Zsh] {
            assert!(completions(shell).contains("single_lane"), "{shell}");
        }
    }
}
