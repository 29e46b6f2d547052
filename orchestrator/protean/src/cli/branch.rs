//! `protean branch`.

use std::path::PathBuf;
use std::process::ExitCode;

use branch::{BranchReport, ContinuationOptions, Parent, RobotShares, continuations};
use mcap_log::LogReadError;
use platform::machine::processors;
use platform::output_format::OutputFormat;
use recorder::{outcome_words, time_text};
use replay::lineage::{ALL, Change};
use scenario::kind::Kind;
use tables::TerminalTable;

use super::common::{ExternalArg, ForceArg, JsonArg, QuietArg, out};
use super::comparison_text::difference_lines;
use super::logs;
use super::output::{print, print_json};

/// Help below the options.
pub(super) const HELP: &str = "\
Executes the run of the log again up to T, in one thread, verifies that every message before T is the one in the log, and goes
on with a change to the end of the mission. The new log names parent, T and change: `verify` executes it again, `diff` compares
it with its parent, and it can be branched itself. Without a change, the branch equals its parent.

A process that the change concerns has read the messages of the run from the first tick on, with its new parameters and
streams: its memory is that of this past. Its own messages count from T on.

  protean branch run.mcap --at 32 --set teams.police.limits.v_max=0.25
  protean branch run.mcap --at 32 --set processes.perception.params.filter.particles=300
  protean branch run.mcap --at 32 --replace pursuer_police_1=evader_potential
  protean branch run.mcap --at 32 --command police_1=0.2,0 --for 5
  protean branch run.mcap --at 32 --place police_1=1.2,3.4
  protean branch run.mcap --at 32 --times 40
  protean branch run.mcap --at 32 --times 40 --draw teams.police.limits.v_max=0.2..0.3

Exit codes: 0 success, 1 the history before T differs from the log or a run failed, 2 the log or the change is not usable,
3 interrupted.";

/// Change of a branch.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ChangeArgs {
    /// Override a value of the scenario from T on: parameters, limits, noise, rules
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Draw a value of the scenario by the number of the random streams
    #[arg(long, value_name = "KEY=LOW..HIGH")]
    draw: Vec<String>,
    /// Give a process another kind, with its default parameters
    #[arg(long, value_name = "PROCESS=KIND")]
    replace: Vec<String>,
    /// Give a robot this command (m/s, rad/s) in place of its planner's
    #[arg(long, value_name = "ROBOT=V,OMEGA", allow_hyphen_values = true)]
    command: Vec<String>,
    /// Move a robot at once (m, rad; without HEADING it keeps its own)
    #[arg(long, value_name = "ROBOT=X,Y[,HEADING]", allow_hyphen_values = true)]
    place: Vec<String>,
    /// Time for which the commands count (s) [default: to the end]
    #[arg(long = "for", value_name = "S", requires = "command")]
    for_s: Option<f64>,
    /// Give a process other random streams, or all processes
    #[arg(long, value_name = "PROCESS|all", value_delimiter = ',')]
    reseed: Vec<String>,
}

impl ChangeArgs {
    /// Returns the change with stream `seed`; many continuations vary all streams unless something that varies is named.
    pub(super) fn change(&self, seed: u64, are_many: bool) -> Change {
        let mut reseed = self.reseed.clone();
        if are_many && reseed.is_empty() && self.draw.is_empty() {
            reseed.push(ALL.to_owned());
        }
        Change {
            set: self.set.clone(),
            draw: self.draw.clone(),
            replace: self.replace.clone(),
            command: self.command.clone(),
            for_s: self.for_s,
            place: self.place.clone(),
            reseed,
            seed,
        }
    }
}

/// Arguments of `protean branch`.
#[derive(Debug, clap::Args)]
pub(super) struct BranchArgs {
    /// Log file of a run in lock-step
    log: PathBuf,
    /// Simulated time from which on the change counts (s), a multiple of the tick period
    #[arg(long, value_name = "T")]
    at: f64,
    #[command(flatten)]
    change: ChangeArgs,
    /// Number of the other random streams
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Continue N times, with streams 1 to N, and count the outcomes [--reseed: all, unless --draw]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000), conflicts_with_all = ["seed", "out"])]
    times: Option<u64>,
    /// Run N continuations at once [default: number of processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096), requires = "times")]
    jobs: Option<u16>,
    /// Keep the logs of the continuations in DIR
    #[arg(long, value_name = "DIR", requires = "times")]
    keep_logs: Option<PathBuf>,
    /// Write the log to FILE [default: LOG-branch-T.mcap]
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Branches the run of a log.
pub(super) fn run(kinds: &[Kind], args: &BranchArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet.quiet, |watch| {
        let allow_external = args.external.allow_external;
        let parent = Parent::read(&args.log, kinds, allow_external, watch)?;
        let tick = parent.tick(args.at)?;
        let change = args.change.change(args.seed, args.times.is_some());
        let Some(times) = args.times else {
            let out = args.out.as_deref();
            let done = parent.branch(tick, &change, out, args.force.force, watch)?;
            if args.json.json {
                print_json(&serde_json::json!(done));
            } else {
                print(&text(&done));
            }
            return Ok(logs::of_comparison(done.same, true));
        };
        if let Some(folder) = &args.keep_logs {
            std::fs::create_dir_all(folder).map_err(|source| {
                LogReadError::Argument(format!("{}: cannot be created: {source}", folder.display()))
            })?;
        }
        let options = ContinuationOptions {
            jobs: args.jobs.map_or_else(processors, usize::from),
            logs: args.keep_logs.clone(),
            force: args.force.force,
        };
        let robots = continuations(&parent, tick, &change, times, &options, watch)?;
        if args.json.json {
            let at_s = args.at;
            print_json(&serde_json::json!({
                "at_s": at_s, "change": change, "continuations": times, "robots": robots,
            }));
        } else {
            print(&shares_text(&robots));
        }
        Ok(ExitCode::SUCCESS)
    })
}

fn text(done: &BranchReport) -> String {
    let at = time_text(done.point.at_s);
    let mut lines = vec![format!(
        "{} (seed {}), branch from {at} s on",
        done.scenario, done.seed
    )];
    if !done.same {
        lines.extend(difference_lines("before", &done.comparison));
        return lines.join("\n");
    }
    lines.push(format!(
        "before     {} messages, identical to {}",
        done.messages, done.point.parent
    ));
    lines.push(format!("outcome    {}", outcome_words(&done.robots, None)));
    lines.push(format!("digest     {}", done.branch_digest));
    lines.push(format!("log        {}", done.log.display()));
    lines.join("\n")
}

fn shares_text(robots: &[RobotShares]) -> String {
    let columns = [
        "robot",
        "recorded",
        "outcome",
        "continuations",
        "share",
        "95 % interval",
    ];
    let mut table = TerminalTable::new(columns.map(|name| (name, 0)), 3);
    for robot in robots {
        for share in &robot.outcomes {
            table.add_row([
                robot.robot.clone(),
                robot.recorded.clone(),
                share.outcome.clone(),
                share.count.to_string(),
                format!("{:.3}", share.share),
                format!("{:.3} to {:.3}", share.interval.low, share.interval.high),
            ]);
        }
    }
    table.to_string()
}
