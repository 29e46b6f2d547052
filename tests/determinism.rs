//! Negative controls of determinism: each check of guarantee 1 is seen to fail.
//!
//! `controls/` is a program with a planner that breaks a rule on demand. `tools/determinism` makes the table of evidence
//! of `docs/reference/determinism.md`.

mod sources;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::support::call::Call;
use crate::support::{PROTEAN, Sandbox, skipped};

/// The program with a planner that breaks rules.
const CONTROLS: &str = env!("CARGO_BIN_EXE_controls_under_test");
const MISSION: &str = include_str!("controls/mission.toml");
/// Rules whose breach shows on any machine, in any two runs.
const BREACHES: [&str; 3] = ["clock", "hash_map", "thread_order"];

/// A sandbox with the mission whose planner breaks a rule, and the log `a.mcap` of a run with processes.
fn recorded(breach: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    let breach = format!("kind = \"suspect\"\nparams = {{ breach = \"{breach}\" }}");
    let mission = MISSION.replace("kind = \"suspect\"", &breach);
    assert_ne!(mission, MISSION);
    sandbox.file("mission.toml", mission);
    call(&sandbox, "run mission.toml --quiet --out a.mcap").json();
    sandbox
}

fn call<'a>(sandbox: &'a Sandbox, words: &str) -> Call<'a> {
    sandbox.call(CONTROLS.as_ref()).args(words.split(' '))
}

/// Asserts that a comparison names the planner as the only cause.
#[track_caller]
fn blames_the_planner(call: Call<'_>, what: &str) {
    let compared = call.arg("--json").run();
    assert_eq!(compared.code, Some(1), "{what}: {compared}");
    let first = &compared.json()["first"];
    let causes = first["causes"].as_array().unwrap();
    assert_eq!(causes.len(), 1, "{what}: {compared}");
    assert_eq!(causes[0]["process"], "suspect", "{what}: {compared}");
    assert_eq!(causes[0]["field"], "omega", "{what}: {compared}");
}

#[test]
fn a_planner_that_breaks_a_rule_fails_every_comparison_and_is_named() {
    for breach in BREACHES {
        let sandbox = recorded(breach);
        let again = call(&sandbox, "run mission.toml --quiet --out b.mcap").json();
        let info = call(&sandbox, "info a.mcap").json();
        assert_ne!(again["digest"], info["digest"], "{breach}");
        assert!(info["digest"].is_string(), "{breach}: {info}");
        for words in ["verify a.mcap", "verify a.mcap --in-process"] {
            let verified = call(&sandbox, words).run();
            assert_eq!(verified.code, Some(1), "{breach}: {verified}");
            let told = verified
                .stdout
                .contains("cause      suspect, robot/command");
            assert!(told, "{breach}: {verified}");
        }
        let tested = call(&sandbox, "replay a.mcap --test suspect").run();
        assert_eq!(tested.code, Some(1), "{breach}: {tested}");
        // The robot that flees has its own process: an effect, not a cause.
        let tested = call(&sandbox, "replay a.mcap --test evader_potential").run();
        assert_eq!(tested.code, Some(0), "{breach}: {tested}");
        for words in ["diff a.mcap b.mcap", "diff a.mcap mission.toml"] {
            blames_the_planner(call(&sandbox, words), breach);
        }
    }
}

#[test]
fn a_planner_that_breaks_no_rule_passes_every_comparison() {
    let sandbox = recorded("none");
    for words in [
        "verify a.mcap",
        "verify a.mcap --in-process",
        "replay a.mcap --test suspect",
        "diff a.mcap mission.toml",
    ] {
        let same = call(&sandbox, words).run();
        assert_eq!(same.code, Some(0), "{same}");
    }
}

/// The library that inverts the last bit of the C library's elementary functions; `None`, and a note on stderr, without
/// a compiler.
fn last_bit() -> Option<&'static str> {
    static LIBRARY: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let library = LIBRARY.get_or_init(|| {
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/controls/last_bit.c");
        let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join("last_bit.so");
        let output = Command::new("cc")
            .args(["-shared", "-fPIC", "-fno-builtin", "-o"])
            .args([&library, Path::new(source)])
            .arg("-ldl")
            .output()
            .map_err(|error| format!("cc: {error}"))?;
        if output.status.success() {
            Ok(library)
        } else {
            Err(String::from_utf8_lossy(&output.stderr).into_owned())
        }
    });
    match library {
        Ok(library) => library.to_str(),
        Err(why) => {
            skipped("another C library", why);
            None
        }
    }
}

