//! Untrusted scenarios, maps and logs: requests above a limit are refused with the limit named, paths cannot
//! leave the scenario's folder, text cannot control the terminal, and files of a run are readable by its user
//! only.

mod access;
mod limits;
mod paths;
mod question;
mod text;

/// The smallest scenario, for changes.
const GOOD: &str = r#"title = "Hello"

[world]
map = "builtin:hello"

[rules]
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 1.0

[[robots]]
name = "robot"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }

[[processes]]
kind = "evader_potential"
robots = ["robot"]
"#;

/// The scenario with one thing changed.
fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?}");
    GOOD.replacen(from, to, 1)
}

/// The scenario on a map of these vectors, 4 m × 3 m.
fn on_vectors(more: &str) -> String {
    changed(
        "map = \"builtin:hello\"",
        &format!("[world.map.vector]\nbounds = {{ min = [0, 0], max = [4, 3] }}\n{more}"),
    )
}
