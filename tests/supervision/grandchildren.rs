//! Descendants of an external program: they end with its run, also in sessions of their own.

use rustix::process::Signal;

use crate::support::call::Running;
use crate::support::programs::driven_by;
use crate::support::sandbox::{end_sleeping, signal, sleeping};
use crate::support::{SOON, Sandbox, until};

/// Starts three `sleep`s in sessions of their own, two of them without an environment, one of these an orphan.
const SCATTERED: &str = r#"command = ["/bin/sh", "-c", "setsid sleep TIME & setsid env -i sleep TIME & (setsid env -i sleep TIME &); wait"]"#;

/// A run whose program has started others.
struct Scattered<'a> {
    orchestrator: Running<'a>,
    /// Their argument, by which they are recognised: no other process sleeps that long.
    time: String,
}

impl<'a> Scattered<'a> {
    fn start(sandbox: &'a Sandbox, number: u32) -> Self {
        let time = format!("2000.{}{number:02}", std::process::id());
        let lines = SCATTERED.replace("TIME", &time);
        sandbox.file("scattered.toml", driven_by("scattered", &lines));
        let words = ["run", "scattered.toml", "--allow-external", "--quiet"];
        let it = Self {
            orchestrator: sandbox.protean(words).start(),
            time,
        };
        until("the sleepers", SOON, || {
            (sleeping(&it.time) == 3).then_some(())
        });
        it
    }
}

impl Drop for Scattered<'_> {
    fn drop(&mut self) {
        end_sleeping(&self.time);
    }
}

#[test]
fn they_end_with_the_run_when_it_is_interrupted() {
    let sandbox = Sandbox::new();
    let it = Scattered::start(&sandbox, 1);
    it.orchestrator.signal(Signal::INT);
    until("the end of all processes", SOON, || {
        sandbox.processes().is_empty().then_some(())
    });
    assert_eq!(sleeping(&it.time), 0);
    sandbox.assert_nothing_left();
}

#[test]
fn they_end_with_the_run_when_their_program_is_killed() {
    let sandbox = Sandbox::new();
    let it = Scattered::start(&sandbox, 2);
    let shell = until("the program", SOON, || {
        let mut all = sandbox.processes().into_iter();
        all.find(|process| process.name == "/bin/sh")
    });
    signal(shell.pid, Signal::KILL);
    until("the end of all processes", SOON, || {
        sandbox.processes().is_empty().then_some(())
    });
    assert_eq!(sleeping(&it.time), 0);
    sandbox.assert_nothing_left();
}

#[test]
fn after_the_orchestrator_was_killed_the_next_run_ends_those_with_the_environment_of_the_first() {
    let sandbox = Sandbox::new();
    let it = Scattered::start(&sandbox, 3);
    it.orchestrator.signal(Signal::KILL);
    let sleepers = |count: usize| {
        until("the end of all but some sleepers", SOON, || {
            (sandbox.processes().len() == count).then_some(())
        });
    };
    sleepers(1);
    let next = sandbox.protean(["run", "hello", "--quiet"]).run();
    assert_eq!(next.code, Some(0), "{next}");
    sleepers(0);
    assert_eq!(sleeping(&it.time), 2, "those without it");
    assert_eq!(sandbox.runs().len(), 2);
    sandbox.assert_nothing_left();
}

#[test]
fn children_that_the_orchestrator_had_before_are_left_alone() {
    let sandbox = Sandbox::new();
    let time = format!("2000.{}04", std::process::id());
    let lines = r#"command = ["false"]"#;
    sandbox.file("false.toml", driven_by("driver", lines));
    let words = ["run", "false.toml", "--allow-external", "--quiet"];
    let script = "sleep \"$0\" & exec \"$@\"";
    let call = sandbox.protean(words).through("sh", &["-c", script, &time]);
    let mut running = call.start();
    until("the end of the run", SOON, || {
        (!running.is_alive()).then_some(())
    });
    let left = sleeping(&time);
    end_sleeping(&time);
    let outcome = running.finish();
    assert_eq!(left, 1, "{outcome}");
    outcome.refused(1, &["error: process driver ended with exit code 1"]);
}
