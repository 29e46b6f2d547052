//! `protean latency`.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mcap_log::{DerivedError, ReadProgress, derived};
use platform::atomic_file::Readers;
use platform::eprintln;
use platform::file_kind::FileKind;
use platform::output_format::OutputFormat;

use super::common::{ExternalArg, ForceArg, JsonArg, QuietArg, out};
use super::logs;
use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, print, print_json};
use super::run::{LoadError, asked, handle_signals, refuse_external};
use super::run_args::{DEFAULT_SCENARIO, OverrideArgs};
use latency::{LatencyError, Report, Run, mission, of_log, text};
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};

/// Help below the options.
pub const HELP: &str = "\
Runs the scenario in real time, once for every --rate. With a log, it measures from the stamps in the log and runs nothing.

Prints count, p50, p90, p99, p99.9, max and jitter (mean absolute difference of consecutive values) in us, for the
stages of sense-to-act, for every hop, and for the parts of every process's tick; then the ticks answered in time.
The stages of a tick add up to the whole.

Examples:
  protean latency --rate 20 --rate 200
  protean latency hello --duration 5 --out latency.json
  protean latency logs/chase-1.mcap

docs/how-to/latency.md explains every row and every field of the JSON object. Ctrl-C keeps what was measured.

Exit codes: 0 success, 1 a measurement failed, 2 wrong usage, or the log has no latencies, 3 interrupted, or the log is
incomplete.";

/// Range of `--rate` (Hz): that of a tick's length.
const RATES: core::ops::RangeInclusive<f64> = 1.0..=10_000.0;

/// Arguments of `protean latency`.
#[derive(Debug, clap::Args)]
pub struct LatencyArgs {
    /// Scenario file, name of a built-in scenario [default: chase], or log file (.mcap)
    target: Option<String>,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// End the mission after S seconds
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Ticks per second (Hz) [default: the scenario's]; repeatable: one mission for each
    #[arg(long, value_name = "HZ")]
    rate: Vec<f64>,
    /// Write the JSON object to FILE
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::JSON))]
    out: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
    /// Write the log of the mission to FILE
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    log: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Message and exit code of a measurement that failed.
type Refusal = (String, u8);

/// Measures and prints the result.
pub fn run(kinds: &[Kind], args: &LatencyArgs) -> ExitCode {
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    match measure(kinds, args, &interrupted) {
        Ok(code) => ExitCode::from(code),
        Err((text, code)) => {
            eprintln!("{text}");
            ExitCode::from(code)
        }
    }
}

fn measure(
    kinds: &[Kind],
    args: &LatencyArgs,
    interrupted: &Arc<AtomicBool>,
) -> Result<u8, Refusal> {
    runtime::logging::start("warn");
    ipc_types::bus::quiet_transport();
    // The output file is checked before the measurement.
    let log = log_of(args);
    let beside = log.clone().or_else(|| args.log.clone()).unwrap_or_default();
    let out = args.out.as_deref();
    let json = out
        .map(|out| {
            let file = derived::create(out, &beside, args.force.force, Readers::All)?;
            Ok((out, file))
        })
        .transpose()
        .map_err(|error| refusal_of_file(&error))?;
    let mut report = Report::new();
    let mut code = 0;
    if let Some(log) = &log {
        let mut watch = ReadProgress::new(Arc::clone(interrupted), args.quiet.quiet);
        let measured = of_log(log, &mut watch).map_err(|error| refusal(&error))?;
        if !measured.condition.data {
            eprintln!("warning: {} is incomplete", log.display());
            code = EXIT_PARTIAL;
        }
        report.runs.push(Run {
            measured,
            log: Some(log.clone()),
            interrupted: false,
        });
    } else {
        missions(kinds, args, interrupted, &mut report)?;
    }
    if let Some((out, mut file)) = json {
        writeln!(file, "{:#}", report.json())
            .and_then(|()| file.commit())
            .map_err(|error| refusal_of_file(&derived::failed(out)(error)))?;
    }
    if args.json.json {
        print_json(&report.json());
    } else {
        print(&text(&report));
    }
    Ok(if !report.errors.is_empty() {
        EXIT_FAILED
    } else if report.interrupted {
        EXIT_PARTIAL
    } else {
        code
    })
}

