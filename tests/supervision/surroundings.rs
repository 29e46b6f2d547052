//! Environments of the orchestrator: it works with any descriptors, signals and files that it inherits.

use std::collections::BTreeSet;

use rustix::process::Signal;

use super::disk::ENDLESS;
use crate::support::call::PATIENCE;
use crate::support::sandbox::signal;
use crate::support::{PROTEAN, SOON, Sandbox, until, wait_for_tick};

#[test]
fn a_terminal_that_is_closed_ends_the_run_in_order() {
    let sandbox = Sandbox::new();
    let mut known = BTreeSet::new();
    for ending in [Signal::HUP, Signal::QUIT] {
        let words = ENDLESS.iter().copied().chain(["run.mcap", "--force"]);
        let running = sandbox.protean(words).start();
        let run = sandbox.next_run(&known);
        known.insert(run.clone());
        wait_for_tick(&run, 10);
        running.signal(ending);
        let outcome = running.finish();
        assert_eq!(outcome.code, Some(3), "{outcome}");
        sandbox.assert_nothing_left();
    }
}

#[test]
fn a_program_that_is_replaced_in_the_middle_of_its_run_starts_itself_again() {
    let sandbox = Sandbox::new();
    let file = sandbox.path().join("protean");
    std::fs::copy(PROTEAN, &file).unwrap();
    let running = sandbox
        .protean(["run", "chase", "--quiet", "--real-time", "1"])
        .set("rules.time_limit=600")
        .set("processes.pursuer.on_failure=restart")
        .set(PATIENCE)
        .through("sh", &["-c", "shift; exec ./protean \"$@\"", "sh"])
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 2);
    std::fs::remove_file(&file).unwrap();
    // What is at its place now is another program.
    sandbox.file("protean", "#!/bin/sh\nexit 9\n");
    super::replace(&sandbox, &run, "pursuer_police_1", 2);
    running.signal(Signal::INT);
    let outcome = running.finish();
    // A process failed and was restarted.
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(
        outcome.stderr.contains("pursuer_police_1 rejoined the run"),
        "{outcome}"
    );
    std::fs::remove_file(&file).unwrap();
    sandbox.assert_nothing_left();
}

#[test]
fn a_result_that_cannot_be_written_is_told() {
    let sandbox = Sandbox::new();
    let full = ["-c", "exec \"$@\" > /dev/full", "sh"];
    for words in [&["list", "--json"][..], &["schema", "scenario"]] {
        let outcome = sandbox.protean(words.iter().copied()).through("sh", &full);
        let words = ["error: cannot write the result to stdout: No space left on device"];
        outcome.run().refused(1, &words);
    }
}

#[test]
fn when_clean_has_returned_those_that_it_killed_are_gone() {
    let sandbox = Sandbox::new();
    let running = sandbox
        .protean(ENDLESS.iter().copied().chain(["run.mcap"]))
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 5);
    // Stopped, they do not end by themselves.
    for process in sandbox.processes() {
        if process.pid != running.pid() {
            signal(process.pid, Signal::STOP);
        }
    }
    running.signal(Signal::KILL);
    running.finish();
    let cleaned = until("a run that is dead", SOON, || {
        let cleaned = sandbox.protean(["clean"]).json();
        let root = sandbox.runtime_dir().join("protean").join(&run);
        let is_removed = |found: &serde_json::Value| {
            found["run"] == root.to_str().unwrap() && found["state"] == "removed"
        };
        let runs = cleaned["runs"].as_array().unwrap();
        runs.iter().any(is_removed).then_some(cleaned.clone())
    });
    assert_eq!(sandbox.processes(), [], "{cleaned}");
    sandbox.assert_nothing_left();
}

#[test]
fn a_run_that_is_started_with_sigchld_ignored_knows_the_ends_of_its_processes() {
    let sandbox = Sandbox::new();
    let words = ["run", "hello", "--quiet", "--set", PATIENCE];
    let call = sandbox
        .protean(words)
        .through("env", &["--ignore-signal=CHLD"]);
    let outcome = call.run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(outcome.stderr, "", "{outcome}");
    sandbox.assert_nothing_left();
}
