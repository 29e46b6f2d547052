//! Things broken on purpose: a bounded number of seeded faults, and every promise checked by the
//! program's own `chaos`.

use std::os::unix::ffi::OsStringExt as _;
use std::path::{Path, PathBuf};

use rustix::process::Signal;
use serde_json::Value as Json;

use crate::support::sandbox::{processes_with, signal};
use crate::support::{SOON, Sandbox, until};

/// Does faults of these kinds and returns the report; every promise held.
fn chaos(kinds: &str, faults: &str) -> Json {
    seeded_chaos(kinds, faults, 7)
}

/// As [`chaos`], with this seed of the faults.
fn seeded_chaos(kinds: &str, faults: &str, seed: u32) -> Json {
    let sandbox = Sandbox::new();
    let keep = sandbox.path().join("broken").display().to_string();
    let outcome = sandbox
        .protean([
            "chaos",
            "chase",
            "--kinds",
            kinds,
            "--faults",
            faults,
            "--fault-seed",
            &seed.to_string(),
            // Short missions with everybody in them.
            "--set",
            "rules.time_limit=20.0",
            "--keep",
            &keep,
            "--json",
        ])
        .run();
    assert_eq!(
        outcome.code,
        Some(0),
        "{}\n{}",
        outcome.stdout,
        outcome.stderr
    );
    let report: Json = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(report["broken"], 0, "{report}");
    assert!(report["injected"].as_u64().unwrap() > 0, "{report}");
    for fault in report["outcomes"].as_array().unwrap() {
        let kind = fault["kind"].as_str().unwrap();
        assert!(kinds.contains(kind), "{fault}");
    }
    report
}

#[test]
fn processes_that_die_end_the_run_or_come_back() {
    // How long that is in time depends on how busy the machine is; the promise, in ticks, does not.
    let told = |fault: &Json| fault["stopped_after_s"].is_f64();
    // And so does who drives already, or still, when its planner dies.
    let mut reports = (7..12).map(|seed| seeded_chaos("kill,terminate", "6", seed));
    let of_a_planner = reports.find(|r| r["outcomes"].as_array().unwrap().iter().any(told));
    assert!(of_a_planner.is_some());
}

#[test]
fn processes_that_hang_are_found() {
    chaos("hang", "2");
}

#[test]
fn what_passes_by_changes_nothing() {
    chaos("pause,slow", "4");
}

#[test]
fn a_second_of_the_same_is_kept_out() {
    chaos("double", "3");
}

#[test]
fn an_orchestrator_that_dies_takes_everything_along_and_loses_a_second_at_most() {
    let report = chaos(
        "kill-orchestrator,terminate-orchestrator,pause-orchestrator",
        "6",
    );
    for fault in report["outcomes"].as_array().unwrap() {
        if let Some(lost) = fault["lost_s"].as_f64() {
            assert!(lost <= 1.0, "{fault}");
        }
    }
}

