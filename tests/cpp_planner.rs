//! A planner in C++: the project that `protean new --cpp` writes, as a library that the program loads.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::support::call::Call;
use crate::support::{PROTEAN, Sandbox, skipped};

/// The mission of the project.
const HALL: &str = "my_planner/hall.toml";

/// A new project in a sandbox.
fn new_project() -> Sandbox {
    let sandbox = Sandbox::new();
    let made = sandbox.protean(["new", "my_planner", "--cpp"]).run();
    assert_eq!(made.code, Some(0), "{made}");
    let next = format!("next: cd my_planner && make && {PROTEAN} run hall.toml --allow-external");
    assert!(made.stderr.contains(&next), "{made}");
    sandbox
}

/// The library of a new project, built and tested by its own test once for all tests; the reason without a compiler.
static LIBRARY: LazyLock<Result<Vec<u8>, String>> = LazyLock::new(|| {
    for tool in ["make", "g++"] {
        let version = Command::new(tool).arg("--version").output();
        version.map_err(|error| format!("{tool}: {error}"))?;
    }
    let sandbox = new_project();
    let project = sandbox.path().join("my_planner");
    let tested = Command::new("make")
        .args(["test", "CXXFLAGS=-O2 -Wall -Wextra -Wpedantic -Werror"])
        .current_dir(&project)
        .env("PROTEAN", PROTEAN)
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, errors) = (text(&tested.stdout), text(&tested.stderr));
    assert!(tested.status.success(), "{out}{errors}");
    assert!(out.contains("ok: "), "{out}");
    sandbox.assert_nothing_left();
    Ok(std::fs::read(project.join("build/planner.so")).unwrap())
});

/// A new project with its library; `None`, and a note on stderr, without a compiler.
fn project() -> Option<Sandbox> {
    match &*LIBRARY {
        Ok(library) => {
            let sandbox = new_project();
            sandbox.file("my_planner/build/planner.so", library);
            Some(sandbox)
        }
        Err(reason) => {
            skipped("the planner in C++", reason);
            None
        }
    }
}

fn run(sandbox: &Sandbox) -> Call<'_> {
    sandbox.protean(["run", HALL, "--allow-external", "--seed", "1"])
}

/// The digest in the README of an example.
fn readme_digest(example: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let text = std::fs::read_to_string(root.join(example).join("README.md")).unwrap();
    let block = text.split("```text\n").nth(1).unwrap();
    block.lines().next().unwrap().to_owned()
}

#[test]
fn a_planner_in_cpp_has_the_digest_of_the_same_planner_in_rust() {
    let Some(sandbox) = project() else { return };
    let summary = run(&sandbox).args(["--out", "hall.mcap"]).json();
    assert_eq!(summary["robots"][0]["outcome"], "goal_reached", "{summary}");
    assert_eq!(summary["digest"], readme_digest("cpp_planner"), "{summary}");
    assert_eq!(summary["digest"], readme_digest("external_planner"));
    let hops = summary["latency_us"].as_object().unwrap();
    assert!(hops.contains_key("my_planner step"), "{summary}");
    // Again, against the log, and from another folder.
    let verified = sandbox
        .protean(["verify", "hall.mcap", "--allow-external"])
        .json();
    assert_eq!(verified["same"], true, "{verified}");
    let test = [
        "replay",
        "hall.mcap",
        "--test",
        "my_planner",
        "--allow-external",
    ];
    let tested = sandbox.protean(test).json();
    assert_eq!(tested["identical"], true, "{tested}");
    sandbox.assert_nothing_left();
}

#[test]
fn faults_of_a_planner_in_cpp_are_named() {
    let Some(sandbox) = project() else { return };
    let fails = |change: &str, words: &[&str]| run(&sandbox).set(change).run().refused(1, words);
    let params = "parameters of my_planner (kind library)";
    fails(
        "processes.my_planner.params.look_ahead=0",
        &[params, "`look_ahead` must be a number above 0 (m)"],
    );
    fails(
        "processes.my_planner.params.margin='wide'",
        &[params, "`margin` is \"wide\": expected a number"],
    );
    fails(
        "processes.my_planner.params.speed=2",
        &[
            params,
            "unknown parameter `speed`",
            "`arrived`, `look_ahead`, `margin`",
        ],
    );
    let library = |file: &str, words: &[&str]| {
        let change = format!(r#"processes.my_planner.command=["protean", "planner", "{file}"]"#);
        fails(&change, words);
    };
    library(
        "build/absent.so",
        &[
            "build/absent.so: cannot be read: No such file",
            "expected the shared library of a planner",
        ],
    );
    library(
        "hall.toml",
        &["hall.toml: ", "expected the shared library of a planner"],
    );
    let refused = sandbox.protean(["run", HALL]).run();
    refused.refused(2, &["--allow-external", "protean planner build/planner.so"]);
    sandbox.assert_nothing_left();
}

#[test]
fn a_library_that_no_run_loads_says_how_to_use_it() {
    let Some(sandbox) = project() else { return };
    let file: PathBuf = sandbox.path().join("my_planner/build/planner.so");
    let alone = sandbox.protean(["planner", file.to_str().unwrap()]).run();
    alone.refused(
        2,
        &[
            "planner.so: a planner that reads no further inputs",
            "command = [\"protean\", \"planner\"",
        ],
    );
}

#[test]
fn the_header_is_printed() {
    let sandbox = Sandbox::new();
    let printed = |subject: &str| sandbox.protean(["schema", subject]).run();
    let header = printed("planner");
    let example =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cpp_planner/protean_planner.h");
    assert_eq!(
        header.stdout,
        std::fs::read_to_string(example).unwrap(),
        "{header}"
    );
}

#[test]
fn the_next_step_of_a_new_project_works_as_printed_without_a_terminal() {
    let Some(sandbox) = project() else { return };
    let printed = sandbox
        .protean(["new", "my_planner", "--cpp", "--force"])
        .run();
    let next = printed.stderr.trim().strip_prefix("next: ").unwrap();
    let done = sandbox.call("/bin/sh".as_ref()).args(["-c", next]).run();
    assert_eq!(done.code, Some(0), "{done}");
    sandbox.assert_nothing_left();
}
