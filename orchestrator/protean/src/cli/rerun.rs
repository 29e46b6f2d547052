//! `protean rerun`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::logs;
use super::output::{print, print_json};
use replay::{Rerun, RerunOptions, rerun};
use scenario::kind::Kind;

/// What stands below the options.
pub(super) const HELP: &str = "\
The run is done again from the scenario, seed and events in the log, and every message of the simulated
history (everything but clocks and heartbeats) is compared, as is the digest. Of a run that was killed or
interrupted, what the log holds is compared; of one in which a process failed, what was said before that.

Exit codes: 0 the same, message by message and digest; 1 not the same: the first difference of every topic
is said; or the run failed; 2 the run in the log cannot be done again: why, is said; 3 the same as far
as the log goes, but it does not go to the end of its run, or up to the first failure of a process; or
interrupted.";

/// What `protean rerun` takes.
#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub(super) struct RerunArgs {
    /// A log of a run in lock-step
    log: PathBuf,
    /// Run everything in this process instead of one per robot
    #[arg(long)]
    in_process: bool,
    /// Let the scenario start programs that are not Protean's own
    #[arg(long)]
    allow_external: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Does a run again and compares.
pub fn run(kinds: &[Kind], args: &RerunArgs) -> ExitCode {
    runtime::logging::start("warn");
    let options = RerunOptions {
        in_process: args.in_process,
        allow_external: args.allow_external,
    };
    logs::command(args.quiet, |watch| {
        let done = rerun(&args.log, kinds, options, watch)?;
        logs::note_version(done.recorded_by.as_deref());
        if args.json {
            print_json(&serde_json::json!(done));
        } else {
            print(&text(&done));
        }
        Ok(logs::of_comparison(done.same, done.whole))
    })
}

/// The result for people.
fn text(done: &Rerun) -> String {
    let mut text = format!(
        "{} (seed {}): {} ticks in {:.2} s\n",
        done.scenario, done.seed, done.ticks, done.wall_time_s
    );
    match &done.digest_logged {
        Some(logged) if *logged == done.digest => {
            text += &format!("digest    {} in both\n", done.digest);
        }
        Some(logged) => {
            text += &format!(
                "digest    {logged} in the log\n          {} now\n",
                done.digest
            );
        }
        None => text += &format!("digest    none in the log, {} now\n", done.digest),
    }
    let Some(comparison) = &done.comparison else {
        text += "messages  not compared: the log holds a part of its run";
        return text;
    };
    text += &format!("messages  {} are the same\n", comparison.equal());
    match comparison.first() {
        None if done.same && done.whole => text += "result    the same",
        None if done.same => {
            text += &match &done.left {
                Some(left) => format!(
                    "result    the same up to tick {}, at which process {} {}; what came after is \
                     not compared",
                    left.tick, left.process, left.reason
                ),
                None => format!(
                    "result    the same up to tick {}, where the log ends before its run",
                    comparison.last_tick
                ),
            };
        }
        None => text += "result    NOT THE SAME: the digest in the log is not that of its messages",
        Some((topic, first)) => {
            text += &format!(
                "result    NOT THE SAME: they part at tick {} on {topic}\n",
                first.tick
            );
            for (topic, first) in comparison.differences() {
                text += &format!("          {}\n", logs::difference(topic, first));
            }
        }
    }
    text.trim_end().to_owned()
}
