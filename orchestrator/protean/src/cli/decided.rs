//! `protean decided`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use branch::{
    BranchError, DecidedOptions, DecidedReport, Decision, Moment, Parent, curve_svg, decided,
};
use mcap_log::{ReadProgress, derived};
use mission::MissionError;
use platform::atomic_file::Readers;
use platform::machine::processors;
use platform::output_format::OutputFormat;
use platform::progress::Progress;
use platform::scratch::Scratch;
use recorder::time_text;
use replay::lineage::Change;
use report::page::{continuation, report as write_page};
use scenario::kind::Kind;
use serde_json::Value as Json;
use tables::TerminalTable;

use super::branch::ChangeArgs;
use super::common::{ExternalArg, ForceArg, JsonArg, QuietArg, out};
use super::logs::{self, CommandError};
use super::output::{print, print_json};

/// Help below the options.
pub(super) const HELP: &str = "\
At each of M moments the run of the log continues N times, with other random streams (`protean branch --times`), or with values
that --draw draws for each. The outcome of a robot is decided from the moment on from which the share of continuations with this
outcome stays at or above --share. The moment is bracketed to 1 s; there the number of continuations grows, up to 16 N, until
Wilson's 95 % interval of the share excludes --share on both sides.

Exit codes: 0 success, 1 a run failed, 2 the log or the change is not usable, 3 interrupted.";

/// Arguments of `protean decided`.
#[derive(Debug, clap::Args)]
pub(super) struct DecidedArgs {
    /// Log file of a run in lock-step
    log: PathBuf,
    /// Number of moments, evenly from the start to the end
    #[arg(long, value_name = "M", default_value_t = 16)]
    moments: u64,
    /// Continue N times from each moment
    #[arg(long, value_name = "N", default_value_t = 20)]
    times: u64,
    /// Share from which on an outcome counts as decided
    #[arg(long, value_name = "P", default_value_t = 0.9)]
    share: f64,
    #[command(flatten)]
    change: ChangeArgs,
    /// Run N continuations at once [default: number of processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    jobs: Option<u16>,
    /// Write all shares to FILE as CSV
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::CSV))]
    csv: Option<PathBuf>,
    /// Draw the shares of the recorded outcomes into FILE
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::SVG))]
    svg: Option<PathBuf>,
    /// Write the page of the run with these shares to FILE
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::PAGE))]
    report: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Finds when the outcomes of a run were decided.
pub(super) fn run(kinds: &[Kind], args: &DecidedArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet.quiet, |watch| {
        // A file that may not be written is refused before the runs.
        for file in [&args.csv, &args.svg, &args.report].into_iter().flatten() {
            derived::create(file, &args.log, args.force.force, Readers::All)?;
        }
        let allow_external = args.external.allow_external;
        let parent = Parent::read(&args.log, kinds, allow_external, watch)?;
        let change = args.change.change(1, true);
        let options = DecidedOptions {
            moments: args.moments,
            times: args.times,
            threshold: args.share,
            change,
            jobs: args.jobs.map_or_else(processors, usize::from),
        };
        let report = decided(&parent, &options, watch)?;
        let files = [(&args.csv, csv as fn(&_) -> _), (&args.svg, curve_svg)];
        for (file, render) in files {
            let Some(file) = file else { continue };
            let text = render(&report);
            derived::write(
                text.as_bytes(),
                file,
                &args.log,
                args.force.force,
                Readers::All,
            )?;
        }
        let mut json = serde_json::json!(report);
        if args.json.json {
            print_json(&json);
        } else {
            print(&text(&report));
        }
        if let (Some(page), Some(facts)) = (&args.report, json.as_object_mut()) {
            let name = args.log.file_name().unwrap_or_default();
            facts.insert("log".to_owned(), name.to_string_lossy().into());
            facts.insert("examples".to_owned(), examples(&parent, &report, watch)?);
            write_page(&[&args.log], page, args.force.force, Some(json), watch)?;
        }
        Ok(ExitCode::SUCCESS)
    })
}

