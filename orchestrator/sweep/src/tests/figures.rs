//! Figures drawn from results.

use std::path::Path;

use super::super::{MissionId, Outcome, Results, Row, SweepError, figures};
use super::*;

fn row(escaped: u32) -> Row {
    Row {
        outcome: Outcome::Ended,
        evaders: 2,
        escaped,
        caught: 2 - escaped,
        sim_time_s: 12.5,
        ..Row::failed("")
    }
}

/// Returns results of an experiment: two escape in every game at the highest speed, one at the
/// others.
fn results(directory: &Path, text: &str) -> Results {
    let manifest = load(text).unwrap().manifest();
    let mut results = Results::open(directory, &manifest, text).unwrap();
    for cell in 0..manifest.cells.len() {
        for seed in manifest.seeds.iter() {
            let escaped = if cell % 3 == 2 { 2 } else { 1 };
            let mission = MissionId { cell, seed };
            results.record(mission, row(escaped), 0.1).unwrap();
        }
    }
    results
}

const POINTS: &str = "series,x,y,low,high\npotential,1.5,0.6,0.3,0.8\nBraitenberg,2,0.1,,\n";

fn compared() -> String {
    changed(
        "x = \"relative_speed\"",
        "x = \"relative_speed\"\ncompare = \"published/points.csv\"",
    )
    .replace(
        "name = \"braitenberg\"",
        "name = \"braitenberg\"\ntitle = \"Braitenberg\"",
    )
}

#[test]
fn cells_become_points_with_published_ones() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("published")).unwrap();
    std::fs::write(folder.path().join("published/points.csv"), POINTS).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let results = results(directory.path(), &compared());
    figures::keep_published(folder.path(), &results).unwrap();

    let charts = figures::charts(&results).unwrap();
    let (name, chart) = &charts[0];
    assert_eq!((name.as_str(), charts.len()), ("chance", 1));
    assert_eq!(chart.x_label, "evader speed / Police speed");
    let names: Vec<_> = chart.series.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["potential", "Braitenberg"]);
    for series in &chart.series {
        let values: Vec<_> = series.points.iter().map(|p| (p.x, p.y)).collect();
        assert_eq!(values, [(0.8, 0.5), (1.5, 0.5), (2.0, 1.0)]);
        assert!(series.points.iter().all(|p| p.interval.is_some()));
        assert_eq!(series.reference.len(), 1);
    }
    assert_eq!(chart.series[0].reference[0].interval, Some((0.3, 0.8)));

    let files = figures::write(&results).unwrap();
    let kinds: Vec<_> = files.iter().filter_map(|f| f.extension()).collect();
    assert_eq!(kinds, ["svg"]);
    let svg = std::fs::read_to_string(&files[0]).unwrap();
    assert!(roxmltree::Document::parse(&svg).is_ok());
}

#[test]
fn without_figures_the_main_outcome_is_drawn_over_the_first_parameter_that_varies() {
    let (before, _) = GOOD.split_once("[[figures]]").unwrap();
    for (text, expected) in [
        (before.to_owned(), 1),
        (format!("figures = []\n{before}"), 0),
    ] {
        let directory = tempfile::tempdir().unwrap();
        let results = results(directory.path(), &text);
        let charts = figures::charts(&results).unwrap();
        assert_eq!(charts.len(), expected);
        for (name, chart) in charts {
            assert_eq!(name, "outcome");
            assert_eq!(chart.x_label, "evader speed / Police speed");
            assert_eq!(chart.y_label, "evaders that escape");
            assert_eq!(chart.series.len(), 2);
        }
    }
}

#[test]
fn published_points_must_exist_and_be_valid() {
    let folder = tempfile::tempdir().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let results = results(directory.path(), &compared());
    let error = figures::keep_published(folder.path(), &results).unwrap_err();
    assert!(matches!(error, SweepError::Io { .. }), "{error}");
    std::fs::create_dir_all(directory.path().join("published")).unwrap();
    std::fs::write(
        directory.path().join("published/points.csv"),
        "series,x\na,1\n",
    )
    .unwrap();
    let error = figures::write(&results).unwrap_err();
    assert!(matches!(error, SweepError::Damaged { .. }), "{error}");
}

#[test]
fn published_points_come_from_below_the_experiment_only() {
    let text = compared().replace("published/points.csv", "../points.csv");
    let folder = tempfile::tempdir().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let results = results(directory.path(), &text);
    let error = figures::keep_published(folder.path(), &results).unwrap_err();
    assert!(matches!(error, SweepError::Figure { .. }), "{error}");
}
