//! `protean list`.

use std::process::ExitCode;

use platform::eprintln;
use serde_json::json;

use super::output::{EXIT_INVALID, print, print_json};
use scenario::kind::Kind;
use scenario::{builtin, list as scenarios};

/// Lists what there is, or shows one built-in scenario.
pub fn list(kinds: &[Kind], as_json: bool, show: Option<&str>) -> ExitCode {
    if let Some(name) = show {
        if let Some(scenario) = builtin::scenario(name) {
            print(scenario.text.trim_end());
            return ExitCode::SUCCESS;
        }
        let names: Vec<_> = scenarios().into_iter().map(|s| s.name).collect();
        eprintln!(
            "error: no built-in scenario {name:?}: expected one of {}",
            names.join(", ")
        );
        return ExitCode::from(EXIT_INVALID);
    }
    let scenarios = scenarios();
    if as_json {
        print_json(&json!({
            "scenarios": scenarios
                .iter()
                .map(|s| json!({ "name": s.name, "title": s.title }))
                .collect::<Vec<_>>(),
            "kinds": kinds
                .iter()
                .map(|k| json!({ "name": k.name, "summary": k.summary }))
                .collect::<Vec<_>>(),
        }));
        return ExitCode::SUCCESS;
    }
    let mut text = String::from("Scenarios (protean run NAME, protean list --show NAME):\n");
    for s in &scenarios {
        text.push_str(&format!("  {:20} {}\n", s.name, s.title));
    }
    text.push_str("\nKinds of processes (kind = \"NAME\"):\n");
    for k in kinds {
        text.push_str(&format!("  {:20} {}\n", k.name, k.summary));
    }
    print(text.trim_end());
    ExitCode::SUCCESS
}
