//! `protean soak`.

use std::fs::File;
use std::io::{IsTerminal as _, Seek as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::run::handle_signals;
use super::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, OverrideArgs, complain, print, print_json};
use crate::scenario::spec::Mode;
use crate::scenario::{self, Loader, ResolvedScenario};
use crate::soak::mission::Mission;
use crate::soak::rows::RowWriter;
use crate::soak::{SoakOptions, SoakReport, growth, picture, rows, soak, table};
use crate::{atomic_file, figures};

/// Name of the file with the rows.
const ROWS: &str = "soak.csv";

/// What stands below the options.
pub(super) const HELP: &str = "\
Missions run one after the other, the same ones again and again in an order that the seed draws, without
keeping their logs. Meanwhile every process is looked at twenty times a second, from outside: memory of its
own, descriptors, shared memory; once more when time has ended; after every mission, what it left behind.
The first quarter of the time is for warming up; then the first half of the rest is compared with the second. Of processes that run for
10 s or more (missions by the clock, with --real-time), memory late in their lives is compared with memory early.

Flat means: no memory grew, in all three quartiles, by more than 1 % and 64 KiB over the soak, no descriptors
or pieces of shared memory were added, nothing was left behind, every mission ended as it should, with the digest it had before.

--read FILE judges the rows of an earlier soak.
--out writes DIR/soak.csv (a row per mission and process, as they end) and DIR/soak.svg.

Exit codes: 0 flat, 1 not flat, 2 wrong usage or scenario, 3 ended by Ctrl-C before its time.";

/// What `protean soak` takes.
#[derive(Debug, clap::Args)]
pub(super) struct SoakArgs {
    /// Scenario files or names of built-in scenarios [default: all built-in ones that start no
    /// programs of others]
    #[arg(value_name = "SCENARIO")]
    scenarios: Vec<String>,
    /// How long missions are begun [min]
    #[arg(long, short, value_name = "M", default_value_t = 5.0)]
    minutes: f64,
    /// Seeds per scenario, from the scenario's own upwards
    #[arg(long, value_name = "N", default_value_t = 2)]
    seeds: u64,
    /// Fly every mission by the clock too, FACTOR times as fast as reality
    #[arg(long, value_name = "FACTOR")]
    real_time: Option<f64>,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Let scenarios start programs that are not Protean's own
    #[arg(long)]
    allow_external: bool,
    /// Judge what an earlier soak saw, its soak.csv, and fly nothing
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenarios", "minutes", "seeds", "real_time", "allow_external"])]
    read: Option<PathBuf>,
    /// Write rows and picture into this folder
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Soaks, and says whether everything stayed flat.
pub fn run(args: &SoakArgs) -> ExitCode {
    let flown = match &args.read {
        Some(rows) => read(rows),
        None => fly(args),
    };
    let report = match flown {
        Ok(report) => report,
        Err(code) => return code,
    };
    if let Some(folder) = &args.out
        && let Err(error) = write(&report, args.read.as_deref(), folder)
    {
        eprintln!("error: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    if args.json {
        print_json(&json!({
            "flat": report.is_flat(),
            "missions": report.missions.len(),
            "failures": report.failures,
            "leftovers": report.leftovers,
            "lasted_s": report.lasted_s,
            "interrupted": report.interrupted,
            "limits": { "share": growth::FLAT, "bytes": growth::PAGES },
            "growth": report.growth,
        }));
    } else {
        print(table::text(&report).trim_end());
    }
    if report.interrupted {
        ExitCode::from(EXIT_PARTIAL)
    } else if report.is_flat() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(EXIT_FAILED)
    }
}

/// Judges what was seen earlier; on stderr what is wrong with it.
fn read(path: &Path) -> Result<SoakReport, ExitCode> {
    let missions = File::open(path)
        .map_err(|e| e.to_string())
        .and_then(|file| rows::read(file).map_err(|e| e.to_string()))
        .and_then(|missions| match missions.len() {
            0 => Err("no missions in it".to_owned()),
            _ => Ok(missions),
        })
        .map_err(|error| {
            eprintln!(
                "error: {}: {error}; expected the soak.csv of a soak",
                path.display()
            );
            ExitCode::from(EXIT_INVALID)
        })?;
    let lasted_s = missions.last().map_or(0.0, |m| m.begun_s + m.lasted_s);
    Ok(SoakReport::of(missions, lasted_s, false))
}

/// Soaks.
fn fly(args: &SoakArgs) -> Result<SoakReport, ExitCode> {
    let missions = missions(args)?;
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return Err(ExitCode::from(EXIT_FAILED));
    }
    let options = SoakOptions {
        missions,
        duration: Duration::from_secs_f64(args.minutes * 60.0),
        seed: args.overrides.seed.unwrap_or(1),
        interrupted,
    };
    let (name, mut file) = rows_file(args.out.as_deref())?;
    let failed = |error: &dyn std::fmt::Display| {
        eprintln!("error: {name}: {error}");
        ExitCode::from(EXIT_FAILED)
    };
    let show = Show::new(args, options.duration);
    let mut rows = RowWriter::new(&mut file);
    let flown = soak(&options, &mut rows, |mission| show.mission(mission));
    drop(rows);
    show.bar.finish_and_clear();
    let flown = flown.map_err(|e| failed(&e))?;
    file.rewind().map_err(|e| failed(&e))?;
    let missions = rows::read(file).map_err(|e| failed(&e))?;
    Ok(SoakReport::of(missions, flown.lasted_s, flown.interrupted))
}

