//! `protean chaos`.

use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use indicatif::{ProgressBar, ProgressStyle};

use super::run::{handle_signals, refuse_external};
use super::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, OverrideArgs, complain, print, print_json};
use crate::chaos::fault::{FaultKind, Policy};
use crate::chaos::{ChaosOptions, ChaosReport, chaos, table};
use crate::scenario::Loader;

/// What stands below the options.
pub(super) const HELP: &str = "\
Every fault has a mission of its own: a run of the scenario as its own program, in lock-step or by the clock,
to a process of which something is done at a moment that --fault-seed draws. Then is checked that

  the run ends, in bounded time, with an exit code that says how;
  a process that fails is named, and its policy is followed: the run ends, or the process comes back;
  robots whose planner fails stand still as soon as its last command is too old;
  what only passes by (a pause, slowness) leaves the history in lock-step as it was, digest and all;
  no process of the run survives, and nothing remains in shared memory or on disk, after a killed
  orchestrator not once `protean clean` has been through;
  the log can be read, and a killed orchestrator has lost at most its last second.

Who is hit, how, when and under which policy, follows from it; what the machine makes of the moment
does not.

Exit codes: 0 all promises held, 1 some were broken, 2 wrong usage or scenario, 3 ended by Ctrl-C.";

/// What `protean chaos` takes.
#[derive(Debug, clap::Args)]
pub(super) struct ChaosArgs {
    /// A scenario file, or the name of a built-in scenario
    #[arg(default_value = super::DEFAULT_SCENARIO)]
    scenario: String,
    /// How many faults
    #[arg(long, short = 'n', value_name = "N", default_value_t = 20)]
    faults: u64,
    /// Kinds of faults to draw from [default: all]
    #[arg(long, value_name = "KIND", value_delimiter = ',', value_enum)]
    kinds: Vec<FaultKind>,
    /// What processes do when they fail, to draw from [default: both]
    #[arg(long, value_name = "POLICY", value_delimiter = ',', value_enum)]
    policies: Vec<Policy>,
    /// Seed of the faults (`--seed` is that of the missions)
    #[arg(long, value_name = "N", default_value_t = 1)]
    fault_seed: u64,
    /// Missions by the clock run so many times as fast as reality
    #[arg(long, value_name = "FACTOR", default_value_t = 20.0)]
    real_time: f64,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Let the scenario start programs that are not Protean's own
    #[arg(long)]
    allow_external: bool,
    /// Keep log and words of missions that broke a promise in this folder
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Breaks things, and says what held.
pub fn run(args: &ChaosArgs) -> ExitCode {
    let interrupted = Arc::new(AtomicBool::new(false));
    let options = match options(args, &interrupted) {
        Ok(options) => options,
        Err(code) => return code,
    };
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    let terminal = std::io::stderr().is_terminal();
    let bar = if args.quiet || !terminal {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(args.faults)
    };
    // A template that does not parse would only cost the bar its looks.
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    let report = chaos(&options, |outcome| {
        let line = table::line(outcome);
        bar.inc(1);
        bar.set_message(line.lines().next().unwrap_or_default().to_owned());
        if !args.quiet && (!terminal || !outcome.broken.is_empty()) {
            bar.suspend(|| eprintln!("{line}"));
        }
    });
    bar.finish_and_clear();
    match report {
        Ok(report) => {
            show(args, &report);
            if report.broken > 0 {
                ExitCode::from(EXIT_FAILED)
            } else if report.interrupted {
                ExitCode::from(EXIT_PARTIAL)
            } else {
                ExitCode::SUCCESS
            }
        }
        Err(error) => {
            complain(&error);
            ExitCode::from(EXIT_FAILED)
        }
    }
}

fn show(args: &ChaosArgs, report: &ChaosReport) {
    if args.json {
        print_json(&serde_json::json!(report));
    } else {
        print(&table::text(report));
    }
}

fn options(args: &ChaosArgs, interrupted: &Arc<AtomicBool>) -> Result<ChaosOptions, ExitCode> {
    let invalid = |text: String| {
        eprintln!("error: {text}");
        ExitCode::from(EXIT_INVALID)
    };
    if !(0.001..=1000.0).contains(&args.real_time) {
        let factor = args.real_time;
        return Err(invalid(format!(
            "--real-time {factor}: expected a factor from 0.001 to 1000"
        )));
    }
    if !(1..=1_000_000).contains(&args.faults) {
        let faults = args.faults;
        return Err(invalid(format!(
            "--faults {faults}: expected a number from 1 to 1000000"
        )));
    }
    let loaded = Loader::default()
        .allow_outside(args.overrides.allow_outside)
        .load(&args.scenario, &args.overrides.set, args.overrides.seed)
        .map_err(|problems| {
            complain(&problems);
            ExitCode::from(EXIT_INVALID)
        })?;
    refuse_external(&args.scenario, &loaded, args.allow_external).map_err(|text| {
        eprintln!("{text}");
        ExitCode::from(EXIT_INVALID)
    })?;
    Ok(ChaosOptions {
        scenario: loaded,
        seed: args.fault_seed,
        faults: args.faults,
        kinds: match args.kinds.as_slice() {
            [] => FaultKind::ALL.to_vec(),
            some => some.to_vec(),
        },
        policies: match args.policies.as_slice() {
            [] => vec![Policy::Scenario, Policy::Restart],
            some => some.to_vec(),
        },
        real_time: args.real_time,
        keep: args.keep.clone(),
        interrupted: Arc::clone(interrupted),
    })
}
