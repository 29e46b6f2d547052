//! Mutants: runs of which one or two processes behave otherwise from a tick on.

mod changed_logs;
mod changed_planners;

use std::path::{Path, PathBuf};

use mcap_log::ReadProgress;
use mission::in_process::{self, InProcessOptions};
use scenario::kind::ConfiguredKind;
use tempfile::TempDir;

use crate::{DiffReport, diff};

/// Duration of the runs (s).
const DURATION_S: f64 = 2.0;
/// Ticks of these runs.
const TICKS: u64 = 40;

/// Runs the chase with these kinds in the place of its own, by process.
fn run(folder: &TempDir, name: &str, programs: Vec<(String, ConfiguredKind)>) -> PathBuf {
    let set = [
        format!("rules.time_limit={DURATION_S}"),
        "log.viewer_rate_hz=0".to_owned(),
    ];
    let scenario = kinds::load("chase", &set, None).unwrap();
    let log = folder.path().join(name);
    let options = InProcessOptions {
        out: Some(log.clone()),
        programs: programs.into_iter().collect(),
        ..InProcessOptions::default()
    };
    in_process::run(&scenario, &options).unwrap();
    log
}

fn compared(a: &Path, b: &Path) -> DiffReport {
    diff(a, b, &mut ReadProgress::default()).unwrap()
}

/// Asserts tick, processes, topic and first field of the causes, which are in the order of their names.
#[track_caller]
fn assert_caused(report: &DiffReport, tick: u64, expected: &[(&str, &str, &str)]) {
    let first = report.comparison.first.as_ref().unwrap();
    let found: Vec<_> = first
        .causes
        .iter()
        .map(|cause| (&*cause.process, &*cause.topic, &*cause.field))
        .collect();
    assert_eq!(found, expected, "{first:?}");
    assert!(
        first
            .causes
            .iter()
            .all(|cause| cause.tick == tick && cause.a != cause.b)
    );
    assert!(!report.same && report.whole);
}

#[test]
fn repetitions_are_equal_also_when_one_of_them_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (
        run(&folder, "a.mcap", Vec::new()),
        run(&folder, "b.mcap", Vec::new()),
    );
    let report = compared(&a, &b);
    assert!(report.same && report.whole, "{report:?}");
    assert_eq!(report.a.digest, report.b.digest);
    assert!(report.scenario.is_empty() && report.results.is_empty() && report.events.is_empty());
    let whole = std::fs::read(&b).unwrap();
    for share in [3, 5, 9] {
        std::fs::write(&b, &whole[..whole.len() * share / 10]).unwrap();
        for (x, y) in [(&a, &b), (&b, &a)] {
            let report = compared(x, y);
            assert!(report.same && !report.whole, "{report:?}");
        }
    }
}
