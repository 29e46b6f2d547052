//! `protean list`.

use std::process::ExitCode;

use serde_json::json;

use super::output::{print, print_json};
use scenario::kind::Kind;
use scenario::list as scenarios;

/// Lists the built-in scenarios and the kinds of processes.
pub fn list(kinds: &[Kind], as_json: bool) -> ExitCode {
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
    let names = scenarios.iter().map(|s| s.name.as_str());
    let names = names.chain(kinds.iter().map(|k| k.name));
    let width = names.map(str::len).max().unwrap_or_default();
    let mut text =
        String::from("Scenarios (`protean run NAME`, `protean new FILE.toml --from NAME`):\n");
    for s in &scenarios {
        text += &format!("  {:width$}  {}\n", s.name, s.title);
    }
    text += "\nKinds of processes (`kind = \"NAME\"` in a scenario):\n";
    for k in kinds {
        text += &format!("  {:width$}  {}\n", k.name, k.summary);
    }
    print(text.trim_end());
    ExitCode::SUCCESS
}