fn refusal(error: &LatencyError) -> Refusal {
    let code = match error {
        LatencyError::Log(error) => logs::exit_code_of_read(error),
        error if error.is_invalid_input() => EXIT_INVALID,
        _ => EXIT_FAILED,
    };
    (format!("error: {error}"), code)
}

fn refusal_of_file(error: &DerivedError) -> Refusal {
    let code = logs::exit_code_of_derived(error);
    (format!("error: {error}"), code)
}

/// Returns the log to read: a target that is a log or ends in `.mcap`.
fn log_of(args: &LatencyArgs) -> Option<PathBuf> {
    let target = args.target.as_ref().map(PathBuf::from);
    target.filter(|path| {
        path.extension().is_some_and(|end| end == "mcap")
            || FileKind::from_path(path) == Some(FileKind::Log)
    })
}

/// Runs a mission for every rate.
fn missions(
    kinds: &[Kind],
    args: &LatencyArgs,
    interrupted: &Arc<AtomicBool>,
    report: &mut Report,
) -> Result<(), Refusal> {
    let wrong = |text: String| (text, EXIT_INVALID);
    let target = args.target.as_deref().unwrap_or(DEFAULT_SCENARIO);
    if args.log.is_some() && args.rate.len() > 1 {
        return Err(wrong(
            "error: --log: expected one --rate at most".to_owned(),
        ));
    }
    let rates: Vec<Option<f64>> = if args.rate.is_empty() {
        vec![None]
    } else {
        args.rate.iter().copied().map(Some).collect()
    };
    // All scenarios are checked before the first one runs.
    let scenarios = rates
        .iter()
        .map(|rate| load(kinds, target, args, *rate))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| wrong(error.to_string()))?;
    for scenario in &scenarios {
        if interrupted.load(Ordering::SeqCst) {
            report.interrupted = true;
            break;
        }
        if !args.quiet.quiet {
            let rate = 1.0 / scenario.run.dt;
            eprintln!("measuring {} in real time at {rate:.0} Hz", scenario.name);
        }
        let options = mission::RunOptions {
            log: args.log.clone(),
            force: args.force.force,
            quiet: args.quiet.quiet,
            interrupted: Arc::clone(interrupted),
        };
        let (measured, ended) = match mission::run(scenario, &options) {
            Ok(done) => done,
            // The results of earlier missions are kept.
            Err(error) if !report.runs.is_empty() => {
                report.errors.push(error.to_string());
                break;
            }
            Err(error) => {
                // A mission that was interrupted early is not a failure.
                let (text, code) = refusal(&error);
                let ended = interrupted.load(Ordering::SeqCst);
                return Err((text, if ended { EXIT_PARTIAL } else { code }));
            }
        };
        report.runs.push(Run {
            measured,
            log: args.log.clone(),
            interrupted: ended,
        });
        report.interrupted |= ended || interrupted.load(Ordering::SeqCst);
    }
    Ok(())
}

/// Loads the scenario for one rate.
fn load(
    kinds: &[Kind],
    target: &str,
    args: &LatencyArgs,
    rate: Option<f64>,
) -> Result<ResolvedScenario, LoadError> {
    let mut set = args.overrides.set.clone();
    set.push("run.mode=real_time".to_owned());
    if let Some(rate) = rate {
        if !RATES.contains(&rate) {
            let expected = format!("ticks per second from {} to {}", RATES.start(), RATES.end());
            return Err(LoadError::option("--rate", &rate, expected));
        }
        set.push(format!("run.dt={:?}", 1.0 / rate));
    }
    let load = |set: &[String]| {
        Loader::new(kinds)
            .allow_outside(args.overrides.allow_outside)
            .load(target, set, args.overrides.seed)
    };
    let mut scenario = load(&set)?;
    if let Some(duration) = args.duration {
        if !(duration.is_finite() && duration > 0.0) {
            let expected = "a number of seconds above 0";
            return Err(LoadError::option("--duration", &duration, expected));
        }
        let simulated = duration * scenario.run.real_time_factor;
        let limit = scenario.world.rules.time_limit;
        if limit.is_none_or(|limit| simulated < limit) {
            set.push(format!("rules.time_limit={simulated:?}"));
            scenario = load(&set)?;
        }
    }
    refuse_external(target, &scenario, args.external.allow_external)?;
    asked(scenario, &set, load)
}