/// The same call with a C library whose elementary functions have other last bits.
fn with_other_c_library<'a>(call: Call<'a>, library: &str) -> Call<'a> {
    call.through("env", &[&format!("LD_PRELOAD={library}")])
}

#[test]
fn a_planner_with_the_sine_of_the_c_library_fails_with_another_c_library() {
    let Some(library) = last_bit() else { return };
    let sandbox = recorded("native_sine");
    let other = |words| with_other_c_library(call(&sandbox, words), library);
    for words in ["verify a.mcap", "verify a.mcap --in-process"] {
        let same = call(&sandbox, words).run();
        assert_eq!(same.code, Some(0), "{same}");
        let differs = other(words).run();
        assert_eq!(differs.code, Some(1), "{differs}");
    }
    blames_the_planner(other("diff a.mcap mission.toml"), "native_sine");
}

#[test]
fn the_tool_for_evidence_names_surroundings_and_process() {
    let sandbox = Sandbox::new();
    let tool = concat!(env!("CARGO_MANIFEST_DIR"), "/../tools/determinism");
    let output = Command::new("python3")
        .args([tool, "--control", "native_sine", "--program", CONTROLS])
        .current_dir(sandbox.path())
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) => return skipped("tools/determinism", &error.to_string()),
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(
        out.contains("| processes, one core | 1 | 0 | 0 |"),
        "{out}{errors}"
    );
    let other = "| one thread, C library with other last bits of `sin`, `exp`, … | 1 | 1 | 0 |";
    if last_bit().is_some() {
        assert!(out.contains(other), "{out}{errors}");
        assert!(out.contains("cause      suspect, robot/command: omega of hunter"));
        assert_eq!(output.status.code(), Some(1), "{out}{errors}");
    }
}

#[test]
fn no_built_in_scenario_computes_with_the_c_library() {
    let Some(library) = last_bit() else { return };
    let sandbox = Sandbox::new();
    // Its digests are those of the goldens; parts of the missions suffice to call every function.
    for scenario in scenario::builtin::SCENARIOS {
        let words = ["run", scenario.name, "--in-process", "--quiet"];
        let run = || {
            let call = sandbox.call(PROTEAN.as_ref()).args(words);
            call.set("rules.time_limit=3")
        };
        let other = with_other_c_library(run(), library).json();
        assert_eq!(other["digest"], run().json()["digest"], "{}", scenario.name);
    }
}

/// Items that `clippy.toml` disallows under a key.
fn disallowed(key: &str) -> Vec<String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../clippy.toml");
    let text = std::fs::read_to_string(file).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let items = table[key].as_array().unwrap().iter();
    items
        .map(|item| item["path"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn clippy_finds_every_disallowed_function_and_type_in_a_planted_source() {
    let (functions, types) = (
        disallowed("disallowed-methods"),
        disallowed("disallowed-types"),
    );
    for (list, item) in [
        (&functions, "f64::sin"),
        (&functions, "f64::mul_add"),
        (&types, "std::collections::HashMap"),
    ] {
        assert!(list.iter().any(|path| path == item), "{item}: {list:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let mut planted = "#![crate_type = \"lib\"]\n".to_owned();
    for (number, path) in functions.iter().enumerate() {
        planted += &format!("pub fn function_{number}() {{ let _ = {path}; }}\n");
    }
    for path in &types {
        planted += &format!("pub use {path};\n");
    }
    let source = folder.path().join("planted.rs");
    std::fs::write(&source, planted).unwrap();
    let output = Command::new("clippy-driver")
        .args(["--edition", "2024", "--emit=metadata", "--out-dir"])
        .args([folder.path(), &source])
        .env(
            "CLIPPY_CONF_DIR",
            Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
        )
        .output();
    let output = match output {
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => return skipped("Clippy on a planted source", &error.to_string()),
    };
    for path in functions.iter().chain(&types) {
        let found = output.contains(&format!("of a disallowed method `{path}`"))
            || output.contains(&format!("of a disallowed type `{path}`"));
        assert!(found, "{path} is not found:\n{output}");
    }
}
