//! `protean chaos`.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::builder::PossibleValue;
use platform::eprintln;

use super::common::{ExternalArg, JsonArg, QuietArg};
use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, print, print_error, print_json};
use super::run::{handle_signals, refuse_external, with_real_time};
use super::run_args::OverrideArgs;
use faults::{ChaosOptions, FaultKind, chaos, line, text};
use scenario::Loader;
use scenario::kind::Kind;

/// Help below the options.
pub(super) const HELP: &str = "\
Every fault has its own mission, which runs as a separate `protean run`. At a time drawn from --fault-seed, one of its
processes or the orchestrator is killed, stopped or paused. Then these guarantees are checked:

  - The run ends in bounded time and names the process that failed.
  - The history of a run that is only paused is identical, bit for bit.
  - No process, shared memory or file is left; after a killed orchestrator, not after `protean clean`.
  - The log is complete; the log of a killed orchestrator can be recovered and lacks at most the last second.

Exit codes: 0 all guarantees hold, 1 some are violated, 2 wrong usage or scenario, 3 interrupted.";

/// Value of `--kinds`.
#[derive(Debug, Clone)]
struct KindArg(FaultKind);

impl clap::ValueEnum for KindArg {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [KindArg; FaultKind::ALL.len()] = {
            let [a, b, c, d] = FaultKind::ALL;
            [KindArg(a), KindArg(b), KindArg(c), KindArg(d)]
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, effect) = self.0.describe();
        Some(PossibleValue::new(name).help(effect))
    }
}

/// Arguments of `protean chaos`.
#[derive(Debug, clap::Args)]
pub(super) struct ChaosArgs {
    /// Scenario file, or name of a built-in scenario (see `protean list`)
    #[arg(default_value = super::run_args::DEFAULT_SCENARIO)]
    scenario: String,
    /// Number of faults, 1 to 1000000
    #[arg(long, short = 'n', value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    faults: u64,
    /// Kinds of faults [default: all]
    #[arg(long, value_name = "KIND", value_delimiter = ',', value_enum)]
    kinds: Vec<KindArg>,
    /// Seed of the faults (`--seed` is the seed of the missions)
    #[arg(long, value_name = "N", default_value_t = 1)]
    fault_seed: u64,
    /// Run in real time instead of lock-step, or FACTOR times as fast
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1")]
    real_time: Option<f64>,
    #[command(flatten)]
    overrides: OverrideArgs,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Injects faults and prints which guarantees hold.
pub(super) fn run(kinds: &[Kind], args: &ChaosArgs) -> ExitCode {
    let options = match options(kinds, args) {
        Ok(options) => options,
        Err(text) => {
            eprintln!("{text}");
            return ExitCode::from(EXIT_INVALID);
        }
    };
    if let Err(error) = handle_signals(&options.interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    let report = chaos(&options, |outcome| {
        if !args.quiet.quiet {
            eprintln!("{}", line(outcome));
        }
    });
    let report = match report {
        Ok(report) => report,
        Err(error) => {
            print_error(&error);
            return ExitCode::from(EXIT_FAILED);
        }
    };
    if args.json.json {
        print_json(&serde_json::json!(report));
    } else {
        print(&text(&report));
    }
    match (report.broken, report.interrupted) {
        (0, false) => ExitCode::SUCCESS,
        (0, true) => ExitCode::from(EXIT_PARTIAL),
        _ => ExitCode::from(EXIT_FAILED),
    }
}

fn options(kinds: &[Kind], args: &ChaosArgs) -> Result<ChaosOptions, String> {
    let set = with_real_time(&args.overrides.set, args.real_time)?;
    let scenario = Loader::new(kinds)
        .allow_outside(args.overrides.allow_outside)
        .load(&args.scenario, &set, args.overrides.seed)
        .map_err(|problems| problems.to_string())?;
    refuse_external(&args.scenario, &scenario, args.external.allow_external)?;
    Ok(ChaosOptions {
        scenario,
        seed: args.fault_seed,
        faults: args.faults,
        kinds: match args.kinds.as_slice() {
            [] => FaultKind::ALL.to_vec(),
            some => some.iter().map(|kind| kind.0).collect(),
        },
        interrupted: Arc::new(AtomicBool::new(false)),
    })
}
