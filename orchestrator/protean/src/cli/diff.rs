//! `protean diff`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use diff::{DiffReport, EventChange, LogFacts, ValueChange, diff, or_none};
use mcap_log::{Origin, ReadProgress};
use mission::MissionError;
use platform::file_kind::FileKind;
use platform::scratch::Scratch;
use recorder::time_text;
use replay::origin::scenario_of;
use replay::{ReplayError, run_again};
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};

use super::common::{ExternalArg, JsonArg, QuietArg};
use super::comparison_text::{difference_lines, list};
use super::logs::{self, CommandError};
use super::output::{print, print_json};
use super::run::refuse_external;
use super::run_args::OverrideArgs;
use super::tips;

/// Help below the options.
pub const HELP: &str = "\
Each side is a log, or a scenario that is run first, in this process, without a log. With --seed-b or --set-b the second side
may be a log, whose scenario is then run with these changes. The command names the first tick in
which the histories differ, and in it the processes that received the same inputs and answered otherwise. It also lists the
keys of the scenario, the results and the events that differ.

  protean diff old.mcap new.mcap
  protean diff chase --seed-b 2
  protean diff run.mcap --seed-b 2
  protean diff chase --set-b teams.police.limits.v_max=0.25

Exit codes: 0 the histories are equal, 1 they differ or a run failed, 2 a side is not usable, 3 equal as far as an incomplete
log goes.";

/// Arguments of `protean diff`.
#[derive(Debug, clap::Args)]
pub struct DiffArgs {
    /// Log, scenario file or built-in scenario
    a: String,
    /// The other side [default: the same scenario]
    b: Option<String>,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Seed of the second side
    #[arg(long, value_name = "N", value_parser = tips::seed)]
    seed_b: Option<u64>,
    /// Override a value of the scenario of the second side
    #[arg(long, value_name = "KEY=VALUE")]
    set_b: Vec<String>,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Compares two sides and prints their differences.
pub fn run(kinds: &[Kind], args: &DiffArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet.quiet, |watch| {
        refuse_changes_of_logs(args)?;
        let folder = Scratch::create().map_err(|source| {
            ReplayError::from(MissionError::System {
                what: "a temporary directory: cannot be created".into(),
                source,
            })
        })?;
        let b = args.b.as_ref().unwrap_or(&args.a);
        let first = if is_log(&args.a) {
            PathBuf::from(&args.a)
        } else {
            let load = |more: &[String]| scenario(kinds, &args.a, &args.overrides, more);
            run_first(args, &args.a, load, &folder, "a", watch)?
        };
        let second = if !is_log(b) {
            let mut overrides = args.overrides.clone();
            overrides.seed = args.seed_b.or(overrides.seed);
            overrides.set.extend(args.set_b.iter().cloned());
            let load = |more: &[String]| scenario(kinds, b, &overrides, more);
            run_first(args, b, load, &folder, "b", watch)?
        } else if args.seed_b.is_some() || !args.set_b.is_empty() {
            // The scenario of the log, changed.
            let seed = args.seed_b.map(|seed| format!("run.seed={seed}"));
            let changes: Vec<String> = args.set_b.iter().cloned().chain(seed).collect();
            let log = Path::new(b);
            let origin = Origin::read(log)?;
            let load = |more: &[String]| {
                Ok(scenario_of(
                    &origin,
                    log,
                    &[&changes, more].concat(),
                    "",
                    kinds,
                )?)
            };
            run_first(args, b, load, &folder, "b", watch)?
        } else {
            PathBuf::from(b)
        };
        let report = diff(&first, &second, watch)?;
        if args.json.json {
            print_json(&serde_json::json!(report));
        } else {
            print(&text(&report, &args.a, b));
        }
        for (side, facts) in [(&args.a, &report.a), (b, &report.b)] {
            logs::warn_of_faults(Path::new(side), &facts.condition.lines());
        }
        Ok(logs::of_comparison(report.same, report.whole))
    })
}

fn is_log(side: &str) -> bool {
    FileKind::from_path(Path::new(side)) == Some(FileKind::Log)
}

/// Refuses a seed and overrides that no scenario takes.
fn refuse_changes_of_logs(args: &DiffArgs) -> Result<(), CommandError> {
    let b = args.b.as_ref().unwrap_or(&args.a);
    let OverrideArgs { seed, set, .. } = &args.overrides;
    if (seed.is_some() || !set.is_empty()) && is_log(&args.a) && is_log(b) {
        return Err(CommandError::Usage(format!(
            "{b} is a log: --seed-b and --set-b run its scenario changed, --seed and --set change no log"
        )));
    }
    Ok(())
}

/// Returns the scenario of a side, with more overrides.
fn scenario(
    kinds: &[Kind],
    side: &str,
    overrides: &OverrideArgs,
    more: &[String],
) -> Result<ResolvedScenario, CommandError> {
    Loader::new(kinds)
        .allow_outside(overrides.allow_outside)
        .load(side, &[&overrides.set, more].concat(), overrides.seed)
        .map_err(|problems| usage(&problems.to_string()))
}

/// Runs the scenario of a side, which `load` reads with more overrides; returns its log.
fn run_first(
    args: &DiffArgs,
    side: &str,
    load: impl Fn(&[String]) -> Result<ResolvedScenario, CommandError>,
    folder: &Scratch,
    name: &str,
    watch: &ReadProgress,
) -> Result<PathBuf, CommandError> {
    let mut scenario = load(&[])?;
    refuse_external(side, &scenario, args.external.allow_external)
        .map_err(|error| usage(&error.to_string()))?;
    let declared = mission::ask(&scenario).map_err(|error| usage(&error.to_string()))?;
    if !declared.is_empty() {
        scenario = load(&declared)?;
    }
    let log = folder.path().join(format!("{name}.mcap"));
    let watch = ReadProgress::new(Arc::clone(&watch.interrupted), true);
    let in_process = !scenario.uses_external_commands();
    run_again(scenario, &log, None, in_process, <_>::default(), &watch)
        .map_err(ReplayError::from)?;
    Ok(log)
}

/// Returns the error of an argument, from a text that begins like one.
fn usage(text: &str) -> CommandError {
    CommandError::Usage(text.strip_prefix("error: ").unwrap_or(text).to_owned())
}

/// Returns the report as text.
fn text(report: &DiffReport, a: &str, b: &str) -> String {
    let side = |name: &str, facts: &LogFacts| {
        let (scenario, seed, version) = (&facts.scenario, &facts.seed, &facts.version);
        format!("{name}          {scenario}, seed {seed}, protean {version}")
    };
    let mut lines = vec![
        format!("{}: {a}", side("A", &report.a)),
        format!("{}: {b}", side("B", &report.b)),
    ];
    list(&mut lines, "scenario", &report.scenario, value_line);
    if report.same {
        let extent = if report.whole {
            ""
        } else {
            " as far as both logs go"
        };
        lines.push(format!("histories  equal{extent}"));
    }
    lines.extend(difference_lines("histories", &report.comparison));
    list(&mut lines, "results", &report.results, value_line);
    list(&mut lines, "events", &report.events, event_line);
    lines.join("\n")
}

fn value_line(change: &ValueChange) -> String {
    let [a, b] = [&change.a, &change.b].map(|value| value.as_deref().map_or("none", or_none));
    format!("{}: {a} → {b}", change.key)
}

fn event_line(change: &EventChange) -> String {
    let time = |time: Option<f64>| time.map_or_else(|| "never".to_owned(), |t| time_text(t) + " s");
    format!(
        "{}: {} → {}",
        change.event,
        time(change.a_s),
        time(change.b_s)
    )
}
