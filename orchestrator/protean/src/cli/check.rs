//! `protean check`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mcap_log::derived::{self, DerivedError};
use mission::plan::Plan;
use platform::eprintln;
use platform::output_format::OutputFormat;
use report::picture::{RunTrace, draw, encoded};
use serde_json::json;

use super::common::{ForceArg, JsonArg, out};
use super::dataflow::Dataflow;
use super::logs::exit_code_of_derived;
use super::output::{self, EXIT_INVALID, print, print_json};
use super::run_args::OverrideArgs;
use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario, remark_lines};
use sweep::LoadOptions;

/// Arguments of `protean check`.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// Scenario file, or name of a built-in scenario (see `protean list`)
    scenario: String,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Print the scenario with all defaults and overrides filled in
    #[arg(long)]
    print: bool,
    /// Draw the world before it runs: write FILE (.svg, .png or .pdf)
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::PICTURE))]
    picture: Option<PathBuf>,
    /// Draw which processes write and read what: write FILE (.svg or .mmd, which is Mermaid)
    #[arg(long, value_name = "FILE", value_parser = out(OutputFormat::GRAPH))]
    graph: Option<PathBuf>,
    /// Start external programs that state their topics (`declaration = "ask"`)
    #[arg(long)]
    allow_external: bool,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
}

/// Checks a scenario and summarises it.
pub fn run(kinds: &'static [Kind], args: &CheckArgs) -> ExitCode {
    let (target, overrides) = (&args.scenario, &args.overrides);
    let loader = Loader::new(kinds).allow_outside(overrides.allow_outside);
    let mut loaded = loader.load(target, &overrides.set, overrides.seed);
    if loaded.is_ok()
        && let Ok(draft) = loader.draft(target)
        && draft.find("expect").is_some()
    {
        let options = LoadOptions {
            set: overrides.set.clone(),
            allow_outside: overrides.allow_outside,
            allow_external: true,
            ..LoadOptions::new(kinds)
        };
        if let Err(problems) = mission_tests::load(&[target.into()], "", &options) {
            loaded = Err(problems);
        }
    }
    if args.allow_external
        && let Ok(scenario) = &loaded
    {
        match mission::ask(scenario) {
            Ok(declared) => {
                let set = [&*overrides.set, &declared].concat();
                loaded = loader.load(target, &set, overrides.seed);
            }
            Err(problem) => {
                eprintln!("error: {problem}");
                return ExitCode::from(EXIT_INVALID);
            }
        }
    }
    if let (Ok(scenario), Some(file)) = (&loaded, &args.picture)
        && let Err(code) = write_picture(scenario, file, args.force.force)
    {
        return ExitCode::from(code);
    }
    if let (Ok(scenario), Some(file)) = (&loaded, &args.graph)
        && let Err(code) = write_graph(scenario, file, args.force.force)
    {
        return ExitCode::from(code);
    }
    match loaded {
        Ok(scenario) if args.print => {
            print(scenario.to_toml().trim_end());
            ExitCode::SUCCESS
        }
        Ok(scenario) if args.json.json => {
            print_json(&json!({
                "ok": true,
                "scenario": scenario.name,
                "seed": scenario.run.seed,
                "robots": scenario.world.robots.iter().map(|r| &r.name).collect::<Vec<_>>(),
                "processes": scenario.processes.iter().map(|p| &p.name).collect::<Vec<_>>(),
                "events": scenario.events.len(),
                "external_commands": scenario.uses_external_commands(),
                "remarks": scenario.remarks(),
            }));
            ExitCode::SUCCESS
        }
        Ok(scenario) => {
            let mut text = format!(
                "{target}: ok: {}, {} besides the simulator, {}",
                counted(scenario.world.robots.len(), "robot", "robots"),
                counted(scenario.processes.len(), "process", "processes"),
                counted(scenario.events.len(), "event", "events")
            );
            for process in scenario.external_commands() {
                text.push_str(&format!(
                    "\n  {} starts an external program: {}",
                    process.name,
                    process.program.command_line().unwrap_or_default()
                ));
            }
            for remark in remark_lines(&scenario.remarks()) {
                text.push_str(&format!("\n{remark}"));
            }
            print(&text);
            ExitCode::SUCCESS
        }
        Err(problems) => {
            if args.json.json {
                print_json(&json!({ "ok": false, "problems": problems.to_string() }));
            } else {
                eprintln!("{problems}");
            }
            ExitCode::from(EXIT_INVALID)
        }
    }
}

/// Draws a scenario into a file; prints an error and returns the exit code if that is impossible.
fn write_picture(scenario: &ResolvedScenario, file: &Path, force: bool) -> Result<(), u8> {
    let trace = RunTrace::before_run(scenario).map_err(|error| {
        eprintln!("error: {error}");
        EXIT_INVALID
    })?;
    write(file, force, || {
        encoded(draw(&trace), file).map_err(derived::failed(file))
    })
}

/// Draws the dataflow of a scenario into a file, as [`write_picture`].
fn write_graph(scenario: &ResolvedScenario, file: &Path, force: bool) -> Result<(), u8> {
    let plan = Plan::new(scenario, "warn").map_err(|error| {
        eprintln!("error: {error}");
        EXIT_INVALID
    })?;
    let dataflow = Dataflow::new(&plan);
    let is_svg = file
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    write(file, force, || {
        let text = if is_svg {
            dataflow.svg()
        } else {
            dataflow.mermaid()
        };
        Ok(text.into_bytes())
    })
}

/// Writes a file; prints an error and returns the exit code if that is impossible.
fn write(
    file: &Path,
    force: bool,
    bytes: impl FnOnce() -> Result<Vec<u8>, DerivedError>,
) -> Result<(), u8> {
    let written = output::create(file, force).and_then(|out| output::write(out, file, bytes()?));
    written.map_err(|error| {
        eprintln!("error: {error}");
        exit_code_of_derived(&error)
    })
}

/// Returns a count with its noun: `1 robot`, `2 robots`.
fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
