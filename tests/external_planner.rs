//! A planner in a repository of its own: the project that `protean new --rust` writes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value as Json;

use crate::support::call::PATIENCE;
use crate::support::{PROTEAN, Sandbox, wait_for_tick};

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Files of a folder that belong to the project, by their paths in it.
fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let made = ["Cargo.lock", "logs", "target"];
    let mut found = BTreeSet::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            let relative = path.strip_prefix(folder).unwrap();
            if made.iter().any(|name| relative.starts_with(name)) {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(relative.to_owned());
            }
        }
    }
    found
}

/// A new project, in a sandbox.
fn new_project() -> Sandbox {
    let sandbox = Sandbox::new();
    let made = sandbox.protean(["new", "my_planner", "--rust"]).run();
    assert_eq!(made.code, Some(0), "{made}");
    let next = format!(
        "next: cd my_planner && cargo build --release && {PROTEAN} run hall.toml --allow-external"
    );
    assert!(made.stderr.contains(&next), "{made}");
    sandbox
}

/// The program of a new project, built and tested by its own test once for all tests: with the versions, the profile
/// and the target directory of the workspace, so that little of others is built again.
static PROGRAM: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let sandbox = new_project();
    let project = sandbox.path().join("my_planner");
    std::fs::copy(root().join("Cargo.lock"), project.join("Cargo.lock")).unwrap();
    // TARGET/PROFILE/protean_under_test
    let folder = Path::new(PROTEAN).parent().unwrap();
    let profile = match folder.file_name().unwrap().to_str().unwrap() {
        "debug" => "dev",
        name => name,
    };
    let tested = Command::new(env!("CARGO"))
        .args(["test", "--offline", "--profile", profile])
        .args(["--config", "profile.dev.debug=false"])
        .args(["--config", "profile.dev.lto=\"off\""])
        .current_dir(&project)
        .env("CARGO_TARGET_DIR", folder.parent().unwrap())
        .env("PROTEAN", PROTEAN)
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, errors) = (text(&tested.stdout), text(&tested.stderr));
    assert!(tested.status.success(), "{out}{errors}");
    assert!(
        out.contains("the_robot_reaches_its_goal_twice_with_the_digest_of_the_readme ... ok"),
        "{out}"
    );
    std::fs::read(folder.join("my_planner")).unwrap()
});

/// A new project with its program, where `cargo build --release` puts it.
fn project() -> Sandbox {
    use std::os::unix::fs::PermissionsExt as _;
    let sandbox = new_project();
    let program = sandbox.file("my_planner/target/release/my_planner", &*PROGRAM);
    std::fs::set_permissions(program, std::fs::Permissions::from_mode(0o755)).unwrap();
    sandbox
}

#[test]
fn a_new_project_is_the_example() {
    let sandbox = new_project();
    let (made, example) = (
        sandbox.path().join("my_planner"),
        root().join("examples/external_planner"),
    );
    assert_eq!(files(&made), files(&example));
    for path in files(&made) {
        let read = |folder: &Path| std::fs::read_to_string(folder.join(&path)).unwrap();
        let (made, example) = (read(&made), read(&example));
        let changed = made.lines().zip(example.lines()).filter(|(a, b)| a != b);
        let expected = usize::from(path == Path::new("Cargo.toml"));
        assert_eq!(changed.count(), expected, "{}", path.display());
    }
    let again = sandbox.protean(["new", "my_planner", "--rust"]).run();
    again.refused(2, &["my_planner/Cargo.toml exists", "--force"]);
    let refused = sandbox.protean(["new", "my planner", "--rust"]).run();
    refused.refused(2, &["my planner", "begins with a letter"]);
}

