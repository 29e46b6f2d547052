//! Tests of experiment files without execution.

#![allow(
    clippy::too_many_lines,
    reason = "lists of cases with the texts of their errors"
)]

mod contradictions;
mod experiment;
mod messages;
mod messages_of_values;
mod published;
mod results;
mod worst;

use expect_test::{Expect, expect};

use super::{Experiment, LoadOptions};

/// A small experiment: two cases, one parameter with three values, three seeds.
pub(super) const GOOD: &str = r#"
name = "small"
title = "A small experiment"
scenario = "builtin:chase_exact"
seeds = { first = 1, count = 3 }

[[cases]]
name = "potential"
set.processes.evader_potential.params.threat.gain = 0.0

[[cases]]
name = "braitenberg"
[cases.set]
teams.evader.scan = { beams = 72, angle_increment = 0.0872 }
processes.evader_potential = { kind = "evader_braitenberg", team = "evader" }

[parameters.relative_speed]
title = "evader speed / Police speed"
set = "teams.evader.limits.v_max"
scale = "teams.police.limits.v_max"

[grid]
relative_speed = [0.8, 1.5, 2]

[run]
timeout_s = 100.0

[[figures]]
name = "chance"
x = "relative_speed"
"#;

/// Loads the text of an experiment.
pub(super) fn load_with(text: &str, options: &LoadOptions) -> Result<Experiment, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("small.toml");
    std::fs::write(&path, text).unwrap();
    let name = format!("{}/", directory.path().display());
    Experiment::load(&path, options).map_err(|e| e.to_string().replace(&name, ""))
}

pub(super) fn load(text: &str) -> Result<Experiment, String> {
    load_with(text, &LoadOptions::new(kinds::KINDS))
}

/// The small experiment with one thing changed.
pub(super) fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?}");
    GOOD.replacen(from, to, 1)
}

/// Compares the errors of these experiments with the snapshot.
#[track_caller]
pub(super) fn texts_refused(texts: impl IntoIterator<Item = String>, errors: &Expect) {
    let refused = |text: String| load(&text).expect_err(&text);
    let found: Vec<String> = texts.into_iter().map(refused).collect();
    errors.assert_eq(&found.join("\n"));
}

/// Compares the errors of the small experiment, each time with one part replaced, with the snapshot.
#[track_caller]
pub(super) fn refused(changes: &[(&str, &str)], errors: &Expect) {
    texts_refused(changes.iter().map(|(from, to)| changed(from, to)), errors);
}
