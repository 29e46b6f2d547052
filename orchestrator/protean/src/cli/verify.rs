//! `protean verify`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::common::{ExternalArg, JsonArg, QuietArg};
use super::comparison_text::difference_lines;
use super::logs;
use super::output::{print, print_json};
use replay::{Rerun, RerunOptions, rerun};
use scenario::kind::Kind;

/// Help below the options.
pub const HELP: &str = "\
Runs the scenario, seed and events of the log again, and compares the digest and every message of the simulated history
(all topics but clocks and heartbeats). If the run was killed or interrupted, the new run ends with the log; if a process
failed, both end at the first failure.

Exit codes: 0 identical, 1 different (the output names the first tick that differs, the processes
that received the same inputs and answered otherwise, with field and values, and the topics) or the run failed, 2 the
run cannot be repeated, 3 identical up to the end of an incomplete log or the first failure of a process, more
in the file than the run; or interrupted.";

/// Arguments of `protean verify`.
#[derive(Debug, clap::Args)]
pub struct VerifyArgs {
    /// Log file of a run in lock-step
    log: PathBuf,
    /// Run all processes within this one
    #[arg(long)]
    in_process: bool,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Runs the scenario of a log again and compares every message.
pub fn run(kinds: &[Kind], args: &VerifyArgs) -> ExitCode {
    runtime::logging::start("warn");
    let options = RerunOptions {
        in_process: args.in_process,
        allow_external: args.external.allow_external,
        failures: false,
    };
    logs::command(args.quiet.quiet, |watch| {
        let done = rerun(&args.log, kinds, options, watch)?;
        logs::note_version(done.recorded_by.as_deref(), args.quiet.quiet);
        if args.json.json {
            print_json(&serde_json::json!(done));
        } else {
            print(&text(&done));
        }
        logs::warn_of_faults(&args.log, &done.faults);
        Ok(logs::of_comparison(done.same, done.whole))
    })
}

/// Returns the result as text.
fn text(done: &Rerun) -> String {
    let mut text = format!(
        "{} (seed {}): {} ticks in {:.2} s\n",
        done.scenario, done.seed, done.ticks, done.wall_time_s
    );
    match &done.digest_logged {
        Some(logged) if *logged == done.digest => {
            text += &format!("digest    {} in the log and now\n", done.digest);
        }
        Some(logged) => {
            text += &format!(
                "digest    {logged} in the log\n          {} now\n",
                done.digest
            );
        }
        None => text += "digest    none in the log\n",
    }
    let comparison = &done.comparison;
    let recorded: u64 = comparison.topics.values().map(|topic| topic.a).sum();
    let equal = comparison.equal();
    text += &format!("messages  {recorded} simulated, {equal} of them identical\n");
    match &comparison.first {
        None if done.same && done.whole => text += "result    identical",
        None if done.same && done.digest_logged.is_some() => {
            text += "result    identical; the file contains more than this run";
        }
        None if done.same => {
            text += &match &done.left {
                Some(left) => format!(
                    "result    identical up to the failure: process {} {} in tick {}, later ticks are not \
                     compared",
                    left.process, left.reason, left.tick
                ),
                None => format!(
                    "result    identical up to tick {}, the last tick in the log",
                    comparison.last_tick
                ),
            };
        }
        None => text += "result    DIFFERENT: the digest in the log does not match its messages",
        Some(_) => text += &difference_lines("result", comparison).join("\n"),
    }
    text.trim_end().to_owned()
}