#[test]
fn a_planner_in_a_project_of_its_own_can_do_what_the_built_in_ones_can() {
    let sandbox = project();
    let call = |words: &[&str]| sandbox.call(PROTEAN.as_ref()).args(words.iter().copied());
    // From another folder than that of the scenario.
    let hall = "my_planner/hall.toml";
    let checked = call(&["check", hall]).run();
    assert_eq!(checked.code, Some(0), "{checked}");
    assert!(
        checked.stdout.contains("target/release/my_planner (in "),
        "{checked}"
    );
    let run = |words: &[&str]| {
        call(&["run", hall, "--allow-external", "--seed", "1"])
            .args(words.iter().copied())
            .json()
    };
    let (first, second) = (run(&["--out", "hall.mcap"]), run(&["--out", "again.mcap"]));
    assert_eq!(first["robots"][0]["outcome"], "goal_reached", "{first}");
    assert_eq!(first["digest"], second["digest"]);
    let hops: Vec<&String> = first["latency_us"].as_object().unwrap().keys().collect();
    assert!(hops.iter().any(|hop| *hop == "my_planner step"), "{hops:?}");
    assert!(!hops.iter().any(|hop| hop.contains("external")), "{hops:?}");

    let verified = call(&["verify", "hall.mcap", "--allow-external"]).json();
    assert_eq!(verified["same"], true, "{verified}");
    let test = ["replay", "hall.mcap", "--test", "my_planner"];
    let tested = call(&test).arg("--allow-external").json();
    assert_eq!(tested["identical"], true, "{tested}");

    let sweep = ["sweep", "my_planner/sweep.toml", "--allow-external"];
    call(&sweep).args(["--quiet", "--out", "results"]).json();
    let digests = digests(&sandbox.path().join("results/results.csv"));
    assert_eq!(digests.len(), 4);
    assert!(digests[0] != digests[2], "the parameter has no effect");
    sandbox.assert_nothing_left();
}

#[test]
fn faults_of_a_planner_in_a_project_of_its_own_are_named() {
    let sandbox = project();
    let fails = |change: &str, words: &[&str]| {
        let run = ["run", "my_planner/hall.toml", "--allow-external", "--set"];
        sandbox.protean(run).arg(change).run().refused(1, words);
    };
    let look_ahead = "processes.my_planner.params.look_ahead=0";
    let words = [
        "process my_planner",
        "kind my_planner",
        "look_ahead",
        "above 0",
    ];
    fails(look_ahead, &words);
    let unknown = "processes.my_planner.params.speed=2";
    let words = ["parameters of my_planner", "`speed`", "`look_ahead`"];
    fails(unknown, &words);
    let missing = r#"processes.my_planner.command=["target/debug/my_planner"]"#;
    let run = ["run", "my_planner/hall.toml", "--allow-external", "--set"];
    let words = [
        "process my_planner",
        "/target/debug/my_planner: No such file",
    ];
    sandbox.protean(run).arg(missing).run().refused(2, &words);

    let program = sandbox.path().join("my_planner/target/release/my_planner");
    let alone = sandbox.call(&program).run();
    alone.refused(2, &["my_planner: drives", "command = "]);
    sandbox.assert_nothing_left();
}

#[test]
fn a_planner_in_a_project_of_its_own_that_is_killed_is_started_again() {
    let sandbox = project();
    let words = ["run", "my_planner/hall.toml", "--allow-external", "--json"];
    let running = sandbox
        .protean(words)
        .args(["--quiet", "--out", "run.mcap", "--real-time", "4"])
        .set("processes.my_planner.on_failure=restart")
        .set(PATIENCE)
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 20);
    sandbox.kill_and_await_successor("release/my_planner");
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    assert_eq!(summary["robots"][0]["outcome"], "goal_reached", "{summary}");
    assert_eq!(summary["processes"][0]["restarts"], 1, "{summary}");
    sandbox.assert_nothing_left();
}

#[test]
fn what_a_planner_needs_can_be_published() {
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--offline", "--no-deps", "--format-version=1"])
        .current_dir(root())
        .output()
        .unwrap();
    let metadata: Json = serde_json::from_slice(&metadata.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    // An empty list of registries: `publish = false`.
    let published = |name: &Json| {
        let mut all = packages.iter();
        all.any(|package| package["name"] == *name && package["publish"].is_null())
    };
    assert!(published(&"protean-planner".into()));
    for package in packages
        .iter()
        .filter(|package| published(&package["name"]))
    {
        let name = package["name"].as_str().unwrap();
        assert!(name.starts_with("protean-"), "{name} may be taken");
        for key in ["description", "license", "repository", "readme"] {
            assert!(package[key].is_string(), "{name} has no {key}");
        }
        assert!(
            !package["keywords"].as_array().unwrap().is_empty(),
            "{name}"
        );
        for dependency in package["dependencies"].as_array().unwrap() {
            let needed = &dependency["name"];
            if dependency["path"].is_string() && dependency["kind"] != "dev" {
                assert!(published(needed), "{name} needs {needed}");
                let version = package["version"].as_str().unwrap();
                assert_eq!(dependency["req"], format!("^{version}"), "{name}: {needed}");
            }
        }
    }
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
