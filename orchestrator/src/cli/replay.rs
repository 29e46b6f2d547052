//! `protean replay`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::logs::{self, TopicArgs};
use super::{EXIT_PARTIAL, print, print_json};
use crate::logs::{ReplayOptions, Replayed, replay};

/// What stands below the options.
pub(super) const HELP: &str = "\
TODO";

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
    /// From this simulated time on [s]
    #[arg(long, value_name = "T")]
    start: Option<f64>,
    /// Up to this simulated time [s]
    #[arg(long, value_name = "T")]
    end: Option<f64>,
    /// Begin again at the end, until Ctrl-C
    #[arg(long = "loop")]
    again: bool,
    #[command(flatten)]
    topics: TopicArgs,
    /// Wait at the start until space (play) or `s` (one tick) is pressed
    #[arg(long)]
    paused: bool,
    /// Renew the clocks in the stamps, as if everything were sent now; everything else stays
    #[arg(long)]
    restamp: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Plays a log.
pub fn run(args: ReplayArgs) -> ExitCode {
    kit::logging::start("warn");
    let options = ReplayOptions {
        rate: if args.as_fast_as_possible {
            f64::INFINITY
        } else {
            args.rate
        },
        start_s: args.start,
        end_s: args.end,
        again: args.again,
        topics: args.topics.into(),
        paused: args.paused,
        restamp: args.restamp,
        quiet: args.quiet,
    };
    logs::command(args.quiet, |watch| {
        let done = replay(&args.log, &options, watch)?;
        if args.json {
            print_json(&serde_json::json!(done));
        } else {
            print(&text(&done));
        }
        for fault in &done.faults {
            eprintln!("warning: {}: {fault}", args.log.display());
        }
        let whole = !done.interrupted && done.faults.is_empty() && done.malformed == 0;
        Ok(if whole {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(EXIT_PARTIAL)
        })
    })
}

/// The result for people.
fn text(done: &Replayed) -> String {
    let mut text = format!(
        "{}: {} messages ({} from before the start) of {} ticks in {:.2} s",
        done.scenario, done.messages, done.restored, done.ticks, done.wall_time_s
    );
    if let (Some(jitter), Some(late)) = (done.jitter_us, done.lateness_us) {
        text += &format!(
            "\njitter    p50 {:.0} µs, p99 {:.0} µs, max {:.0} µs between messages; p99 {:.0} µs late",
            jitter.p50, jitter.p99, jitter.max, late.p99
        );
    }
    if done.malformed > 0 {
        text += &format!("\nleft out  {} that are not messages of their topic", done.malformed);
    }
    text
}
