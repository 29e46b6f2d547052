//! Things broken on purpose: a bounded number of seeded faults, and every promise checked by the
//! program's own `chaos`.

use serde_json::Value as Json;

use crate::support::Sandbox;

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
