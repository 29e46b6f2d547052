//! `protean test`.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use mission_tests::{
    Baseline, MissionTest, RunOptions, SuiteReport, TestChange, TestError, Verdict,
};
use platform::atomic_file::save;
use platform::machine::processors;
use platform::output_format::OutputFormat;
use platform::{descriptors, eprintln};
use scenario::kind::Kind;
use serde_json::json;
use sweep::LoadOptions;
use sweep::engine::{Engine, InProcess, Processes};
use sweep::spec::LogPolicy;

use super::common::{ExternalArg, JsonArg, LogPolicyArg, QuietArg, out};
use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, print, print_json};
use super::run::handle_signals;

/// Help below the options.
pub const HELP: &str = "\
A test file names a scenario and what is expected of its missions; a scenario with [expect] is a test, too. A test in two lines:

  scenario = \"chase\"
  expect.outcome.evader_1 = \"escaped\"

The output of --json is the baseline of later runs. docs/how-to/tests.md describes the files.

Exit codes: 0 all tests pass, 1 a test fails, 2 wrong usage or test file, 3 no test fails, but one is inconclusive: its
interval needs more missions, or --timeout or Ctrl-C ended it.";

/// Arguments of `protean test`.
#[derive(Debug, clap::Args)]
pub struct TestArgs {
    /// Test files, scenarios with `expect`, or folders with these [default: tests]
    paths: Vec<PathBuf>,
    /// Run only tests with TEXT in their name
    #[arg(long, value_name = "TEXT", default_value = "")]
    filter: String,
    /// Run missions as processes, one after the other, not in one thread each
    #[arg(long)]
    processes: bool,
    /// Run N missions at once [default: number of processors; 1 with --processes]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    jobs: Option<u16>,
    /// End a mission after S seconds of real time, undecided
    #[arg(long, value_name = "S", default_value = "600", value_parser = clap::value_parser!(u32).range(1..))]
    timeout: u32,
    /// Override a value of every scenario, e.g. `rules.time_limit=60`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Accept: write digests, and WHY they changed, into the files
    #[arg(long, value_name = "WHY", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    update: Option<String>,
    /// Compare with the results in FILE, the output of an earlier --json
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Write the results to FILE as XML of `JUnit`
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::JUNIT))]
    junit: Option<PathBuf>,
    /// Write a summary to FILE as Markdown
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::MARKDOWN))]
    markdown: Option<PathBuf>,
    /// Print annotations of GitHub and add to its summary [default: if `GITHUB_ACTIONS` is set]
    #[arg(long)]
    github: bool,
    /// Missions that keep their log, in folder logs/tests
    #[arg(long, value_name = "WHICH", default_value = "none")]
    keep_logs: LogPolicyArg,
    /// Let scenarios use files outside their folders
    #[arg(long)]
    allow_outside: bool,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    quiet: QuietArg,
    #[command(flatten)]
    json: JsonArg,
}

/// Runs tests and reports their verdicts.
pub fn run(kinds: &'static [Kind], args: &TestArgs) -> ExitCode {
    runtime::logging::start("error");
    let mut options = LoadOptions::new(kinds);
    options.set.clone_from(&args.set);
    options.allow_outside = args.allow_outside;
    options.allow_external = args.external.allow_external && args.processes;
    let tests = match mission_tests::load(&args.paths, &args.filter, &options) {
        Ok(tests) => tests,
        Err(problems) => {
            eprintln!("{problems}");
            return ExitCode::from(EXIT_INVALID);
        }
    };
    let done = carry_out(&tests, args).and_then(|(report, changes)| {
        publish(args, &report, &changes)?;
        let Some(why) = &args.update else {
            return Ok(report.verdict);
        };
        for change in mission_tests::update(&tests, &report, why)? {
            eprintln!("updated: {change}");
        }
        Ok(report.verdict)
    });
    match done {
        Ok(Verdict::Pass) => ExitCode::SUCCESS,
        Ok(Verdict::Inconclusive) => ExitCode::from(EXIT_PARTIAL),
        Ok(Verdict::Fail) => ExitCode::from(EXIT_FAILED),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(match error {
                TestError::Io { .. } | TestError::Threads(_) => EXIT_FAILED,
                TestError::Baseline { .. } | TestError::Changed { .. } => EXIT_INVALID,
            })
        }
    }
}

/// Runs the tests; returns their results, and the changes since the baseline.
fn carry_out(
    tests: &[MissionTest],
    args: &TestArgs,
) -> Result<(SuiteReport, Vec<TestChange>), TestError> {
    let baseline = args.baseline.as_deref().map(Baseline::load).transpose()?;
    let interrupted = Arc::new(AtomicBool::new(false));
    handle_signals(&interrupted).map_err(TestError::io("signals", "cannot handle them"))?;
    let engine: Box<dyn Engine> = if args.processes {
        Box::new(Processes::new(descriptors::available()))
    } else {
        Box::new(InProcess::default())
    };
    let jobs = if args.processes { 1 } else { processors() };
    let options = RunOptions {
        jobs: args.jobs.map_or(jobs, usize::from),
        timeout: Duration::from_secs(args.timeout.into()),
        keep_logs: LogPolicy::from(args.keep_logs),
        logs: PathBuf::from("logs/tests"),
        quiet: args.quiet.quiet,
        interrupted,
    };
    let report = mission_tests::run(tests, engine.as_ref(), &options, baseline.as_ref())?;
    let changes = baseline.map_or_else(Vec::new, |baseline| baseline.changes(&report));
    Ok((report, changes))
}

/// Prints the results, and writes the files that are asked for.
fn publish(args: &TestArgs, report: &SuiteReport, changes: &[TestChange]) -> Result<(), TestError> {
    let is_github = args.github || std::env::var_os("GITHUB_ACTIONS").is_some();
    if args.json.json {
        let mut object = json!(report);
        if args.baseline.is_some() {
            object["changes"] = json!(changes);
        }
        print_json(&object);
    } else {
        print(&mission_tests::text(report));
        if is_github {
            print(mission_tests::annotations(report).trim_end());
        }
    }
    let write = |path: &Path, text: String| {
        save(text.as_bytes(), path)
            .map_err(std::io::Error::other)
            .map_err(TestError::io(path, "cannot be written"))
    };
    if let Some(path) = &args.junit {
        write(path, mission_tests::junit(report))?;
    }
    if let Some(path) = &args.markdown {
        write(path, mission_tests::markdown(report, changes))?;
    }
    if let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|_| is_github) {
        let path = Path::new(&path);
        let file = std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(path);
        let text = mission_tests::markdown(report, changes);
        let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(TestError::io(path, "cannot be written"))?;
    }
    Ok(())
}
