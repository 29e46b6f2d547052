//! `protean import`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::eprintln;
use platform::output_format::OutputFormat;
use replay::import::{ImportOptions, import};
use scenario::Loader;
use scenario::kind::Kind;

use super::common::{ExternalArg, ForceArg, JsonArg, QuietArg, out};
use super::logs::{self, CommandError};
use super::output::{EXIT_PARTIAL, print_coloured, print_json};
use super::run::refuse_external;
use super::run_args::OverrideArgs;
use super::run_summary;

/// Help below the options.
pub(super) const HELP: &str = "\
Runs a scenario in which robots are where a bag of ROS 2 has them, with the scans and on the map of the bag. The log has the
answers of all processes, so that `protean replay LOG --test PROCESS` tests another build or other parameters on them.

BAG is an MCAP file, or the folder that rosbag2 writes. Robot NAME is in /NAME/odom (nav_msgs/Odometry) and /NAME/scan
(sensor_msgs/LaserScan), the only robot of a scenario in /odom and /scan, too; the map is the last one in /map
(nav_msgs/OccupancyGrid). /tf and /tf_static, or those of a namespace, place odometry in the map. Robots that the bag
does not have are simulated. Each tick takes the message nearest to it.

  protean import bag/ mission.toml --out field.mcap
  protean import bag/ mission.toml --topic guard/odom=/tb3_0/odometry/filtered --out field.mcap
  protean replay field.mcap --test guard --set processes.guard.params.gain=2

Exit codes: 0 success, 1 the run failed, 2 the bag, the scenario or the arguments are unusable, 3 interrupted, or the bag
is damaged (stderr lists what is missing).";

/// Arguments of `protean import`.
#[derive(Debug, clap::Args)]
pub(super) struct ImportArgs {
    /// Bag of ROS 2: an MCAP file, or its folder
    bag: PathBuf,
    /// Scenario file, or name of a built-in scenario
    scenario: String,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Take ROBOT/odom, ROBOT/scan or map from this topic (repeatable)
    #[arg(long, value_name = "NAME=TOPIC")]
    topic: Vec<String>,
    /// Largest time between a tick and its message (s)
    #[arg(long, value_name = "S", default_value_t = 0.5)]
    max_age: f64,
    /// Write the log to FILE
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    external: ExternalArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Imports a bag.
pub(super) fn run(kinds: &[Kind], args: ImportArgs) -> ExitCode {
    runtime::logging::start("warn");
    logs::command(args.quiet.quiet, |watch| {
        let usage = |text: String| {
            CommandError::Usage(text.strip_prefix("error: ").unwrap_or(&text).to_owned())
        };
        let OverrideArgs {
            seed,
            set,
            allow_outside,
        } = &args.overrides;
        let loader = Loader::new(kinds).allow_outside(*allow_outside);
        let scenario = loader.load(&args.scenario, set, *seed);
        let scenario = scenario.map_err(|problems| usage(problems.to_string()))?;
        refuse_external(&args.scenario, &scenario, args.external.allow_external)
            .map_err(|error| usage(error.to_string()))?;
        let options = ImportOptions {
            topics: args.topic,
            max_age_s: args.max_age,
            out: args.out,
            force: args.force.force,
        };
        let (scenario, done, report) = import(&args.bag, &scenario, kinds, &options, watch)?;
        if args.json.json {
            let mut json = report.json(&scenario, &[]);
            json["import"] = serde_json::json!(done);
            print_json(&json);
        } else {
            let mut text = run_summary::text(&scenario, &[], &report, false);
            for (name, (topic, messages)) in &done.topics {
                text += &format!("\nimported  {name}: {messages} messages of {topic}");
            }
            print_coloured(&text, mission::team_colours(&scenario));
        }
        for remark in done.remarks.iter().filter(|_| !args.quiet.quiet) {
            eprintln!("warning: {remark}");
        }
        if report.summary.ticks < done.last_tick && !report.interrupted {
            eprintln!(
                "warning: the rules ended the run at tick {}, the bag has {}: --set rules.time_limit=S permits more",
                report.summary.ticks, done.last_tick
            );
        }
        logs::warn_of_faults(&args.bag, &done.faults);
        let is_whole = done.faults.is_empty() && !report.interrupted;
        Ok(if is_whole {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(EXIT_PARTIAL)
        })
    })
}
