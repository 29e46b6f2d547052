//! `protean replay`.

use std::path::PathBuf;
use std::process::ExitCode;

use mcap_log::ReadProgress;

use super::common::{JsonArg, QuietArg};
use super::comparison_text::difference_lines;
use super::logs::{self, CommandError, PartArgs};
use super::output::{EXIT_PARTIAL, print, print_json};
use super::run::report_viewers;
use super::run_args::DEFAULT_PORT;
use replay::{ReplayOptions, ReplayReport, VerificationReport, VerifyOptions, verify};
use scenario::kind::Kind;
use viewer::LiveOptions;

/// Help below the options.
pub const HELP: &str = "\
Publishes the messages of a log in a run of its own; viewers and processes join it like any run (stderr shows its root
and prefix). Messages and stamps are those of the log, byte for byte. The messages of a tick are sent together; the
time between ticks is simulated time divided by --pace. Latched topics (map, state …) are sent first, with their value
before the start. run/control reports the state of the replay (1 playing, 4 ended) and its rate. A subscriber without
free buffers delays the replay and ends it after 10 s; no message is dropped.

With --live, a page in the browser (as of `protean report`), Foxglove and Lichtblick show the replay, with the viewer
topics of the log. A slow viewer misses messages; it never delays the replay.

With --test, processes of the log's scenario run in lock-step, receive the messages that they received in the run, and
their output is compared with the log. Processes under test receive each other's messages; the log supplies all others.
The comparison ends at the first failure of a process in the run. With --set their parameters change, and the output
names the first difference with process, field and values, and lists the deviation of every field.

Exit codes: 0 replayed, or identical; 1 different, or a process or the replay failed; 2 wrong usage, or the log cannot
be used; 3 interrupted, or the log is incomplete (stderr lists what is missing).";

/// Arguments of `protean replay`.
#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub struct ReplayArgs {
    /// Log file
    log: PathBuf,
    /// Replay FACTOR times as fast as real time
    #[arg(long, value_name = "FACTOR", default_value = "1")]
    pace: f64,
    /// Replay as fast as the subscribers can receive
    #[arg(long, conflicts_with = "pace")]
    as_fast_as_possible: bool,
    #[command(flatten)]
    part: PartArgs,
    /// Repeat until Ctrl-C
    #[arg(long = "loop")]
    again: bool,
    /// Show the replay live in a browser, Foxglove or Lichtblick, on PORT of 127.0.0.1, read-only without --control (0: any free port)
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = DEFAULT_PORT)]
    live: Option<u16>,
    /// With --live: open the page in the browser
    #[arg(long, requires = "live")]
    open: bool,
    /// With --live: let the page pause, step and pace the replay, and branch the run at its end; then it stays until Ctrl-C
    #[arg(long, requires = "live")]
    control: bool,
    /// Test this process of the scenario against the log (repeatable)
    #[arg(long, value_name = "PROCESS", conflicts_with_all = [
        "pace", "as_fast_as_possible", "start", "again", "topics", "exclude", "live",
    ])]
    test: Vec<String>,
    /// With --test: override a value of the scenario, e.g. `processes.police_1.params.gain=2`
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "test")]
    set: Vec<String>,
    /// With --test: run all processes within this one
    #[arg(long, requires = "test")]
    in_process: bool,
    /// With --test: start external programs that the scenario names, without asking
    #[arg(long, requires = "test")]
    allow_external: bool,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Replays a log, or tests processes against it.
pub fn run(kinds: &[Kind], args: ReplayArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet.quiet, |watch| {
        if args.test.is_empty() {
            play(kinds, args, watch)
        } else {
            test(kinds, args, watch)
        }
    })
}

fn play(
    kinds: &[Kind],
    args: ReplayArgs,
    watch: &mut ReadProgress,
) -> Result<ExitCode, CommandError> {
    let rate = if args.as_fast_as_possible {
        f64::INFINITY
    } else {
        args.pace
    };
    let options = ReplayOptions {
        rate,
        start_s: args.part.span.start,
        end_s: args.part.span.end,
        again: args.again,
        topics: args.part.topics.into(),
        live: args.live.map(|port| LiveOptions {
            port,
            open: args.open,
            control: args.control.then_some(rate),
        }),
        quiet: args.quiet.quiet,
    };
    let done = replay::replay(&args.log, kinds, &options, watch)?;
    if let Some(live) = done.live {
        report_viewers(live, args.quiet.quiet);
    }
    if args.json.json {
        print_json(&serde_json::json!(done));
    } else {
        print(&played_text(&done));
    }
    logs::warn_of_faults(&args.log, &done.faults);
    let whole = !done.interrupted && done.faults.is_empty() && done.malformed == 0;
    Ok(if whole {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(EXIT_PARTIAL)
    })
}

fn test(
    kinds: &[Kind],
    args: ReplayArgs,
    watch: &mut ReadProgress,
) -> Result<ExitCode, CommandError> {
    let options = VerifyOptions {
        processes: args.test,
        changes: args.set,
        end_s: args.part.span.end,
        in_process: args.in_process,
        allow_external: args.allow_external,
        quiet: args.quiet.quiet,
    };
    let done = verify(&args.log, kinds, &options, watch)?;
    logs::note_version(done.recorded_by.as_deref(), args.quiet.quiet);
    if args.json.json {
        print_json(&serde_json::json!(done));
    } else {
        print(&verified_text(&done));
    }
    logs::warn_of_faults(&args.log, &done.faults);
    Ok(logs::of_comparison(done.identical, done.whole))
}

/// Returns the result as text.
fn played_text(done: &ReplayReport) -> String {
    let mut text = format!(
        "{}: {} ticks in {:.2} s\nmessages  {} ({} latched before the start)",
        done.scenario,
        done.ticks,
        done.wall_time_s,
        done.message_counts(),
        done.restored,
    );
    if done.malformed > 0 {
        text += &format!(
            "\nskipped   {} messages that do not match their topic",
            done.malformed
        );
    }
    text
}

/// Returns the result of a test as text.
fn verified_text(done: &VerificationReport) -> String {
    let mut text = format!(
        "{}: {} against {} ticks of the log in {:.2} s\n",
        done.scenario,
        done.processes.join(", "),
        done.ticks,
        done.wall_time_s
    );
    if !done.helpers.is_empty() {
        text += &format!("started   {} as well\n", done.helpers.join(", "));
    }
    for (topic, verdict) in &done.comparison.topics {
        text += &format!(
            "{topic}: {} messages in the log, {} now, {} identical\n",
            verdict.a, verdict.b, verdict.equal
        );
        for (field, deviation) in &verdict.fields {
            text += &format!(
                "    {field}: {} values from tick {} on, max {:.4e}, mean {:.4e}\n",
                deviation.values, deviation.first_tick, deviation.max, deviation.mean
            );
        }
    }
    text += &match &done.comparison.first {
        None if done.whole => "result    IDENTICAL".to_owned(),
        None => match &done.left {
            Some(left) => format!(
                "result    identical up to the failure: {} {} in tick {}, later ticks are not compared",
                left.process, left.reason, left.tick
            ),
            None => "result    identical up to the end of the incomplete log".to_owned(),
        },
        Some(_) => difference_lines("result", &done.comparison).join("\n"),
    };
    text
}
