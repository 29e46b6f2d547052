//! However a run ends, it ends: in order, with a log that can be read, and with nothing left of it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::support::call::{PATIENCE, Running};
use crate::support::history::History;
use crate::support::programs::driven_by;
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, python, until, wait_for_tick};
use rustix::process::Signal;

/// A chase with ticks so short that it lasts until it is ended.
const LONG: [&str; 5] = ["run", "chase", "--set", "run.dt=0.0005", "--out"];

/// Starts a chase and waits until this many ticks have been posted; returns the run's name.
fn in_the_air<'a>(sandbox: &'a Sandbox, more: &[&'a str], ticks: u64) -> (Running<'a>, String) {
    let known = sandbox.runs();
    let words = LONG
        .iter()
        .copied()
        .chain(["run.mcap", "--set", PATIENCE])
        .chain(more.iter().copied());
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&known);
    wait_for_tick(&run, ticks);
    (running, run)
}

fn log(sandbox: &Sandbox) -> PathBuf {
    sandbox.path().join("run.mcap")
}

/// A log of a run that did not get to its end: whole, with a state of every tick from the first.
#[track_caller]
fn assert_readable(path: &Path, at_least: u64) -> History {
    let history = History::read(path);
    for (tick, state) in history.states.iter().enumerate() {
        assert_eq!((state.tick, state.over), (tick as u64, false));
        let driven = state.robots.iter().all(|robot| !robot.fail_safe);
        assert!(
            driven,
            "tick {tick}: the world went on without its planners: {state:?}"
        );
    }
    assert!(
        history.states.len() as u64 >= at_least,
        "{} states",
        history.states.len()
    );
    history
}

#[test]
fn ctrl_c_ends_a_run_in_order() {
    let sandbox = Sandbox::new();
    let (running, _) = in_the_air(&sandbox, &["--json"], 100);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    assert_eq!(summary["interrupted"], true);
    let history = assert_readable(&log(&sandbox), 90);
    assert_eq!(summary["ticks"], history.states.last().unwrap().tick);
    assert_eq!(
        summary["topics"]["world/state"]["messages"],
        history.states.len()
    );
    for robot in summary["robots"].as_array().unwrap() {
        assert_eq!(robot["outcome"], "active", "{robot}");
    }
    sandbox.assert_nothing_left();
    if let Some(read) = python::read(&log(&sandbox)) {
        assert_eq!(read.history, history);
    }
}

#[test]
fn sigterm_and_people_get_the_same() {
    let sandbox = Sandbox::new();
    let (running, _) = in_the_air(&sandbox, &[], 20);
    running.signal(Signal::TERM);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    for word in ["interrupted", "digest", "run.mcap", "police_1"] {
        assert!(outcome.stdout.contains(word), "{word}: {outcome}");
    }
    assert_readable(&log(&sandbox), 20);
    sandbox.assert_nothing_left();
}