/// Records examples of the continuations one after the other, and returns their motions for the page.
fn examples(
    parent: &Parent,
    report: &DecidedReport,
    watch: &ReadProgress,
) -> Result<Json, CommandError> {
    let folder = Scratch::create().map_err(|source| MissionError::System {
        what: "scratch directory".to_owned(),
        source,
    });
    let folder = folder.map_err(BranchError::from)?;
    let log = folder.path().join("continuation.mcap");
    let all = report.examples();
    let mut quiet = ReadProgress::new(Arc::clone(&watch.interrupted), true);
    let mut progress = Progress::new(all.len(), 0, watch.quiet, "continuations for the page");
    let mut examples = Vec::new();
    for &(time_s, stream) in &all {
        let change = Change {
            seed: stream,
            ..report.change.clone()
        };
        parent.branch(parent.tick(time_s)?, &change, Some(&log), true, &mut quiet)?;
        let mut example = continuation(&log, time_s, all.len(), &mut quiet)?;
        if let Some(example) = example.as_object_mut() {
            example.insert("time_s".to_owned(), time_s.into());
            example.insert("stream".to_owned(), stream.into());
        }
        examples.push(example);
        progress.done(false, String::new);
    }
    progress.finish();
    Ok(examples.into())
}

fn text(report: &DecidedReport) -> String {
    let mut text = format!(
        "{} (seed {}): {} continuations from {} moments, with other {}\n",
        report.scenario,
        report.seed,
        report.continuations,
        report.moments.len(),
        varied(&report.change)
    );
    for decision in &report.decisions {
        text += &format!(
            "{:<10} {}\n",
            "decided",
            decision_text(decision, report.threshold)
        );
    }
    let decided = |name: &&str| report.decisions.iter().any(|d| d.robot == **name);
    let first = report
        .moments
        .first()
        .into_iter()
        .flat_map(|moment| &moment.robots);
    let shown: Vec<&str> = first.map(|robot| &*robot.robot).filter(decided).collect();
    if shown.is_empty() {
        return text + "no robot had an outcome before the end of the run";
    }
    let outcomes = report
        .decisions
        .iter()
        .map(|d| format!("{} {}", d.robot, d.outcome));
    let columns = ["time (s)".to_owned(), "continuations".to_owned()];
    let columns: Vec<String> = columns.into_iter().chain(outcomes).collect();
    let mut table = TerminalTable::new(columns.iter().map(|name| (name.as_str(), 0)), 0);
    for moment in &report.moments {
        let start = [time_text(moment.time_s), moment.continuations.to_string()];
        let shares = report.decisions.iter().map(|d| share_text(moment, d));
        table.add_row(start.into_iter().chain(shares));
    }
    text + &format!("\n{table}")
}

/// Returns what differs between continuations.
fn varied(change: &Change) -> String {
    let streams = Some(change.reseed.join(", ")).filter(|names| !names.is_empty());
    let streams = streams.map(|names| format!("streams of {names}"));
    let values = Some(change.draw.join(", ")).filter(|draws| !draws.is_empty());
    let values = values.map(|draws| format!("values of {draws}"));
    let both: Vec<String> = streams.into_iter().chain(values).collect();
    both.join(" and ")
}

fn decision_text(decision: &Decision, threshold: f64) -> String {
    let (robot, outcome) = (&decision.robot, decision.outcome.replace('_', " "));
    let at = time_text(decision.time_s);
    let certain = if decision.certain {
        ""
    } else {
        ", not certain at 95 %"
    };
    match decision.between_s {
        None => format!("{robot} {outcome} at {at} s: not decided before the end"),
        Some([low, high]) if low < high => format!(
            "{robot} {outcome} at {at} s: between {} and {} s (share {threshold} or more from then on{certain})",
            time_text(low),
            time_text(high)
        ),
        Some(_) => format!("{robot} {outcome} at {at} s: from the first moment on{certain}"),
    }
}

fn share_text(moment: &Moment, decision: &Decision) -> String {
    let robot = moment
        .robots
        .iter()
        .find(|robot| robot.robot == decision.robot);
    let mut outcomes = robot.iter().flat_map(|robot| &robot.outcomes);
    outcomes
        .find(|share| share.outcome == decision.outcome)
        .map_or_else(
            || "0".to_owned(),
            |share| {
                let [low, high] = [share.interval.low, share.interval.high];
                format!("{:.2} ({low:.2} to {high:.2})", share.share)
            },
        )
}

fn csv(report: &DecidedReport) -> String {
    let mut text = "time_s,robot,recorded,outcome,count,continuations,share,low,high\n".to_owned();
    for moment in &report.moments {
        for robot in &moment.robots {
            for share in &robot.outcomes {
                text += &format!(
                    "{},{},{},{},{},{},{},{},{}\n",
                    time_text(moment.time_s),
                    robot.robot,
                    robot.recorded,
                    share.outcome,
                    share.count,
                    moment.continuations,
                    share.share,
                    share.interval.low,
                    share.interval.high
                );
            }
        }
    }
    text
}
