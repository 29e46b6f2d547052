//! Processes that fail in the middle of a run: what the scenario says happens, the log says when, and
//! nobody else is held up.

#[path = "supervision/disk.rs"]
mod disk;
#[path = "supervision/grandchildren.rs"]
mod grandchildren;
#[path = "supervision/orchestrator.rs"]
mod orchestrator;
#[path = "supervision/room.rs"]
mod room;
#[path = "supervision/surroundings.rs"]
mod surroundings;

use std::collections::BTreeSet;
use std::path::PathBuf;

use rustix::process::Signal;
use serde_json::Value as Json;

use crate::support::call::{Outcome, PATIENCE, Running};
use crate::support::history::History;
use crate::support::programs::driven_by;
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, until, wait_for_tick};

/// A chase of some thousand ticks that nobody wins, and what becomes of whom.
const CHASE: [&str; 16] = [
    "run",
    "chase",
    "--json",
    "--out",
    "run.mcap",
    "--set",
    "run.dt=0.01",
    "--set",
    "rules.time_limit=12",
    "--set",
    "processes.perception.on_failure=restart",
    "--set",
    "processes.pursuer.on_failure=restart",
    "--set",
    "processes.evader_potential.on_failure=stop_robot",
    "--quiet",
];
/// Ticks that a process is away the first time: half a second.
const AWAY: u64 = 50;

fn in_the_air<'a>(sandbox: &'a Sandbox, more: &[&'a str], ticks: u64) -> (Running<'a>, String) {
    let words = CHASE.iter().copied().chain(more.iter().copied());
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, ticks);
    (running, run)
}

fn log(sandbox: &Sandbox) -> PathBuf {
    sandbox.path().join("run.mcap")
}

/// Ends a process of the run in the middle of whatever it does.
fn kill(sandbox: &Sandbox, name: &str) {
    signal(sandbox.process(name).pid, Signal::KILL);
}

/// What became of a process.
#[track_caller]
fn of<'j>(summary: &'j Json, name: &str) -> &'j Json {
    let processes = summary["processes"].as_array().unwrap();
    let found = processes.iter().find(|process| process["name"] == name);
    found.unwrap_or_else(|| panic!("{name}: {summary}"))
}

/// The ticks at which it left and came back, of its only failure.
#[track_caller]
fn outage(summary: &Json, name: &str) -> (u64, u64) {
    let outages = of(summary, name)["outages"].as_array().unwrap();
    assert_eq!(outages.len(), 1, "{outages:?}");
    let tick = |key: &str| outages[0][key].as_u64().unwrap();
    (tick("left_tick"), tick("back_tick"))
}

#[track_caller]
fn finished(outcome: &Outcome) -> Json {
    // It went to its end, but not as the scenario has it.
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    assert_eq!(summary["interrupted"], false);
    let topics = summary["topics"].as_object().unwrap();
    for (name, topic) in topics {
        assert_eq!((name, &topic["gaps"]), (name, &Json::from(0)));
    }
    summary
}

/// What a log with failures is compared with goes up to the first of them, which is named.
#[track_caller]
fn same_up_to(sandbox: &Sandbox, words: &[&str], same: &str, (name, tick): (&str, u64)) {
    let more = ["run.mcap", "--json", "--quiet"];
    let ran = sandbox.protean(words.iter().copied().chain(more)).run();
    assert_eq!(ran.code, Some(3), "{ran}");
    let report = ran.json();
    assert_eq!(report[same], true, "{report}");
    assert_eq!(report["left"]["process"], name, "{report}");
    assert_eq!(report["left"]["tick"], tick, "{report}");
}