/// The file that rows go to while the soak goes on, and what it is called: in the folder that they are
/// wanted in, where a soak that is killed leaves them for `--read`; else one without a name.
fn rows_file(folder: Option<&Path>) -> Result<(String, File), ExitCode> {
    let path = folder.map_or_else(std::env::temp_dir, |folder| folder.join(ROWS));
    let made = match folder {
        None => tempfile::tempfile(),
        Some(folder) => std::fs::create_dir_all(folder).and_then(|()| {
            let mut options = File::options();
            let options = options.create(true).read(true).write(true).truncate(true);
            options.open(&path)
        }),
    };
    let name = path.display().to_string();
    made.map(|file| (name.clone(), file)).map_err(|error| {
        eprintln!("error: {name}: {error}");
        ExitCode::from(EXIT_FAILED)
    })
}

/// Every mission of the soak; on stderr what is wrong with the request.
fn missions(args: &SoakArgs) -> Result<Vec<ResolvedScenario>, ExitCode> {
    let invalid = |text: String| {
        eprintln!("error: {text}");
        ExitCode::from(EXIT_INVALID)
    };
    let wanted = |name: &str, value: f64, low: f64, high: f64| {
        (low..=high).contains(&value).then_some(()).ok_or_else(|| {
            invalid(format!(
                "{name} {value}: expected a number from {low} to {high}"
            ))
        })
    };
    wanted("--minutes", args.minutes, 0.001, 10_080.0)?;
    wanted("--seeds", args.seeds as f64, 1.0, 1000.0)?;
    if let Some(factor) = args.real_time {
        wanted("--real-time", factor, 0.001, 1000.0)?;
    }
    let all = args.scenarios.is_empty();
    let names: Vec<String> = if all {
        scenario::list().into_iter().map(|s| s.name).collect()
    } else {
        args.scenarios.clone()
    };
    let mut missions = Vec::new();
    for name in &names {
        let load = |seed| {
            Loader::default()
                .allow_outside(args.overrides.allow_outside)
                .load(name, &args.overrides.set, seed)
                .map_err(|problems| {
                    complain(&problems);
                    ExitCode::from(EXIT_INVALID)
                })
        };
        let first = load(args.overrides.seed)?;
        if first.uses_external_commands() && !args.allow_external {
            if all {
                continue;
            }
            return Err(invalid(format!(
                "{name} starts programs that are not Protean's own; look at them and add \
                 --allow-external"
            )));
        }
        for number in 0..args.seeds {
            let mission = load(Some(first.run.seed.wrapping_add(number)))?;
            if let Some(factor) = args.real_time {
                let mut by_clock = mission.clone();
                by_clock.name += " by the clock";
                by_clock.run.mode = Mode::RealTime;
                by_clock.run.real_time_factor = factor;
                missions.push(by_clock);
            }
            missions.push(mission);
        }
    }
    Ok(missions)
}

/// Writes the picture, and the rows if they stand elsewhere.
fn write(
    report: &SoakReport,
    rows: Option<&Path>,
    folder: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(rows) = rows {
        atomic_file::save(&std::fs::read(rows)?, &folder.join(ROWS))?;
    }
    let drawing = figures::draw(&picture::chart(&report.missions));
    atomic_file::save(drawing.svg().as_bytes(), &folder.join("soak.svg"))?;
    Ok(())
}

/// How far the soak is: a line that moves on a terminal, a plain line per mission elsewhere.
struct Show {
    bar: ProgressBar,
    plain: bool,
}

impl Show {
    fn new(args: &SoakArgs, duration: Duration) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = if args.quiet || !terminal {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(duration.as_secs())
        };
        // A template that does not parse would only cost the bar its looks.
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
            bar.set_style(style);
        }
        Self {
            bar,
            plain: !args.quiet && !terminal,
        }
    }

    fn mission(&self, mission: &Mission) {
        let at = mission.begun_s + mission.lasted_s;
        let how = match (&mission.failure, mission.leftovers.len()) {
            (Some(why), _) => format!("FAILED: {why}"),
            (None, 0) => "ok".to_owned(),
            (None, left) => format!("{left} things left behind"),
        };
        let line = format!(
            "{at:7.1} s  {} seed {} ({:.1} s): {how}",
            mission.scenario, mission.seed, mission.lasted_s
        );
        self.bar.set_position(at as u64);
        self.bar.set_message(line.clone());
        if self.plain || how != "ok" {
            self.bar.suspend(|| eprintln!("{line}"));
        }
    }
}
