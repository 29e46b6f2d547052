//! Studies made of results of sweeps.

use std::path::Path;

use sweep::{Experiment, LoadOptions, MissionId, Outcome, Results, Row};

use super::super::read::StudyError;
use super::*;
use crate::place::PlaceError;

const EXPERIMENT: &str = r#"
name = "NAME"
scenario = "builtin:chase_exact"
seeds = { first = 1, count = 3 }
[[cases]]
name = "potential_field"
title = "Potential field"
[parameters.relative_speed]
set = "teams.evader.limits.v_max"
scale = "teams.police.limits.v_max"
[grid]
relative_speed = [1.5, 2]
"#;

/// Results of an experiment of this name: one of two evaders escapes at 1.5, both at 2.
fn results(directory: &Path, name: &str) -> Results {
    let text = EXPERIMENT.replace("NAME", name);
    let file = directory.join("file.toml");
    std::fs::write(&file, &text).unwrap();
    let experiment = Experiment::load(&file, &LoadOptions::new(kinds::KINDS)).unwrap();
    let manifest = experiment.manifest();
    let mut results = Results::open(&directory.join("out"), &manifest, &text).unwrap();
    for (cell, escaped) in [(0, 1), (1, 2)] {
        for seed in 1..=3 {
            let row = Row {
                outcome: Outcome::Ended,
                evaders: 2,
                escaped,
                caught: 2 - escaped,
                ..Row::default()
            };
            results.record(MissionId { cell, seed }, row, 0.1).unwrap();
        }
    }
    results
}

#[test]
fn results_become_a_study_once() {
    let directory = tempfile::tempdir().unwrap();
    let results = results(directory.path(), "escape_vs_speed");
    let mut evidence = Evidence::default();
    evidence.add(&results).unwrap();
    let study = evidence.speed.clone().unwrap();
    assert_eq!(study.seeds, "1..3");
    assert_eq!(study.title("potential_field"), "Potential field");
    let cell = study.cell("potential_field", 2.0).unwrap();
    assert_eq!(
        (cell.escapes().hits(), cell.games.len(), cell.caught),
        (6, 3, 0)
    );
    let error = evidence.add(&results).unwrap_err();
    assert!(
        matches!(error, StudyError::Place(PlaceError::Twice { .. })),
        "{error}"
    );
    let text = page(&evidence).unwrap().text;
    assert!(
        text.contains("| | Potential field |\n|---|---|\n| games | 3 |\n| 1.5× | 50 % ("),
        "{text}"
    );
}

#[test]
fn other_experiments_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let results = results(directory.path(), "small");
    let error = Evidence::default().add(&results).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("expected one of escape_vs_speed"), "{error}");
}
