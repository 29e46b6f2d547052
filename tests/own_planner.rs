//! A program built outside the workspace with one more planner than Protean: `examples/own_planner`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{PROTEAN, Sandbox};

/// Builds the example as its README says, but with the profile and the target directory of the workspace, so that
/// nothing of others is built again; its program.
fn build() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let example = root.join("examples/own_planner");
    // The versions of the workspace.
    std::fs::copy(root.join("Cargo.lock"), example.join("Cargo.lock")).unwrap();
    // TARGET/PROFILE/protean_under_test
    let folder = Path::new(PROTEAN).parent().unwrap();
    let profile = match folder.file_name().unwrap().to_str().unwrap() {
        "debug" => "dev",
        name => name,
    };
    let built = Command::new(env!("CARGO"))
        .args(["build", "--offline", "--profile", profile, "--config"])
        .arg(root.join("Cargo.toml"))
        .arg("--manifest-path")
        .arg(example.join("Cargo.toml"))
        .env("CARGO_TARGET_DIR", folder.parent().unwrap())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{text}");
    folder.join("own_planner")
}

/// A sandbox with the files of the example.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.file(
        "hall.toml",
        include_str!("../examples/own_planner/hall.toml"),
    );
    sandbox.file(
        "sweep.toml",
        include_str!("../examples/own_planner/sweep.toml"),
    );
    sandbox
}

#[test]
fn a_program_outside_this_workspace_has_all_commands_for_its_own_planner() {
    let program = build();
    let sandbox = sandbox();
    let call = |words: &[&str]| sandbox.call(&program).args(words.iter().copied());

    let listed = call(&["list"]).json();
    let kinds = listed["kinds"].as_array().unwrap();
    let has = |name: &str| kinds.iter().any(|kind| kind["name"] == name);
    assert!(has("nearest_free") && has("pursuer"), "{listed}");

    let checked = call(&["check", "hall.toml"]).run();
    assert_eq!(checked.code, Some(0), "{checked}");
    let refused = call(&["check", "hall.toml", "--set"])
        .arg("processes.nearest_free.params.look_ahead=0")
        .run();
    assert_eq!(refused.code, Some(2), "{refused}");
    for part in [
        "(processes.nearest_free.params.look_ahead)",
        "above 0",
        "(m)",
    ] {
        assert!(refused.stderr.contains(part), "{refused}");
    }
    // Protean itself does not have it.
    let unknown = sandbox.protean(["check", "hall.toml"]).run();
    assert_eq!(unknown.code, Some(2), "{unknown}");
    assert!(unknown.stderr.contains("unknown process kind"), "{unknown}");

    let run = |words: &[&str]| {
        call(&["run", "hall.toml", "--seed", "1"])
            .args(words.iter().copied())
            .json()
    };
    let alone = run(&["--out", "hall.mcap"]);
    let together = run(&["--in-process"]);
    assert_eq!(alone["robots"][0]["outcome"], "goal_reached", "{alone}");
    assert_eq!(alone["digest"], together["digest"]);

    let again = call(&["verify", "hall.mcap"]).json();
    assert_eq!(again["same"], true, "{again}");

    let rows = |words: &[&str]| -> Vec<String> {
        let out = words[0];
        let swept = call(&["sweep", "sweep.toml", "--quiet", "--out"])
            .args(words.iter().copied())
            .json();
        assert!(swept.is_object(), "{swept}");
        digests(&sandbox.path().join(out).join("results.csv"))
    };
    let alone = rows(&["alone"]);
    assert_eq!(alone.len(), 4);
    assert!(alone[0] != alone[2], "the parameter has no effect");
    assert_eq!(alone, rows(&["together", "--in-process"]));
}

/// The digests in a table of results.
fn digests(table: &Path) -> Vec<String> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let column = reader
        .headers()
        .unwrap()
        .iter()
        .position(|name| name == "digest");
    let column = column.unwrap();
    let rows = reader.records().map(|row| row.unwrap()[column].to_owned());
    rows.collect()
}
