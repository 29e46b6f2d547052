//! Fault injection by `protean chaos`: a bounded number of seeded faults, after which it checks the guarantees of
//! a run.

use serde_json::Value as Json;

use crate::support::Sandbox;

/// Injects faults of these kinds into short missions with all kinds of robots, and asserts that every guarantee
/// held.
fn chaos(kinds: &str, faults: &str, more: &[&str]) -> Json {
    let sandbox = Sandbox::new();
    let words = ["chaos", "chase", "--json", "--fault-seed", "7"];
    let faults = ["--kinds", kinds, "--faults", faults];
    let words = words.into_iter().chain(faults);
    let outcome = sandbox
        .protean(words.chain(more.iter().copied()))
        .set("rules.time_limit=20.0")
        .run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let report: Json = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(report["broken"], 0, "{report}");
    assert!(report["injected"].as_u64().unwrap() > 0, "{report}");
    for fault in report["outcomes"].as_array().unwrap() {
        assert!(kinds.contains(fault["kind"].as_str().unwrap()), "{fault}");
    }
    report
}

#[test]
fn processes_that_are_killed_or_paused_keep_every_guarantee() {
    chaos("kill,pause", "6", &[]);
}

#[test]
fn processes_that_hang_are_found() {
    chaos("hang", "2", &["--set", "run.hang_timeout_s=5"]);
}

#[test]
fn in_real_time_processes_are_replaced() {
    let restart = ["perception", "pursuer", "evader_potential"]
        .map(|process| format!("processes.{process}.on_failure=restart"));
    let mut more = vec!["--real-time", "10"];
    more.extend(restart.iter().flat_map(|value| ["--set", value.as_str()]));
    chaos("kill", "4", &more);
}

#[test]
fn an_orchestrator_that_is_killed_takes_everything_along_and_loses_a_second_at_most() {
    let report = chaos("kill-orchestrator", "6", &[]);
    let lost = |fault: &Json| fault["lost_s"].as_f64();
    let outcomes = report["outcomes"].as_array().unwrap();
    assert!(outcomes.iter().filter_map(lost).all(|lost_s| lost_s <= 1.0));
    assert!(outcomes.iter().any(|fault| lost(fault).is_some()));
}

#[test]
fn the_same_seed_draws_the_same_faults() {
    let drawn = |seed: &str| {
        let sandbox = Sandbox::new();
        let words = ["chaos", "hello", "--json", "-n", "3", "--fault-seed", seed];
        let kinds = ["--kinds", "pause,kill"];
        let outcome = sandbox.protean(words.into_iter().chain(kinds)).run();
        let report: Json = serde_json::from_str(&outcome.stdout).unwrap();
        let of = |fault: &Json| ["kind", "target", "moment"].map(|key| fault[key].clone());
        let outcomes = report["outcomes"].as_array().unwrap();
        outcomes.iter().map(of).collect::<Vec<_>>()
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
        (vec!["chaos", "hello", "--faults", "0"], "--faults"),
        (
            vec!["chaos", "hello", "--real-time", "inf"],
            "--real-time inf",
        ),
    ] {
        sandbox.protean(words).run().refused(2, &[named]);
    }
}
