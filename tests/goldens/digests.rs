//! The simulated history of every built-in scenario: bit for bit the same on any machine and in any version.
//! `protean test tests/missions --update=WHY` writes the digests anew.

use std::path::Path;

use crate::support::Sandbox;
use crate::support::call::PATIENCE;
use scenario::builtin::SCENARIOS;

/// Runs the tests of `tests/missions` in a file or folder.
fn test(name: &str, words: &[&str]) {
    let sandbox = Sandbox::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("missions")
        .join(name);
    let call = sandbox.protean(["test", "--quiet", "--json"]).arg(path);
    let outcome = call.args(words.iter().copied()).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let report = outcome.json();
    let tests = report["tests"].as_array().unwrap();
    for scenario in SCENARIOS {
        let name = format!("/{}", scenario.name);
        let has = |test: &&serde_json::Value| test["name"].as_str().unwrap().ends_with(&name);
        assert!(tests.iter().any(|test| has(&test)), "no test of {name}");
    }
}

// Each of the two takes about a minute on one core: whole missions are guaranteed, and a
// history that differs only late would pass a shorter one.
#[test]
fn digests_in_one_process() {
    test("", &["--jobs", "1"]);
}

#[test]
fn digests_with_processes() {
    test("seed_1.toml", &["--processes", "--set", PATIENCE]);
}
