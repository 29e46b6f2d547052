//! Fault injection: a process of a mission is killed or paused at a tick, or in its start-up, drawn from a seed.
//!
//! Faults of the orchestrator are in `supervision/orchestrator.rs`, processes that hang in `lifecycle.rs`, restarts in
//! `supervision.rs`.

use rustix::process::Signal;
use serde_json::Value as Json;

use crate::support::call::{Call, PATIENCE};
use crate::support::sandbox::{signal, stop};
use crate::support::{Sandbox, wait_for_tick};

/// A fault of one process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// SIGKILL: the run ends and names the process.
    Kill,
    /// SIGSTOP, then SIGCONT: the history stays the same.
    Pause,
}

/// Starts a run, injects a fault into one of its processes once this many ticks are posted (0: as soon as it exists),
/// and asserts the guarantees. `target` waits for the process and returns its id.
#[track_caller]
pub fn inject(
    sandbox: &Sandbox,
    call: Call<'_>,
    (fault, name, tick): (Fault, &str, u64),
    target: impl Fn() -> u32,
    digest: &Json,
) {
    let known = sandbox.runs();
    let words = ["--json", "--quiet", "--force", "--out", "run.mcap"];
    let running = call.args(words).set(PATIENCE).start();
    let run = sandbox.next_run(&known);
    if tick > 0 {
        wait_for_tick(&run, tick);
    }
    let pid = target();
    match fault {
        Fault::Kill => signal(pid, Signal::KILL),
        Fault::Pause => {
            stop(pid);
            signal(pid, Signal::CONT);
        }
    }
    let outcome = running.finish();
    let at = format!("{fault:?} of {name} at tick {tick}");
    match fault {
        // Its failure shows that the run had not ended.
        Fault::Kill => outcome.refused(1, &["error: process ", name, "was ended by signal 9"]),
        Fault::Pause => {
            assert_eq!(outcome.code, Some(0), "{at}: {outcome}");
            assert_eq!(outcome.json()["digest"], *digest, "{at}");
        }
    }
    sandbox.assert_nothing_left();
    if tick > 0 {
        let info = sandbox.protean(["info", "run.mcap"]).run();
        assert_eq!(info.code, Some(0), "{at}: {info}");
    }
}

#[test]
fn processes_that_are_killed_or_paused_keep_every_guarantee() {
    const FAULTS: u64 = 8;
    /// Ticks before the half of the mission.
    const TICKS: u64 = 150;
    let names = [
        "simulator",
        "perception",
        "pursuer_police_1",
        "pursuer_police_2",
        "evader_potential_evader_1",
    ];
    let sandbox = Sandbox::new();
    // So slow that no fault comes after its end.
    let words = ["run", "chase", "--set", "run.dt=0.01", "--pace", "2"];
    let call = || sandbox.protean(words).set("rules.time_limit=3");
    let digest = call().arg("--quiet").json()["digest"].clone();
    let mut random = 20_261_128_u64;
    let mut below = |count: u64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 33) % count
    };
    for number in 0..FAULTS {
        let fault = [Fault::Kill, Fault::Pause][(number % 2) as usize];
        let name = names[below(names.len() as u64) as usize];
        // Every other kill is in the start-up.
        let tick = if number % 4 == 0 { 0 } else { 1 + below(TICKS) };
        let target = || sandbox.process(name).pid;
        inject(&sandbox, call(), (fault, name, tick), target, &digest);
    }
}
