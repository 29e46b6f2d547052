//! Published points beside results.

use std::path::Path;

use super::super::{Results, SweepError, published};
use super::*;

/// Keeps the points of an experiment that compares with a file.
fn kept(folder: &Path, results: &Path, compare: &str) -> Result<(), SweepError> {
    let compare = format!("x = \"relative_speed\"\ncompare = {compare:?}");
    let text = changed("x = \"relative_speed\"", &compare);
    let manifest = load(&text).unwrap().manifest();
    published::keep(folder, &Results::open(results, &manifest, &text).unwrap())
}

#[test]
fn published_points_come_from_below_the_experiment_only() {
    let folder = tempfile::tempdir().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let of = |name: &str, compare: &str| kept(folder.path(), &directory.path().join(name), compare);
    let missing = of("missing", "published/points.csv").unwrap_err();
    assert!(matches!(missing, SweepError::Io { .. }), "{missing}");
    let outside = of("outside", "../points.csv").unwrap_err();
    assert!(matches!(outside, SweepError::Figure { .. }), "{outside}");
    std::fs::create_dir(folder.path().join("published")).unwrap();
    std::fs::write(folder.path().join("published/points.csv"), "series,x,y\n").unwrap();
    of("kept", "published/points.csv").unwrap();
    let copy = directory.path().join("kept/published/points.csv");
    assert_eq!(std::fs::read_to_string(copy).unwrap(), "series,x,y\n");
}
