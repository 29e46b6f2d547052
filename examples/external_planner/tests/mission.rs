//! A whole mission with the planner, run by `protean` from `PATH` or by the program that the variable `PROTEAN` names.

use std::process::Command;

/// Contains the digest of the mission with seed 1.
const README: &str = include_str!("../README.md");

/// Runs the mission, in which the robot reaches its goal; returns the summary.
fn run(name: &str) -> String {
    let protean = std::env::var("PROTEAN").unwrap_or_else(|_| "protean".to_owned());
    let program = env!("CARGO_BIN_EXE_my_planner");
    let log = format!("{}/{name}.mcap", env!("CARGO_TARGET_TMPDIR"));
    let output = Command::new(&protean)
        .args([
            "run",
            "hall.toml",
            "--seed",
            "1",
            "--allow-external",
            "--json",
        ])
        .args(["--out", &log, "--force", "--set"])
        .arg(format!("processes.my_planner.command=[{program:?}]"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap_or_else(|error| panic!("{protean}: {error}; set PROTEAN to the path of protean"));
    let summary = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert!(summary.contains("\"goal_reached\""), "{summary}");
    summary
}

#[test]
fn the_robot_reaches_its_goal_twice_with_the_digest_of_the_readme() {
    let digest = README
        .split("```text\n")
        .nth(1)
        .and_then(|text| text.lines().next());
    let expected = format!("\"digest\":\"{}\"", digest.unwrap());
    for name in ["first", "second"] {
        let summary = run(name);
        assert!(
            summary.contains(&expected),
            "expected {expected}: {summary}"
        );
    }
}
