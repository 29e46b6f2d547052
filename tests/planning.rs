//! Evaders that plan with RRT*, from the command to the log.

use std::collections::BTreeSet;

use crate::support::Sandbox;
use crate::support::history::History;
use crate::support::invariants::Game;
use serde_json::Value as Json;

const EVADERS: [&str; 2] = ["evader_1", "evader_2"];

fn play(sandbox: &Sandbox, words: &[&str]) -> (Json, History, std::path::PathBuf) {
    let words = ["run", "chase_rrt_star"]
        .into_iter()
        .chain(words.iter().copied());
    let summary = sandbox.protean(words).arg("--quiet").json();
    let log = sandbox.path().join(summary["log"].as_str().unwrap());
    let history = History::read(&log);
    (summary, history, log)
}

#[test]
fn a_chase_of_planning_evaders_keeps_every_rule_and_shows_plans_and_trees() {
    let sandbox = Sandbox::new();
    let (summary, history, log) = play(&sandbox, &["--seed", "1", "--set", "rules.time_limit=15"]);
    Game::in_city(&log).holds(&history, &summary);
    assert!(history.states.last().unwrap().over, "{summary}");
    // Both evaders planned, at their own times, and the trees are far fewer than the ticks.
    let sources = |topic: &str| -> BTreeSet<u32> { history.of(topic).map(|m| m.source).collect() };
    assert_eq!(sources("robot/tree").len(), EVADERS.len());
    let (trees, plans) = (
        history.of("robot/tree").count(),
        history.of("robot/plan").count(),
    );
    assert!(
        trees >= EVADERS.len() && trees * 4 < plans,
        "{trees} {plans}"
    );
    // The first plan takes simulated time: nothing of a tree at the first tick.
    let first = history.of("robot/tree").map(|m| m.tick).min().unwrap();
    assert!(first > history.states[0].tick, "{first}");
    sandbox.assert_nothing_left();
}

#[test]
fn plans_follow_from_scenario_and_seed_alone() {
    let sandbox = Sandbox::new();
    let digest = |words: &[&str]| {
        let mut all = vec!["--set", "rules.time_limit=4"];
        all.extend_from_slice(words);
        let (summary, ..) = play(&sandbox, &all);
        summary["digest"].as_str().unwrap().to_owned()
    };
    let reference = digest(&["--seed", "4"]);
    assert_eq!(digest(&["--seed", "4"]), reference);
    // The same history as with processes (`tests/in_process.rs`), sooner.
    let inside = ["--in-process", "--out", "inside.mcap", "--seed"];
    assert_ne!(digest(&[&inside[..], &["5"]].concat()), reference);
    sandbox.assert_nothing_left();
}
