//! Processes that never execute their program: they are named or ended as others that are not ready.

use rustix::process::Signal;

use super::{Fate, Injection, injected, injector};
use crate::support::call::Running;
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, until};

/// The call with which the second process of a run executes its program, after the program itself and the simulator.
const HELD: Injection = Injection {
    calls: "execve",
    number: 3,
    fate: Fate::Hang,
};

/// Starts a run whose second process is held between fork and exec; returns the id of its orchestrator.
fn start<'a>(sandbox: &'a Sandbox, more: &'a str) -> Option<(Running<'a>, u32)> {
    let words = [
        "run", "hello", "--quiet", "--out", "run.mcap", "--set", more,
    ];
    start_words(sandbox, &words)
}

fn start_words<'a>(sandbox: &'a Sandbox, words: &[&'a str]) -> Option<(Running<'a>, u32)> {
    let known = sandbox.runs();
    let words = words.iter().copied();
    let running = injected(sandbox.protean(words), injector()?, HELD).start();
    sandbox.next_run(&known);
    let report = sandbox.path().join("report");
    until("a process that is held", SOON, || {
        std::fs::read(&report)
            .is_ok_and(|text| !text.is_empty())
            .then_some(())
    });
    let children = format!("/proc/{0}/task/{0}/children", running.pid());
    let children = std::fs::read_to_string(children).unwrap();
    Some((running, children.trim().parse().unwrap()))
}

#[test]
fn a_process_that_never_executes_its_program_is_named_after_the_ready_timeout() {
    let sandbox = Sandbox::new();
    let Some((running, _)) = start(&sandbox, "run.ready_timeout_s=2") else {
        return;
    };
    let words = ["error: process evader_potential was not ready within 2s"];
    running.finish().refused(1, &words);
    sandbox.assert_nothing_left();
}

#[test]
fn ctrl_c_ends_a_run_whose_process_never_executes_its_program() {
    let sandbox = Sandbox::new();
    let Some((running, orchestrator)) = start(&sandbox, "run.seed=1") else {
        return;
    };
    signal(orchestrator, Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    sandbox.assert_nothing_left();
}

#[test]
fn sigterm_ends_a_verification_whose_process_never_executes_its_program() {
    let sandbox = Sandbox::new();
    sandbox.record("hello");
    let Some((running, orchestrator)) = start_words(&sandbox, &["verify", "run.mcap"]) else {
        return;
    };
    signal(orchestrator, Signal::TERM);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    sandbox.assert_nothing_left();
}

#[test]
fn a_process_that_never_executes_its_program_ends_with_its_orchestrator() {
    let sandbox = Sandbox::new();
    let Some((running, orchestrator)) = start(&sandbox, "run.seed=1") else {
        return;
    };
    signal(orchestrator, Signal::KILL);
    running.finish();
    let cleaned = sandbox.protean(["clean"]).json();
    assert_eq!(cleaned["runs"][0]["state"], "removed", "{cleaned}");
    sandbox.assert_nothing_left();
}
