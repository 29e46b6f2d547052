//! A killed orchestrator: none of its processes survives it, and its log lacks at most one second.

use std::collections::BTreeSet;
use std::ops::Range;
use std::time::{Duration, Instant};

use runtime::lockstep::TickBarrier;
use rustix::process::Signal;

use crate::support::history::History;
use crate::support::sandbox::{signal, stop};
use crate::support::{SOON, Sandbox, python, until, wait_for_tick};

/// Longest part of the log that a killed orchestrator may lose.
const LOST: Duration = Duration::from_secs(1);

const LONG: [&str; 5] = ["run", "chase", "--set", "run.dt=0.0005", "--quiet"];

#[test]
fn processes_that_are_stopped_end_with_their_orchestrator_too() {
    let sandbox = Sandbox::new();
    let running = sandbox.protean(LONG).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 20);
    for name in ["perception", "pursuer_police_1", "simulator"] {
        signal(sandbox.process(name).pid, Signal::STOP);
    }
    running.signal(Signal::KILL);
    running.finish();
    until("the end of all processes", SOON, || {
        sandbox.processes().is_empty().then_some(())
    });
    sandbox.protean(["clean"]).json();
    sandbox.assert_nothing_left();
}

#[test]
fn a_killed_orchestrator_costs_the_log_a_second_at_most_and_recover_makes_it_whole() {
    costs_a_second_at_most(&LONG, 10, 0..2000);
}

#[test]
fn in_real_time_it_costs_no_more_however_slow_the_clock_is() {
    // A tick a second, and the last two wait for those that follow.
    let slow = ["run", "hello", "--real-time", "0.05", "--quiet"];
    costs_a_second_at_most(&slow, 4, 2200..4200);
}

/// Kills orchestrators of runs so many milliseconds after their first tick.
fn costs_a_second_at_most(words: &[&str], kills: u32, after_ms: Range<u64>) {
    let sandbox = Sandbox::new();
    let mut known = BTreeSet::new();
    let mut moment = 20_261_122_u64;
    for kill in 0..kills {
        let log = format!("{kill}.mcap");
        let call = sandbox.protean(words.iter().copied());
        let running = call.arg("--out").arg(&log).start();
        let run = sandbox.next_run(&known);
        known.insert(run.clone());
        wait_for_tick(&run, 1);
        let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
        moment = moment
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let after_ms = after_ms.start + (moment >> 33) % (after_ms.end - after_ms.start);
        let end = Instant::now() + Duration::from_millis(after_ms);
        // How far it was, and when that was known.
        let mut posts = vec![(Instant::now(), page.ticks_posted())];
        while Instant::now() < end {
            std::thread::park_timeout(Duration::from_millis(10));
            posts.push((Instant::now(), page.ticks_posted()));
        }
        let killed = Instant::now();
        running.signal(Signal::KILL);
        running.finish();
        sandbox.protean(["clean"]).json();
        let owed = posts
            .iter()
            .rev()
            .find(|(at, _)| killed.duration_since(*at) >= LOST)
            .map_or(0, |(_, posted)| *posted);
        let history = save(&sandbox, &log);
        for (tick, state) in (0..).zip(&history.states) {
            assert_eq!(state.tick, tick, "nothing is missing in between");
        }
        let kept = history.states.len() as u64;
        assert!(
            kept >= owed,
            "{kept} states of {owed} that are a second old"
        );
    }
    sandbox.assert_nothing_left();
}

/// Recovers the log of a run as if its orchestrator were killed now.
fn save(sandbox: &Sandbox, log: &str) -> History {
    let words = ["recover", log, "--out", "saved.mcap", "--force"];
    let recovered = sandbox.protean(words).run();
    assert!(matches!(recovered.code, Some(0 | 3)), "{recovered}");
    History::read(&sandbox.path().join("saved.mcap"))
}

/// The end of a run whose world has stood still.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Then {
    GoesOn,
    IsInterrupted,
    IsKilled,
}