#[test]
fn killed_processes_rejoin_at_a_tick_that_the_log_tells_and_others_stand_or_go_on() {
    let sandbox = Sandbox::new();
    let (running, run) = in_the_air(&sandbox, &["--set", PATIENCE], 100);
    kill(&sandbox, "pursuer_police_2");
    wait_for_tick(&run, 300);
    kill(&sandbox, "perception");
    wait_for_tick(&run, 500);
    kill(&sandbox, "evader_potential_evader_1");
    let outcome = running.finish();
    let summary = finished(&outcome);

    let (left, back) = outage(&summary, "pursuer_police_2");
    assert_eq!(back, left + AWAY);
    assert_eq!(
        of(&summary, "pursuer_police_2")["outages"][0]["reason"],
        "was ended by signal 9"
    );
    let (eyes_left, eyes_back) = outage(&summary, "perception");
    assert_eq!(eyes_back, eyes_left + AWAY);
    let given_up = of(&summary, "evader_potential_evader_1");
    assert_eq!(given_up["given_up"], true, "{given_up}");
    let gone = given_up["outages"][0]["left_tick"].as_u64().unwrap();

    // A robot without its planner is stopped from the very next state on, and moves with it again.
    let history = History::read(&log(&sandbox));
    let said = |topic: &str, source: u32| -> BTreeSet<u64> {
        let of = |m: &&crate::support::history::Message| m.topic == topic && m.source == source;
        history.messages.iter().filter(of).map(|m| m.tick).collect()
    };
    // Perception is the first process behind the simulator, the pursuers follow.
    // The command of a planner that was killed between that and the end of its turn still counts.
    let stopped_from =
        |source, left| left + 1 + u64::from(said("robot/command", source).contains(&left));
    let (stopped, evader_stopped) = (stopped_from(3, left), stopped_from(6, gone));
    assert_eq!(history.states.len() as u64, 1201);
    for state in &history.states {
        let tick = state.tick;
        let away = (stopped..=back).contains(&tick);
        assert_eq!(state.robots[1].fail_safe, away, "tick {tick}");
        let over = tick >= evader_stopped && !state.over;
        assert_eq!(state.robots[4].fail_safe, over, "tick {tick}");
        assert!(!state.robots[0].fail_safe);
    }
    let robot = |i: usize| &summary["robots"][i];
    let ticks = back + 1 - stopped;
    assert_eq!(robot(1)["fail_safe_ticks"], ticks, "{}", robot(1));
    assert_eq!(robot(1)["fail_safe_stops"], 1);
    let moved = |from: u64, to: u64| {
        let at = |tick: u64| &history.states[tick as usize].robots[1];
        at(to).distance - at(from).distance
    };
    assert!(moved(back, back + 200) > 0.0, "it is driven again");

    // Commands and beliefs say the same: one for every tick but those.
    let commands = said("robot/command", 3);
    let expected: BTreeSet<u64> = (0..1200).filter(|t| !(left..back).contains(t)).collect();
    // One that it was killed after may be there too.
    let extra: Vec<_> = commands.symmetric_difference(&expected).collect();
    assert!(extra.iter().all(|&&t| t == left), "{extra:?}");
    let beliefs = said("perception/belief", 1);
    let expected: BTreeSet<u64> = (0..1200)
        .filter(|t| !(eyes_left..eyes_back).contains(t))
        .collect();
    let extra: Vec<_> = beliefs.symmetric_difference(&expected).collect();
    assert!(extra.iter().all(|&&t| t == eyes_left), "{extra:?}");

    let first = ("pursuer_police_2", left);
    same_up_to(&sandbox, &["rerun"], "same", first);
    same_up_to(&sandbox, &["rerun", "--in-process"], "same", first);
    for own in [
        first,
        ("perception", eyes_left),
        ("evader_potential_evader_1", gone),
    ] {
        same_up_to(&sandbox, &["replay", "--test", own.0], "identical", own);
    }
    sandbox.assert_nothing_left();
}

#[test]
fn one_that_stands_still_in_lock_step_is_killed_and_replaced() {
    let sandbox = Sandbox::new();
    let (running, _) = in_the_air(&sandbox, &["--set", "run.hang_timeout_s=3"], 50);
    signal(sandbox.process("perception").pid, Signal::STOP);
    let summary = finished(&running.finish());
    let (left, back) = outage(&summary, "perception");
    assert_eq!(back, left + AWAY);
    let reason = &of(&summary, "perception")["outages"][0]["reason"];
    assert_eq!(reason, "did not answer for 3s and was killed");
    sandbox.assert_nothing_left();
}

#[test]
fn by_the_clock_those_who_stand_still_are_replaced_or_done_without() {
    let sandbox = Sandbox::new();
    let more = [
        "--real-time",
        "1",
        "--set",
        "run.hang_timeout_s=2",
        "--set",
        "rules.time_limit=600",
    ];
    let (running, run) = in_the_air(&sandbox, &more, 50);
    let evader = sandbox.process("evader_potential_evader_2");
    let pursuer = sandbox.process("pursuer_police_1");
    signal(evader.pid, Signal::STOP);
    signal(pursuer.pid, Signal::STOP);
    until(
        "the end of the one and a successor of the other",
        SOON,
        || {
            let now = sandbox.processes();
            let successor = now.iter().any(|p| p.name == pursuer.name && *p != pursuer);
            (successor && !now.contains(&evader) && !now.contains(&pursuer)).then_some(())
        },
    );
    let page = kit::lockstep::TurnPage::open(&Sandbox::prefix(&run)).unwrap();
    until("its first tick", SOON, || page.first_tick(2).map(drop));
    wait_for_tick(&run, page.ticks_posted() + 20);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    let (left, back) = outage(&summary, "pursuer_police_1");
    assert!(left < back, "{summary}");
    assert_eq!(of(&summary, "evader_potential_evader_2")["given_up"], true);
    for robot in [0, 5] {
        assert!(summary["robots"][robot]["fail_safe_ticks"].as_u64() > Some(0));
    }
    sandbox.assert_nothing_left();
}

