//! Tests of experiment files without execution.

mod contradictions;
mod experiment;
mod messages;
mod published;
mod results;
mod worst;

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
    Experiment::load(&path, options).map_err(|e| e.to_string())
}

pub(super) fn load(text: &str) -> Result<Experiment, String> {
    load_with(text, &LoadOptions::new(kinds::KINDS))
}

/// The small experiment with one thing changed.
pub(super) fn changed(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?}");
    GOOD.replacen(from, to, 1)
}

/// Asserts that the text is refused with these words.
#[track_caller]
pub(super) fn refused_text(text: &str, words: &[&str]) {
    let error = load(text).unwrap_err();
    for word in words {
        assert!(error.contains(word), "{word:?} is missing in\n{error}");
    }
}

#[track_caller]
pub(super) fn refused(from: &str, to: &str, words: &[&str]) {
    refused_text(&changed(from, to), words);
}