#[test]
fn the_tick_in_which_the_world_stands_still_is_in_the_log_before_it_ends() {
    let sandbox = Sandbox::new();
    // 80 000 ticks: the run does not end before the test has looked at it.
    let words = [
        "run",
        "hello",
        "--quiet",
        "--set",
        "run.dt=0.0001",
        "--set",
        "rules.time_limit=8",
        "--set",
        "run.hang_timeout_s=300",
    ];
    let saved = sandbox.path().join("saved.mcap");
    let untouched = sandbox.protean(words).json();
    let mut known = sandbox.runs();
    for then in [Then::GoesOn, Then::IsInterrupted, Then::IsKilled] {
        let log = format!("{then:?}.mcap");
        let save = || save(&sandbox, &log);
        let running = sandbox
            .protean(words)
            .arg("--json")
            .arg("--out")
            .arg(&log)
            .start();
        let run = sandbox.next_run(&known);
        known.insert(run.clone());
        wait_for_tick(&run, 20);
        let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
        let planner = sandbox.process("evader_potential");
        stop(planner.pid);
        // Its slot is the one after the simulator's.
        until("a tick that it owes", SOON, || {
            (page.ticks_done(1) < page.ticks_posted()).then_some(())
        });
        let posted = page.ticks_posted();
        let history = until("the state in the log", SOON, || {
            let history = save();
            (history.states.len() as u64 >= posted).then_some(history)
        });
        assert_eq!(page.ticks_posted(), posted, "it stands still");
        for (tick, state) in (0..).zip(&history.states) {
            assert_eq!(state.tick, tick, "once each");
        }
        assert_eq!(history.states.len() as u64, posted);
        // It was stopped within its step, before or after it sent its command.
        let commands = history.commands.len() as u64;
        assert!((posted - 1..=posted).contains(&commands), "{commands}");
        if then == Then::IsKilled {
            running.signal(Signal::KILL);
            running.finish();
            sandbox.protean(["clean"]).json();
            // Heartbeats may have come since.
            let kept = save();
            assert_eq!(kept.states, history.states);
            assert_eq!(kept.commands, history.commands);
            if let Some(theirs) = python::read(&saved) {
                assert_eq!(theirs.history, kept);
            }
            continue;
        }
        if then == Then::IsInterrupted {
            running.signal(Signal::INT);
        }
        signal(planner.pid, Signal::CONT);
        let outcome = running.finish();
        let info = sandbox.protean(["info", &log]).json();
        assert_eq!(info["condition"]["faults"], serde_json::json!([]));
        if then == Then::GoesOn {
            let summary = outcome.json();
            assert_eq!(summary["digest"], untouched["digest"]);
            for topic in ["world/state", "robot/command", "robot/plan", "world/event"] {
                assert_eq!(summary["topics"][topic], untouched["topics"][topic]);
            }
            continue;
        }
        let log = sandbox.path().join(log);
        if let Some(theirs) = python::read(&log) {
            assert_eq!(theirs.history, History::read(&log));
        }
    }
    sandbox.assert_nothing_left();
}

#[test]
fn in_real_time_the_last_ticks_of_a_world_that_stands_still_are_in_the_log_too() {
    let sandbox = Sandbox::new();
    let words = ["run", "hello", "--quiet", "--real-time", "1"];
    let running = sandbox
        .protean(words)
        .set("run.hang_timeout_s=300")
        .arg("--out")
        .arg("run.mcap")
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 5);
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    stop(sandbox.process("simulator").pid);
    let posted = page.ticks_posted();
    let history = until("the state in the log", SOON, || {
        let history = save(&sandbox, "run.mcap");
        (history.states.len() as u64 >= posted).then_some(history)
    });
    running.signal(Signal::KILL);
    running.finish();
    sandbox.protean(["clean"]).json();
    // Planners may have answered the last posted tick meanwhile.
    assert_eq!(save(&sandbox, "run.mcap").states, history.states);
    sandbox.assert_nothing_left();
}