#[test]
fn restarts_have_a_limit() {
    let sandbox = Sandbox::new();
    let limit = [
        "--set",
        "processes.pursuer.restart={ limit = 1, backoff_s = 0.1 }",
        "--set",
        PATIENCE,
    ];
    let (running, run) = in_the_air(&sandbox, &limit, 100);
    kill(&sandbox, "pursuer_police_3");
    wait_for_tick(&run, 200);
    kill(&sandbox, "pursuer_police_3");
    let words = [
        "error: process pursuer_police_3 was ended by signal 9 at tick ",
        " after one restart",
    ];
    running.finish().refused(1, &words);
    let history = History::read(&log(&sandbox));
    assert_eq!(history.counts["process/event"].0, 3, "left, back, left");
    sandbox.assert_nothing_left();
}

#[test]
fn a_navigator_outlives_the_optimiser_and_asks_its_successor() {
    let sandbox = Sandbox::new();
    let words = [
        "run",
        "popup",
        "--json",
        "--quiet",
        "--set",
        PATIENCE,
        "--set",
        "processes.optimiser.on_failure=restart",
    ];
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 2);
    kill(&sandbox, "optimiser");
    let summary = finished(&running.finish());
    assert_eq!(summary["robots"][0]["outcome"], "goal_reached", "{summary}");
    assert_eq!(of(&summary, "optimiser")["restarts"], 1);
    sandbox.assert_nothing_left();
}

/// Never becomes ready, complains, and has started another.
const NEVER_READY: &str = r#"
command = ["/bin/sh", "-c", "echo 'still compiling' >&2; sleep 1000 & wait"]
ready_timeout_s = 1.0"#;

#[test]
fn a_program_that_never_becomes_ready_is_named_with_its_words_and_takes_its_own_along() {
    let sandbox = Sandbox::new();
    sandbox.file("slow.toml", driven_by("slow", NEVER_READY));
    let words = ["run", "slow.toml", "--allow-external", "--quiet"];
    let outcome = sandbox.protean(words).run();
    let words = [
        "error: process slow was not ready within 1s; it said last:",
        "still compiling",
    ];
    outcome.refused(1, &words);
    sandbox.assert_nothing_left();
}

/// Writes ten megabytes that are no text and no line, and then a word.
const NOISY: &str = r#"command = ["/bin/sh", "-c", '''
    head -c 10485760 /dev/zero | tr '\0' '\377' >&2; printf '\nafter it\n' >&2; exit 3
''']"#;

#[test]
fn a_program_may_write_whatever_it_likes() {
    let sandbox = Sandbox::new();
    sandbox.file("noisy.toml", driven_by("noisy", NOISY));
    let words = ["run", "noisy.toml", "--allow-external"];
    let outcome = sandbox.protean(words).run();
    let beginning = "\u{fffd}".repeat(2048);
    let line = format!("{beginning} … (10483712 bytes more)\n");
    let ended = "error: process noisy ended with exit code 3";
    let echoed = format!("[noisy] {line}[noisy] after it\n");
    outcome.refused(1, &[&echoed, ended, "said last", &line, "after it"]);
    assert!(outcome.stderr.len() < 20_000, "{}", outcome.stderr.len());
    sandbox.assert_nothing_left();
}

/// Says what it has open that goes on to whom it starts: not the folder that is looked into.
const CURIOUS: &str = r#"command = ["/bin/sh", "-c", '''
    for fd in /proc/$$/fd/*; do test -e "$fd" && echo "open: ${fd##*/}" >&2; done; exit 3
''']"#;

#[test]
fn a_program_finds_nothing_open_of_its_orchestrator() {
    let sandbox = Sandbox::new();
    sandbox.file("curious.toml", driven_by("curious", CURIOUS));
    let words = ["run", "curious.toml", "--allow-external"];
    let outcome = sandbox.protean(words).run();
    let standard = "[curious] open: 0\n[curious] open: 1\n[curious] open: 2\n";
    let ended = "error: process curious ended with exit code 3";
    outcome.refused(1, &[standard, ended]);
    assert_eq!(
        outcome.stderr.matches("[curious] open:").count(),
        3,
        "{}",
        outcome.stderr
    );
    sandbox.assert_nothing_left();
}