#[test]
fn a_mission_whose_chaos_was_killed_is_found_by_clean() {
    let sandbox = Sandbox::new();
    // Fault 0 of this seed is by the clock, so slow that it never comes to it.
    let chaos = sandbox
        .protean([
            "chaos",
            "hello",
            "--kinds",
            "pause",
            "--fault-seed",
            "1",
            "--real-time",
            "0.01",
        ])
        .start();
    let known = sandbox.next_run(&std::collections::BTreeSet::new());
    let note = sandbox
        .runtime_dir()
        .join("protean")
        .join(&known)
        .join("annex");
    let annex = until("the mission's folder", SOON, || {
        // It is there a moment before anything is in it.
        std::fs::read(&note).ok().filter(|path| !path.is_empty())
    });
    let annex = PathBuf::from(std::ffi::OsString::from_vec(annex));
    let runtime_dir = annex.join("rt");
    let _guard = Killed(runtime_dir.clone());
    let run = until("a run of the mission", SOON, || {
        let mut runs = std::fs::read_dir(runtime_dir.join("protean")).ok()?;
        let name = runs.find_map(|entry| {
            let name = entry.ok()?.file_name().into_string().ok()?;
            name.starts_with('r').then_some(name)
        })?;
        let shared = || !shared_memory(&name).is_empty();
        shared().then_some(name)
    });
    chaos.signal(Signal::KILL);
    chaos.finish();

    // Its mission goes on, and is nobody else's to end.
    let clean = || sandbox.protean(["clean"]).run();
    let left_alone = clean();
    assert_eq!(left_alone.code, Some(0), "{left_alone}");
    let alive = format!("{run}: alive, left alone");
    assert!(left_alone.stdout.contains(&alive), "{left_alone}");
    assert!(annex.exists() && note.exists());

    kill_all(&runtime_dir);
    until("the end of the mission", SOON, || {
        processes_with(&runtime_dir).is_empty().then_some(())
    });
    assert!(!shared_memory(&run).is_empty(), "nothing to clean");
    // A process that ends forgets its environment a moment before it lets go of its locks.
    let cleaned = until("the end of its lock", SOON, || {
        let cleaned = clean();
        (!cleaned.stdout.contains(&alive)).then_some(cleaned)
    });
    assert_eq!(cleaned.code, Some(0), "{cleaned}");
    for what in [
        &format!("{run}: removed"),
        &format!("{}: removed", annex.display()),
    ] {
        assert!(cleaned.stdout.contains(what), "{what}: {cleaned}");
    }
    assert!(!annex.exists());
    assert!(shared_memory(&run).is_empty());
    sandbox.assert_nothing_left();
}

/// A runtime directory whose processes are killed and whose shared memory is removed, also by a
/// failing test.
struct Killed(PathBuf);

impl Drop for Killed {
    fn drop(&mut self) {
        kill_all(&self.0);
        let runs = std::fs::read_dir(self.0.join("protean"));
        for run in runs.into_iter().flatten().flatten() {
            for piece in shared_memory(&run.file_name().to_string_lossy()) {
                let _ = std::fs::remove_file(piece);
            }
        }
    }
}

fn kill_all(runtime_dir: &Path) {
    for process in processes_with(runtime_dir) {
        signal(process.pid, Signal::KILL);
    }
}

/// Pieces of shared memory of a run.
fn shared_memory(run: &str) -> Vec<PathBuf> {
    let prefix = Sandbox::prefix(run);
    let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
    entries
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .map(|entry| entry.path())
        .collect()
}

#[test]
fn the_same_seed_draws_the_same_faults() {
    let drawn = |seed: &str| {
        let sandbox = Sandbox::new();
        let words = [
            "chaos",
            "hello",
            "--kinds",
            "pause,kill",
            "-n",
            "3",
            "--fault-seed",
            seed,
            "--json",
        ];
        let outcome = sandbox.protean(words).run();
        let report: Json = serde_json::from_str(&outcome.stdout).unwrap();
        let of = |fault: &Json| {
            ["kind", "target", "course", "policy", "moment"].map(|k| fault[k].clone())
        };
        report["outcomes"]
            .as_array()
            .unwrap()
            .iter()
            .map(of)
            .collect::<Vec<_>>()
    };
    assert_eq!(drawn("1"), drawn("1"));
    assert_ne!(drawn("1"), drawn("2"));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let sandbox = Sandbox::new();
    for (words, named) in [
        (vec!["chaos", "nowhere"], "nowhere"),
        (vec!["chaos", "hello", "--kinds", "boredom"], "boredom"),
        (vec!["chaos", "hello", "--faults", "0"], "--faults 0"),
        (
            vec!["chaos", "hello", "--real-time", "inf"],
            "--real-time inf",
        ),
    ] {
        let outcome = sandbox.protean(words).run();
        assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(named), "{}", outcome.stderr);
    }
}
