//! `protean replay`.

use std::path::PathBuf;
use std::process::ExitCode;

use mcap_log::ReadProgress;
use platform::eprintln;

use super::logs::{self, CommandError, PartArgs};
use super::output::{EXIT_PARTIAL, print, print_json};
use super::run::tell_of_viewers;
use super::run_args::DEFAULT_PORT;
use log_tools::TopicComparison;
use replay::{ReplayOptions, Replayed, Verified, VerifyOptions, verify};
use scenario::kind::Kind;

/// What stands below the options.
pub(super) const HELP: &str = "\
Plays a log into a run of its own, whose root and prefix are said on stderr: viewers and processes join it
as they join any run. Stamps are those of the log, byte for byte;
messages of one tick go out together, the time between ticks is simulated time divided by the rate. What
lasts (map, state…) is sent first, as it was before the start, and whoever comes late gets it. The time is
in every stamp; run/control says what the replay does (1 plays, 4 ends; rate). A
reader that does not make room holds the replay back, and ends it after 10 s: nothing is dropped.

With --live the same goes to Foxglove and Lichtblick, with the pictures of the log, at the replay's rate. A
viewer that does not keep up misses messages; it never holds the replay back.

With --test, processes of the log's scenario are started, or opened with --in-process, and given in
lock-step what they heard in the run; what they say is compared with what they said. Processes under test
hear each other; everybody else is played. What a process said before its first failure in the run is
compared. With --set their parameters change, and the report says where that shows first and by how much
fields differ.

Exit codes: 0 played, or the same; 1 not the same, or a process or the replay failed; 2 wrong usage, or a
log that cannot be used; 3 ended before its end, or the log is not whole: what is missing is said.";

/// What `protean replay` takes.
#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub(super) struct ReplayArgs {
    /// A log
    log: PathBuf,
    /// Play it this many times as fast as it was recorded
    #[arg(long, value_name = "FACTOR", default_value = "1")]
    rate: f64,
    /// Play it as fast as those who read allow, losing nothing
    #[arg(long, conflicts_with = "rate")]
    as_fast_as_possible: bool,
    #[command(flatten)]
    part: PartArgs,
    /// Begin again at the end, until Ctrl-C
    #[arg(long = "loop")]
    again: bool,
    /// Show the replay live to Foxglove or Lichtblick: serves the topics of the log, the viewers'
    /// pictures included, on this port of 127.0.0.1, read-only, at an address with a secret that is
    /// printed (0: any free port)
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = DEFAULT_PORT)]
    live: Option<u16>,
    /// Test this process of the scenario against what it heard; may be given several times
    #[arg(long, value_name = "PROCESS", conflicts_with_all = [
        "rate", "as_fast_as_possible", "start", "again", "topics", "exclude", "live",
    ])]
    test: Vec<String>,
    /// With --test, override a value of the scenario: `processes.police_1.params.gain=2`
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "test")]
    set: Vec<String>,
    /// With --test, run the processes within this one
    #[arg(long, requires = "test")]
    in_process: bool,
    /// With --test, start programs that are not Protean's own
    #[arg(long, requires = "test")]
    allow_external: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Plays a log, or tests processes against it.
pub fn run(kinds: &[Kind], args: ReplayArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet, |watch| {
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
    let options = ReplayOptions {
        rate: if args.as_fast_as_possible {
            f64::INFINITY
        } else {
            args.rate
        },
        start_s: args.part.start,
        end_s: args.part.end,
        again: args.again,
        topics: args.part.topics.into(),
        live: args.live,
        quiet: args.quiet,
    };
    let done = replay::replay(&args.log, kinds, &options, watch)?;
    if let Some(live) = done.live {
        tell_of_viewers(live, args.quiet);
    }
    if args.json {
        print_json(&serde_json::json!(done));
    } else {
        print(&played_text(&done));
    }
    warn(&args.log, &done.faults);
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
        end_s: args.part.end,
        in_process: args.in_process,
        allow_external: args.allow_external,
        quiet: args.quiet,
    };
    let done = verify(&args.log, kinds, &options, watch)?;
    logs::note_version(done.recorded_by.as_deref());
    if args.json {
        print_json(&serde_json::json!(done));
    } else {
        print(&verified_text(&done));
    }
    warn(&args.log, &done.faults);
    Ok(logs::of_comparison(done.identical, done.whole))
}

fn warn(log: &std::path::Path, faults: &[String]) {
    for fault in faults {
        eprintln!("warning: {}: {fault}", log.display());
    }
}

/// The result for people.
fn played_text(done: &Replayed) -> String {
    let mut text = format!(
        "{}: {} messages ({} from before the start) of {} ticks in {:.2} s",
        done.scenario, done.messages, done.restored, done.ticks, done.wall_time_s
    );
    if done.malformed > 0 {
        text += &format!(
            "\nleft out  {} that are not messages of their topic",
            done.malformed
        );
    }
    text
}

/// The result of a test for people.
fn verified_text(done: &Verified) -> String {
    let mut text = format!(
        "{}: {} against {} ticks of the log in {:.2} s\n",
        done.scenario,
        done.processes.join(", "),
        done.ticks,
        done.wall_time_s
    );
    if !done.helpers.is_empty() {
        text += &format!("started   {} too\n", done.helpers.join(", "));
    }
    for (topic, verdict) in &done.comparison.topics {
        text += &format!(
            "{topic}: {} messages in the log, {} now, {} the same\n",
            verdict.recorded, verdict.now, verdict.equal
        );
        text += &fields_text(verdict);
    }
    text += &match done.first() {
        None if done.whole => "result    IDENTICAL".to_owned(),
        None => match &done.left {
            Some(left) => format!(
                "result    identical up to tick {}, at which {} {}; what came after is not compared",
                left.tick, left.process, left.reason
            ),
            None => {
                "result    identical as far as the log goes, which is not to its end".to_owned()
            }
        },
        Some((topic, first)) => {
            format!("result    DIFFERENT: {}", logs::difference(topic, first))
        }
    };
    text
}

fn fields_text(verdict: &TopicComparison) -> String {
    let mut text = String::new();
    if let Some(first) = &verdict.first {
        text += &format!(
            "    {} differ, the first at tick {}\n",
            first.messages, first.tick
        );
    }
    for (field, deviation) in &verdict.fields {
        text += &format!(
            "    {field}: {} values from tick {} on, max {:.4e}, mean {:.4e}\n",
            deviation.values, deviation.first_tick, deviation.max, deviation.mean
        );
    }
    text
}
