//! `protean run`.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use config::Diagnostics;
use platform::eprintln;
use viewer::{LiveOptions, LiveTotals};

use super::output::{
    EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, exit_code_of_mission, print_coloured, print_json,
};
use super::run_args::RunArgs;
use super::run_summary;
use mission::in_process::{self, InProcessOptions};
use mission::{self, AskError, MissionError, MissionOptions, MissionReport};
pub(super) use platform::signals::interrupt as handle_signals;
use scenario::kind::Kind;
use scenario::spec::Mode;
use scenario::{Loader, ResolvedScenario, ScenarioRemark, remark_lines};

/// Levels that `--log-level` takes.
const LEVELS: [&str; 5] = ["error", "warn", "info", "debug", "trace"];

/// Loads, checks and runs a scenario.
pub fn run(kinds: &[Kind], target: &str, args: &RunArgs) -> ExitCode {
    runtime::logging::start(&args.log_level);
    let scenario = match load(kinds, target, args) {
        Ok(scenario) => scenario,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(EXIT_INVALID);
        }
    };
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    let remarks = scenario.remarks();
    if !args.quiet.quiet {
        for warning in remark_lines(remarks.iter().filter(|remark| remark.is_warning())) {
            eprintln!("{warning}");
        }
    }
    match execute(&scenario, args, remarks.clone(), interrupted) {
        Ok(report) => {
            if let Some(live) = report.live {
                report_viewers(live, args.quiet.quiet);
            }
            if args.json.json {
                print_json(&report.json(&scenario, &remarks));
            } else {
                let text = if args.quiet.quiet {
                    run_summary::short(&report)
                } else {
                    run_summary::text(&scenario, &remarks, &report, args.latency)
                };
                print_coloured(&text, mission::team_colours(&scenario));
            }
            let lost = report.summary.topics.values().any(|topic| topic.gaps > 0);
            if report.interrupted || report.has_failures || lost {
                ExitCode::from(EXIT_PARTIAL)
            } else {
                ExitCode::SUCCESS
            }
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(exit_code_of_mission(&error))
        }
    }
}

fn execute(
    scenario: &ResolvedScenario,
    args: &RunArgs,
    remarks: Vec<ScenarioRemark>,
    interrupted: Arc<AtomicBool>,
) -> Result<MissionReport, MissionError> {
    if args.in_process {
        let options = InProcessOptions {
            out: args.out.clone(),
            force: args.force.force,
            show: !args.quiet.quiet,
            remarks,
            interrupted,
            external: true,
            ..InProcessOptions::default()
        };
        return in_process::run(scenario, &options);
    }
    let lock_step = scenario.run.mode == Mode::LockStep;
    // Without a pace, a run would end before a viewer shows it.
    let pace = args.pace.or(args.live.map(|_| 1.0)).filter(|_| lock_step);
    let options = MissionOptions {
        out: args.out.clone(),
        force: args.force.force,
        without_log: false,
        quiet: args.quiet.quiet,
        log_level: args.log_level.clone(),
        live: args.live.map(|port| LiveOptions {
            port,
            open: args.open,
            control: pace.filter(|_| args.control),
        }),
        pace,
        remarks,
        interrupted,
        last_tick: None,
    };
    mission::run(scenario, &options)
}

/// Prints the totals of live viewers to stderr.
pub fn report_viewers(live: LiveTotals, quiet: bool) {
    if !quiet || live.left_out + live.cut_off > 0 {
        eprintln!(
            "live: {} viewers, {} messages sent, {} dropped for slow viewers, {} viewers disconnected",
            live.viewers, live.messages, live.left_out, live.cut_off
        );
    }
}

/// Reason why a scenario is not run, as printed.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    #[error(transparent)]
    Scenario(#[from] Diagnostics),
    #[error("error: {option} {value}: expected {expected}")]
    Option {
        option: &'static str,
        value: String,
        expected: String,
    },
    #[error(
        "error: {target} starts external programs; check them, then add --allow-external:{programs}"
    )]
    External { target: String, programs: String },
    #[error("error: {0}")]
    Ask(#[from] AskError),
}

impl LoadError {
    pub(super) fn option(
        option: &'static str,
        value: &impl ToString,
        expected: impl Into<String>,
    ) -> Self {
        Self::Option {
            option,
            value: value.to_string(),
            expected: expected.into(),
        }
    }
}

fn load(kinds: &[Kind], target: &str, args: &RunArgs) -> Result<ResolvedScenario, LoadError> {
    if !LEVELS.contains(&args.log_level.as_str()) {
        let expected = format!("one of {}", LEVELS.join(", "));
        return Err(LoadError::option("--log-level", &args.log_level, expected));
    }
    check_factor("--pace", args.pace)?;
    let set = with_real_time(&args.overrides.set, args.real_time)?;
    let loader = Loader::new(kinds).allow_outside(args.overrides.allow_outside);
    let load = |set: &[String]| loader.load(target, set, args.overrides.seed);
    let scenario = load(&set)?;
    if args.control && scenario.run.mode == Mode::RealTime {
        let option = "--control with run.mode";
        return Err(LoadError::option(option, &"real_time", "lock_step"));
    }
    refuse_external(target, &scenario, args.external.allow_external)?;
    asked(scenario, &set, load)
}

/// Asks the external programs for their declarations, which the user has permitted, and loads the scenario with them.
pub fn asked(
    scenario: ResolvedScenario,
    set: &[String],
    load: impl Fn(&[String]) -> Result<ResolvedScenario, Diagnostics>,
) -> Result<ResolvedScenario, LoadError> {
    let declared = mission::ask(&scenario)?;
    if declared.is_empty() {
        return Ok(scenario);
    }
    Ok(load(&[set, &declared].concat())?)
}

/// Returns the overrides of `--set` and those that `--real-time` adds.
fn with_real_time(set: &[String], factor: Option<f64>) -> Result<Vec<String>, LoadError> {
    check_factor("--real-time", factor)?;
    let mut set = set.to_vec();
    if let Some(factor) = factor {
        set.push("run.mode=real_time".to_owned());
        set.push(format!("run.real_time_factor={factor:?}"));
    }
    Ok(set)
}

fn check_factor(option: &'static str, factor: Option<f64>) -> Result<(), LoadError> {
    match factor {
        Some(factor) if !(0.001..=1000.0).contains(&factor) => Err(LoadError::option(
            option,
            &factor,
            "a factor from 0.001 to 1000",
        )),
        _ => Ok(()),
    }
}

/// Refuses a scenario with external programs, unless they are allowed or the user at the terminal agrees.
pub fn refuse_external(
    target: &str,
    scenario: &ResolvedScenario,
    allowed: bool,
) -> Result<(), LoadError> {
    if scenario.uses_external_commands() && !allowed {
        let mut programs = String::new();
        for process in scenario.external_commands() {
            let line = process.program.command_line().unwrap_or_default();
            programs.push_str(&format!("\n    {}: {line}", process.name));
        }
        let what = format!("{target} starts external programs");
        if !agreed(&format!("{what}:{programs}\nStart them? [y/N]")) {
            let target = target.to_owned();
            return Err(LoadError::External { target, programs });
        }
    }
    Ok(())
}

/// Asks the user at the terminal; returns `false` without a terminal.
fn agreed(question: &str) -> bool {
    use std::io::IsTerminal as _;
    let mut answer = String::new();
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return false;
    }
    eprintln!("{question}");
    // An answer that cannot be read counts as no.
    let _ = std::io::stdin().read_line(&mut answer);
    matches!(answer.trim(), "y" | "Y" | "yes" | "Yes")
}
