//! Robots steered by a learned policy.

use std::fmt::Write as _;

use crate::support::Sandbox;
use crate::support::call::PATIENCE;

/// A small policy for `chase` (`policy/make.py`).
const MODEL: &[u8] = include_bytes!("policy/to_the_exit.onnx");

/// The chasing game with evaders of the policy, and what its process has besides.
fn chase(params: &str) -> String {
    let chase = include_str!("../scenarios/chase.toml");
    let own = format!("kind = \"policy\"\nparams = {{ {params} }}");
    let text = chase.replace("kind = \"evader_potential\"", &own);
    let text = text.replace("\"maps/city.toml\"", "\"builtin:city\"");
    assert!(text.contains(&own) && text.contains("builtin:city"));
    text
}

/// Writes the scenario with the model beside it.
fn prepare(sandbox: &Sandbox) {
    sandbox.file("models/to_the_exit.onnx", MODEL);
    sandbox.file("chase.toml", chase("model = \"models/to_the_exit.onnx\""));
}

/// The folder of the example.
const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/learn");

/// Digest of the first seconds of a mission, which is the same with processes and in one; its log is `run.mcap`.
fn digest(sandbox: &Sandbox, scenario: &str, seed: &str, set: Option<&str>) -> String {
    let mission = || {
        let call = sandbox.protean(["run", scenario, "--quiet", "--seed", seed]);
        let call = call.set("rules.time_limit=8");
        match set {
            None => call,
            Some(set) => call.set(set),
        }
    };
    let alone = mission().arg("--in-process").json();
    let call = mission()
        .set(PATIENCE)
        .args(["--force", "--out", "run.mcap"]);
    let digest = call.json()["digest"].as_str().unwrap().to_owned();
    assert_eq!(alone["digest"], digest.as_str());
    digest
}

#[test]
fn a_mission_has_one_digest_with_processes_in_one_and_from_its_log_alone() {
    let sandbox = Sandbox::new();
    prepare(&sandbox);
    let mut lines = String::new();
    for (options, seed) in [
        ("", "1"),
        ("ticks_per_action=4", "1"),
        ("exploration=0.3", "1"),
        ("", "2"),
    ] {
        let set = format!("processes.policy.params.{options}");
        let set = (!options.is_empty()).then_some(set.as_str());
        let digest = digest(&sandbox, "chase.toml", seed, set);
        writeln!(lines, "to_the_exit {seed} {options} {digest}").unwrap();
    }
    crate::goldens::compare("policy.txt", &lines);
    // The log contains the model.
    std::fs::remove_dir_all(sandbox.path().join("models")).unwrap();
    let verified = sandbox.protean(["verify", "run.mcap"]).run();
    assert_eq!(verified.code, Some(0), "{verified}");
    sandbox.assert_nothing_left();
}

#[test]
fn what_does_not_fit_is_named_before_the_first_tick() {
    let sandbox = Sandbox::new();
    prepare(&sandbox);
    let check = |params: &str| {
        sandbox.file("bad.toml", chase(params));
        sandbox.protean(["check", "bad.toml"]).run()
    };
    check("model = \"models/none.onnx\"").refused(2, &["params.model", "models/none.onnx"]);
    check("model = \"../outside.onnx\"").refused(2, &["out of the scenario's folder"]);
    check("").refused(
        2,
        &["`model` is missing: expected the path of an ONNX file"],
    );
    let both = "model = \"models/to_the_exit.onnx\", observation = \"lidar\"";
    check(both).refused(2, &["observation", "state, scan, belief"]);
    let both = "model = \"models/to_the_exit.onnx\", action = \"pull\"";
    check(both).refused(2, &["`action`", "twist, tune or residual"]);
    sandbox.file("models/text.onnx", "not a model");
    check("model = \"models/text.onnx\"").refused(2, &["`model`: not an ONNX file"]);
    let both = "model = \"models/to_the_exit.onnx\", observation = \"state+belief\"";
    check(both).refused(
        2,
        &[
            "params.model",
            "its input has 62 numbers, but the observation `state+belief`",
        ],
    );
}

#[test]
fn the_example_is_the_chase_but_for_its_evaders_and_has_one_digest() {
    let sandbox = Sandbox::new();
    for file in ["chase.toml", "evader.onnx"] {
        let path = format!("{EXAMPLE}/{file}");
        sandbox.file(file, std::fs::read(path).unwrap());
    }
    let mut lines = String::new();
    for seed in ["1", "2"] {
        let digest = digest(&sandbox, "chase.toml", seed, None);
        writeln!(lines, "evader {seed} {digest}").unwrap();
    }
    crate::goldens::compare("policy_example.txt", &lines);
    let path = sandbox.path().join("chase.toml");
    let load = |target: &str| kinds::load(target, &[], Some(7)).unwrap();
    let (example, chase) = (load(path.to_str().unwrap()), load("chase"));
    assert_eq!(example.world, chase.world);
    assert_eq!(example.run, chase.run);
    assert_eq!(example.processes[..5], chase.processes[..5]);
    assert_eq!(example.processes.len(), chase.processes.len());
    sandbox.assert_nothing_left();
}
