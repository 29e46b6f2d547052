//! `protean patrol`.

use std::process::ExitCode;

use chaotic_maps::Key;
use clap::Subcommand;
use serde_json::{Value as Json, json};

use super::common::JsonArg;
use super::output::{EXIT_INVALID, print, print_error, print_json};
use super::run_args::OverrideArgs;
use plan::routes::RouteError;
use plan::routes::patrol::{Laps, Patrol, kind_name, waypoint_json};
use scenario::Loader;
use scenario::kind::Kind;

/// Scenario when the command line names none.
const DEFAULT: &str = "patrol_octagon";

/// Subcommands of `protean patrol`.
#[derive(Debug, Subcommand)]
pub(super) enum PatrolCommand {
    /// Print and measure the waypoints of the first laps
    Plan {
        #[command(flatten)]
        which: PatrolArgs,
        /// Number of laps
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
        laps: u32,
        #[command(flatten)]
        json: JsonArg,
    },
    /// Predict the position of the patrol from its key
    #[command(after_long_help = PREDICT_HELP)]
    Predict {
        #[command(flatten)]
        which: PatrolArgs,
        /// Time since the robot left the start of the contour (s) (repeatable)
        #[arg(long, value_name = "T", required_unless_present = "waypoint")]
        at: Vec<f64>,
        /// Number of a waypoint; 0 is the start (repeatable)
        #[arg(long, value_name = "N")]
        waypoint: Vec<u64>,
        #[command(flatten)]
        json: JsonArg,
    },
}

/// Help below the options.
const PREDICT_HELP: &str = "\
A key is a generator and its state in one word: catp:0.4,0.644, cat64:1,2, catf64:0.4,0.644, keyed:<64 hexadecimal
digits>. Waypoints are exact at any distance in the future. Times follow the schedule of the waypoints: every stretch
between two waypoints takes the same time (about 1 s, so that laps end within t_max). The schedule starts when the robot
leaves the start of the contour; if it stands there, at the start of the run. A robot with pace = \"clock\" (the default)
follows the schedule within the limits of its drive and of obstacles: after a long stretch it is late and catches up.";

/// Selection of a patrol.
#[derive(Debug, clap::Args)]
pub(super) struct PatrolArgs {
    /// Scenario file, or name of a built-in scenario (see `protean list`)
    #[arg(default_value = DEFAULT)]
    scenario: String,
    /// Process of the scenario; required if several patrol
    #[arg(long, value_name = "NAME")]
    process: Option<String>,
    /// Key [default: the scenario's]
    #[arg(long, value_name = "KEY")]
    key: Option<Key>,
    #[command(flatten)]
    overrides: OverrideArgs,
}

/// Runs `protean patrol`.
pub(super) fn patrol(kinds: &[Kind], command: PatrolCommand) -> ExitCode {
    let done = match command {
        PatrolCommand::Plan { which, laps, json } => plan(kinds, &which, laps, json.json),
        PatrolCommand::Predict {
            which,
            at,
            waypoint,
            json,
        } => predict(kinds, &which, &at, &waypoint, json.json),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            print_error(&*error);
            ExitCode::from(EXIT_INVALID)
        }
    }
}

fn find(kinds: &[Kind], which: &PatrolArgs) -> Result<Patrol, Box<dyn std::error::Error>> {
    let scenario = Loader::new(kinds)
        .allow_outside(which.overrides.allow_outside)
        .load(&which.scenario, &which.overrides.set, which.overrides.seed)?;
    let patrol = Patrol::of(&scenario, which.process.as_deref(), which.key)?;
    Ok(patrol)
}

fn plan(
    kinds: &[Kind],
    which: &PatrolArgs,
    count: u32,
    as_json: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let patrol = find(kinds, which)?;
    let laps = patrol.laps(count)?;
    if as_json {
        let mut json = patrol.json();
        json["waypoints"] = laps.waypoints.iter().map(waypoint_json).collect();
        json["metrics"] = laps.metrics_json();
        print_json(&json);
    } else {
        print(&plan_text(&patrol, &laps));
    }
    Ok(())
}

fn plan_text(patrol: &Patrol, laps: &Laps) -> String {
    let mut text = format!(
        "{}: {}, key {}, α = {:.3} m ({}), t_max = {} s\n",
        patrol.process,
        patrol.robot,
        patrol.key(),
        patrol.alpha(),
        patrol.alpha_choice().reason(),
        patrol.t_max(),
    );
    for warning in &patrol.warnings {
        text += &format!("warning: {warning}\n");
    }
    text.push('\n');
    text += "  number  lap  kind            x (m)     y (m)\n";
    for waypoint in &laps.waypoints {
        text += &format!(
            "{:8}  {:3}  {:10}  {:9.4} {:9.4}\n",
            waypoint.number,
            waypoint.lap,
            kind_name(waypoint.kind),
            waypoint.point.x,
            waypoint.point.y,
        );
    }
    if let Some(m) = &laps.metrics {
        text += &format!(
            "\nlap: {:.2} m, speed {:.4} m/s\n\
             MAE {:.4} m by time ({:.4} m by length), ANDC {:.4} /s\n\
             MAA {:.4} rad ({:.4} rad folded), RA [{:.3}, {:.3}] rad",
            m.length_mean,
            m.speed_mean,
            m.mae_time,
            m.mae_lap,
            m.andc,
            m.turns.maa,
            m.turns.maa_fold,
            m.turns.range[0],
            m.turns.range[1],
        );
    }
    text
}

fn predict(
    kinds: &[Kind],
    which: &PatrolArgs,
    times: &[f64],
    numbers: &[u64],
    as_json: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let patrol = find(kinds, which)?;
    let mut places = Vec::new();
    for &time in times {
        places.push((time, patrol.at(time)?));
    }
    let waypoints = numbers
        .iter()
        .map(|&number| patrol.waypoint(number))
        .collect::<Result<Vec<_>, RouteError>>()?;
    if as_json {
        let mut json = patrol.json();
        json["at"] = places
            .iter()
            .map(|(time, place)| {
                json!({
                    "t": time,
                    "x": place.point.x,
                    "y": place.point.y,
                    "from": waypoint_json(&place.from),
                    "to": waypoint_json(&place.to),
                })
            })
            .collect::<Json>();
        json["waypoints"] = waypoints.iter().map(waypoint_json).collect();
        print_json(&json);
        return Ok(());
    }
    let mut lines = Vec::new();
    for (time, place) in &places {
        lines.push(format!(
            "{time} s: ({:.4}, {:.4}) m, between waypoint {} and waypoint {} of lap {} at ({:.4}, {:.4}) m",
            place.point.x,
            place.point.y,
            place.from.number,
            place.to.number,
            place.to.lap,
            place.to.point.x,
            place.to.point.y,
        ));
    }
    for waypoint in &waypoints {
        lines.push(format!(
            "waypoint {}: ({:.4}, {:.4}) m, lap {}, {}",
            waypoint.number,
            waypoint.point.x,
            waypoint.point.y,
            waypoint.lap,
            kind_name(waypoint.kind),
        ));
    }
    print(&lines.join("\n"));
    Ok(())
}
