//! `protean check`.

use std::process::ExitCode;

use platform::eprintln;
use serde_json::json;

use super::output::{EXIT_INVALID, print, print_json};
use super::run_args::OverrideArgs;
use scenario::Loader;
use scenario::kind::Kind;

/// Checks a scenario and says what it is.
pub fn check(
    kinds: &[Kind],
    target: &str,
    overrides: &OverrideArgs,
    show: bool,
    as_json: bool,
) -> ExitCode {
    let loaded = Loader::new(kinds)
        .allow_outside(overrides.allow_outside)
        .load(target, &overrides.set, overrides.seed);
    match loaded {
        Ok(scenario) if show => {
            print(scenario.to_toml().trim_end());
            ExitCode::SUCCESS
        }
        Ok(scenario) if as_json => {
            print_json(&json!({
                "ok": true,
                "scenario": scenario.name,
                "seed": scenario.run.seed,
                "robots": scenario.world.robots.iter().map(|r| &r.name).collect::<Vec<_>>(),
                "processes": scenario.processes.iter().map(|p| &p.name).collect::<Vec<_>>(),
                "events": scenario.events.len(),
                "external_commands": scenario.uses_external_commands(),
            }));
            ExitCode::SUCCESS
        }
        Ok(scenario) => {
            let mut text = format!(
                "{target}: ok: {}, {} and the simulator, {}",
                counted(scenario.world.robots.len(), "robot", "robots"),
                counted(scenario.processes.len(), "process", "processes"),
                counted(scenario.events.len(), "event", "events")
            );
            for process in scenario.external_commands() {
                text.push_str(&format!(
                    "\n  {} starts a program of its own: {}",
                    process.name,
                    process.program.command_line().unwrap_or_default()
                ));
            }
            print(&text);
            ExitCode::SUCCESS
        }
        Err(problems) => {
            if as_json {
                print_json(&json!({ "ok": false, "problems": problems.to_string() }));
            } else {
                eprintln!("{problems}");
            }
            ExitCode::from(EXIT_INVALID)
        }
    }
}

/// `1 robot`, `2 robots`.
fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