#[test]
fn ctrl_c_before_the_first_tick_ends_a_run_too() {
    let sandbox = Sandbox::new();
    let running = sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .start();
    // The run directory appears before any process is started.
    sandbox.next_run(&BTreeSet::new());
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(
        !log(&sandbox).exists(),
        "a run that never began leaves no log"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn a_real_time_run_ends_by_ctrl_c() {
    let sandbox = Sandbox::new();
    let words = ["run", "hello", "--real-time", "--out", "run.mcap", "--json"];
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 5);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert_eq!(outcome.json()["interrupted"], true);
    assert_readable(&log(&sandbox), 4);
    sandbox.assert_nothing_left();
}

/// States in a log without an end, which holds everything up to the last flush.
fn states_of_torn(path: &Path) -> usize {
    let torn = std::fs::read(path).unwrap();
    let options = mcap::read::Options::IgnoreEndMagic;
    mcap::MessageStream::new_with_options(&torn, options.into()).map_or(0, |messages| {
        messages
            .map_while(Result::ok)
            .filter(|m| m.channel.topic == "world/state")
            .count()
    })
}

/// Kills the orchestrator and waits until none of its processes lives.
fn kill_the_orchestrator(sandbox: &Sandbox) -> String {
    let (running, run) = in_the_air(sandbox, &[], 50);
    assert!(sandbox.processes().len() >= 9, "{:?}", sandbox.processes());
    // The log is flushed once per interval of wall time: fifty ticks may pass before the first flush.
    until("states in the log", SOON, || {
        (states_of_torn(&log(sandbox)) > 0).then_some(())
    });
    running.signal(Signal::KILL);
    let outcome = running.finish();
    assert_eq!((outcome.code, &*outcome.stdout), (None, ""), "{outcome}");
    until("the end of all processes", SOON, || {
        sandbox.processes().is_empty().then_some(())
    });
    let left = sandbox.runtime_files();
    assert!(left.iter().any(|path| path.ends_with(&run)), "{left:?}");
    run
}

#[test]
fn processes_end_with_a_killed_orchestrator_and_clean_removes_the_rest() {
    let sandbox = Sandbox::new();
    let run = kill_the_orchestrator(&sandbox);
    let cleaned = sandbox.protean(["clean"]).json();
    let root = sandbox.runtime_dir().join("protean").join(&run);
    assert_eq!(
        cleaned["runs"][0]["run"],
        root.to_str().unwrap(),
        "{cleaned}"
    );
    assert_eq!(cleaned["runs"][0]["state"], "removed");
    sandbox.assert_nothing_left();
    let again = sandbox.protean(["clean"]).run();
    // Of other tests there may be something.
    assert_eq!(again.code, Some(0), "{again}");
    assert!(!again.stdout.contains(&run), "{again}");
}

#[test]
fn the_next_run_cleans_up_after_a_killed_orchestrator() {
    let sandbox = Sandbox::new();
    kill_the_orchestrator(&sandbox);
    let torn = std::fs::read(log(&sandbox)).unwrap();
    let outcome = sandbox.protean(["run", "hello", "--quiet"]).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(sandbox.runs().len(), 2);
    sandbox.assert_nothing_left();
    assert_eq!(
        std::fs::read(log(&sandbox)).unwrap(),
        torn,
        "the log is not cleaned away"
    );
    assert!(states_of_torn(&log(&sandbox)) > 0);
}

/// Never answers and has started another process in its own session.
const STUBBORN: &str = r#"command = ["/bin/sh", "-c", "setsid sleep 1000 & wait"]"#;

#[test]
fn clean_kills_what_outlived_its_orchestrator_and_leaves_living_runs_alone() {
    let sandbox = Sandbox::new();
    let (alive, alive_run) = in_the_air(&sandbox, &[], 10);
    let (before, known) = (sandbox.processes(), sandbox.runs());
    let others = || {
        let mut rest = sandbox.processes();
        rest.retain(|p| !before.contains(p));
        rest
    };
    sandbox.file("stubborn.toml", driven_by("stubborn", STUBBORN));
    let words = ["run", "stubborn.toml", "--allow-external", "--quiet"];
    let stubborn = sandbox.protean(words).start();
    let stubborn_run = sandbox.next_run(&known);
    let far = until("the program that another starts", SOON, || {
        others().into_iter().find(|p| p.name == "sleep")
    });
    stubborn.signal(Signal::KILL);
    stubborn.finish();
    until("the end of all but one", SOON, || {
        (others() == [far.clone()]).then_some(())
    });
    let cleaned = sandbox.protean(["clean"]).json();
    let root = |run: &str| sandbox.runtime_dir().join("protean").join(run);
    let of = |run: &str| {
        let runs = cleaned["runs"].as_array().unwrap();
        runs.iter()
            .find(|r| r["run"] == root(run).to_str().unwrap())
            .unwrap()
    };
    assert_eq!(of(&stubborn_run)["state"], "removed", "{cleaned}");
    assert_eq!(
        of(&stubborn_run)["killed"],
        serde_json::json!([far.pid]),
        "{cleaned}"
    );
    assert_eq!(of(&alive_run)["state"], "alive", "{cleaned}");
    assert_eq!(sandbox.processes(), before);
    alive.signal(Signal::INT);
    let outcome = alive.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    sandbox.assert_nothing_left();
}

/// The tick that a message names.
#[track_caller]
fn tick_named(text: &str) -> u64 {
    let at = text.find("at tick ").unwrap_or_else(|| panic!("{text}")) + "at tick ".len();
    let digits: String = text[at..]
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse().unwrap()
}

#[test]
fn a_killed_process_ends_the_run_and_is_named() {
    for name in ["pursuer_police_2", "simulator"] {
        let sandbox = Sandbox::new();
        let (running, _) = in_the_air(&sandbox, &["--json"], 50);
        signal(sandbox.process(name).pid, Signal::KILL);
        let outcome = running.finish();
        let words = format!("error: process {name} was ended by signal 9 at tick ");
        outcome.refused(1, &[&words]);
        let tick = tick_named(&outcome.stderr);
        let history = assert_readable(&log(&sandbox), 50);
        let last = history.states.last().unwrap().tick;
        assert!(
            tick <= last && last <= tick + 1,
            "{name}: tick {tick} named, {last} logged"
        );
        sandbox.assert_nothing_left();
    }
}

/// Stops the process `name` in mid-run, which is then named and ends the run.
fn stands_still(name: &str) {
    let sandbox = Sandbox::new();
    let (running, _) = in_the_air(&sandbox, &["--set", "run.hang_timeout_s=15"], 50);
    let start = Instant::now();
    signal(sandbox.process(name).pid, Signal::STOP);
    let outcome = running.finish();
    let words = format!("error: process {name} did not answer for 15s at tick ");
    outcome.refused(1, &[&words]);
    let tick = tick_named(&outcome.stderr);
    assert!(start.elapsed() >= Duration::from_secs(15));
    let history = assert_readable(&log(&sandbox), 50);
    assert_eq!(history.states.last().unwrap().tick, tick);
    sandbox.assert_nothing_left();
}

// Two tests, so that they wait for the same fifteen seconds.

#[test]
fn a_filter_that_stands_still_is_named_as_hung() {
    stands_still("perception");
}

#[test]
fn a_planner_that_stands_still_is_named_as_hung() {
    stands_still("evader_potential_evader_2");
}
