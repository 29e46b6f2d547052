//! Processes that fail during a run: the policy of the scenario is applied, the log holds the events, and
//! no other process is delayed.

mod disk;
mod grandchildren;
mod orchestrator;
mod shared_memory;
mod surroundings;

use std::collections::BTreeSet;
use std::path::PathBuf;

use runtime::lockstep::{SlotState, TickBarrier};
use rustix::process::Signal;
use serde_json::Value as Json;

use crate::support::call::{Outcome, PATIENCE, Running};
use crate::support::history::History;
use crate::support::programs::driven_by;
use crate::support::sandbox::{Process, signal};
use crate::support::{SOON, Sandbox, until, wait_for_tick};

/// Arguments of a chase of some thousand ticks without a winner, which reports all processes.
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
    "processes.perception.on_failure=continue",
    "--set",
    "processes.pursuer.on_failure=continue",
    "--set",
    "processes.evader_potential.on_failure=continue",
    "--quiet",
];
/// The same in real time, without end.
const RESTARTS: [&str; 8] = [
    "--real-time",
    "1",
    "--set",
    "rules.time_limit=600",
    "--set",
    "processes.perception.on_failure=restart",
    "--set",
    "processes.pursuer.on_failure=restart",
];

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

/// Kills a process of the run.
fn kill(sandbox: &Sandbox, name: &str) {
    signal(sandbox.process(name).pid, Signal::KILL);
}

/// Kills a process of a run in real time, and waits for the one that is started in its place.
fn replace(sandbox: &Sandbox, run: &str, name: &str, slot: usize) {
    let page = TickBarrier::open(&Sandbox::prefix(run)).unwrap();
    let victim = sandbox.process(name);
    signal(victim.pid, Signal::KILL);
    await_successor(sandbox, &page, &victim, slot);
}

/// Waits until the successor of a process takes part, and the log has the event.
fn await_successor(sandbox: &Sandbox, page: &TickBarrier, victim: &Process, slot: usize) {
    until("its successor", SOON, || {
        let now = sandbox.processes();
        let is_there = now.iter().any(|p| p.name == victim.name && p != victim);
        (is_there && page.state(slot) == SlotState::Prepared).then_some(())
    });
    let posted = page.ticks_posted();
    until("twenty ticks more", SOON, || {
        (page.ticks_posted() > posted + 20).then_some(())
    });
}

/// The entry of a process in the summary.
#[track_caller]
fn of<'j>(summary: &'j Json, name: &str) -> &'j Json {
    let processes = summary["processes"].as_array().unwrap();
    let found = processes.iter().find(|process| process["name"] == name);
    found.unwrap_or_else(|| panic!("{name}: {summary}"))
}

/// The only failure of a process, and the tick at which it left.
#[track_caller]
fn outage<'j>(summary: &'j Json, name: &str) -> (u64, &'j Json) {
    let outages = of(summary, name)["outages"].as_array().unwrap();
    assert_eq!(outages.len(), 1, "{outages:?}");
    (outages[0]["left_tick"].as_u64().unwrap(), &outages[0])
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

/// Asserts that a log with failures is compared up to the first failure, and that this is named.
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
fn in_lock_step_a_run_goes_on_without_those_that_were_killed_and_their_robots_stand() {
    let sandbox = Sandbox::new();
    let (running, run) = in_the_air(&sandbox, &["--set", PATIENCE], 100);
    kill(&sandbox, "pursuer_police_2");
    wait_for_tick(&run, 300);
    kill(&sandbox, "perception");
    wait_for_tick(&run, 500);
    kill(&sandbox, "evader_potential_evader_1");
    let summary = finished(&running.finish());
    let gone = |name: &str| {
        let (left, outage) = outage(&summary, name);
        assert_eq!(outage["reason"], "was ended by signal 9");
        assert_eq!(of(&summary, name)["given_up"], true, "{summary}");
        left
    };
    let pursuer = gone("pursuer_police_2");
    let (perception, evader) = (gone("perception"), gone("evader_potential_evader_1"));

    // A robot without its planner is stopped from the very next state on.
    let history = History::read(&log(&sandbox));
    let ticks_of = |topic: &str, source: u32| -> BTreeSet<u64> {
        let of = |m: &&crate::support::history::Message| m.topic == topic && m.source == source;
        history.messages.iter().filter(of).map(|m| m.tick).collect()
    };
    // Perception is the first process behind the simulator, the pursuers follow.
    // The command of a planner that was killed between that and the end of its turn still counts.
    let stopped_from =
        |source, left| left + 1 + u64::from(ticks_of("robot/command", source).contains(&left));
    let (pursuer_stands, evader_stands) = (stopped_from(3, pursuer), stopped_from(6, evader));
    assert_eq!(history.states.len() as u64, 1201);
    for state in &history.states {
        let tick = state.tick;
        let (pursuer, evader) = (tick >= pursuer_stands, tick >= evader_stands);
        assert_eq!(state.robots[1].fail_safe, pursuer, "tick {tick}");
        assert_eq!(
            state.robots[4].fail_safe,
            evader && !state.over,
            "tick {tick}"
        );
        assert!(!state.robots[0].fail_safe);
    }
    assert_eq!(summary["robots"][1]["fail_safe_stops"], 1);
    // Commands and beliefs agree: one for every tick up to then, and perhaps the one after
    // which it was killed.
    for (topic, source, left) in [
        ("robot/command", 3, pursuer),
        ("perception/belief", 1, perception),
    ] {
        let mut ticks = ticks_of(topic, source);
        ticks.remove(&left);
        assert_eq!(ticks, (0..left).collect(), "{topic}");
    }

    let first = ("pursuer_police_2", pursuer);
    same_up_to(&sandbox, &["verify"], "same", first);
    same_up_to(&sandbox, &["verify", "--in-process"], "same", first);
    for own in [
        first,
        ("perception", perception),
        ("evader_potential_evader_1", evader),
    ] {
        same_up_to(&sandbox, &["replay", "--test", own.0], "identical", own);
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_run_whose_optimiser_was_killed_while_it_owed_a_plan_is_the_same_up_to_then() {
    let sandbox = Sandbox::new();
    let words = [
        "run",
        "popup_city",
        "--json",
        "--quiet",
        "--out",
        "run.mcap",
        "--set",
        "rules.time_limit=60",
        "--set",
        "processes.optimiser.on_failure=continue",
        "--set",
        "events.0.when.travelled=0.05",
    ];
    let running = sandbox.protean(words).start();
    let run = sandbox.next_run(&BTreeSet::new());
    // The obstacle appears in tick 6. New plans are due in tick 7, which waits for them. The plans of tick 0 would
    // leave nothing to compare: an optimiser that is killed before it answers them has left in tick 0.
    wait_for_tick(&run, 8);
    kill(&sandbox, "optimiser");
    let summary = finished(&running.finish());
    let (left, _) = outage(&summary, "optimiser");
    for more in [&["verify"][..], &["verify", "--in-process"]] {
        same_up_to(&sandbox, more, "same", ("optimiser", left));
    }
    sandbox.assert_nothing_left();
}

#[test]
fn one_that_stands_still_in_lock_step_is_killed() {
    let sandbox = Sandbox::new();
    let (running, _) = in_the_air(&sandbox, &["--set", "run.hang_timeout_s=3"], 50);
    signal(sandbox.process("perception").pid, Signal::STOP);
    let summary = finished(&running.finish());
    let (_, outage) = outage(&summary, "perception");
    assert_eq!(outage["reason"], "did not answer for 3s and was killed");
    sandbox.assert_nothing_left();
}

#[test]
fn in_lock_step_nothing_is_restarted_and_check_says_so() {
    let sandbox = Sandbox::new();
    let restart = ["--set", "processes.pursuer.on_failure=restart"];
    let words = [
        "lock-step mode cannot restart a process",
        "(processes.pursuer.on_failure)",
        "\"abort\" or \"continue\"",
        "run.mode = \"real_time\"",
    ];
    for command in ["check", "run"] {
        let call = sandbox.protean([command, "chase"].into_iter().chain(restart));
        call.run().refused(2, &words);
    }
    let mode = ["--set", "run.mode=real_time"];
    let words = ["check", "chase"].into_iter().chain(restart).chain(mode);
    assert_eq!(sandbox.protean(words).run().code, Some(0));
}

#[test]
fn in_real_time_those_that_fail_are_replaced_or_done_without() {
    let sandbox = Sandbox::new();
    let more: Vec<&str> = RESTARTS
        .into_iter()
        .chain(["--set", "run.hang_timeout_s=2"])
        .collect();
    let (running, run) = in_the_air(&sandbox, &more, 50);
    let evader = sandbox.process("evader_potential_evader_2");
    let pursuer = sandbox.process("pursuer_police_1");
    signal(evader.pid, Signal::STOP);
    signal(pursuer.pid, Signal::STOP);
    until("the end of both", SOON, || {
        let now = sandbox.processes();
        (!now.contains(&evader) && !now.contains(&pursuer)).then_some(())
    });
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    await_successor(&sandbox, &page, &pursuer, 2);
    // The successors receive the map and the state of the world again.
    replace(&sandbox, &run, "perception", 1);
    replace(&sandbox, &run, "pursuer_police_2", 3);
    wait_for_tick(&run, page.ticks_posted() + 100);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    for name in ["pursuer_police_1", "perception", "pursuer_police_2"] {
        let (left, outage) = outage(&summary, name);
        assert!(Some(left) < outage["back_tick"].as_u64(), "{summary}");
        assert_eq!(of(&summary, name)["restarts"], 1);
    }
    assert_eq!(of(&summary, "evader_potential_evader_2")["given_up"], true);
    for robot in [0, 1, 5] {
        assert!(summary["robots"][robot]["fail_safe_ticks"].as_u64() > Some(0));
    }
    let (_, outage) = outage(&summary, "pursuer_police_2");
    let back = outage["back_tick"].as_u64().unwrap();
    let history = History::read(&log(&sandbox));
    let mut after = history.states.iter().filter(|s| s.tick > back + 20);
    assert!(
        after.any(|state| !state.robots[1].fail_safe),
        "it is driven"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn restarts_have_a_limit() {
    let sandbox = Sandbox::new();
    let more: Vec<&str> = RESTARTS.into_iter().chain(["--set", PATIENCE]).collect();
    let (running, run) = in_the_air(&sandbox, &more, 50);
    for _ in 0..5 {
        replace(&sandbox, &run, "pursuer_police_3", 4);
    }
    kill(&sandbox, "pursuer_police_3");
    let words = [
        "error: process pursuer_police_3 was ended by signal 9 at tick ",
        " after 5 restarts",
    ];
    running.finish().refused(1, &words);
    let history = History::read(&log(&sandbox));
    assert_eq!(
        history.counts["process/event"].0, 11,
        "left, back, ..., left"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn a_navigator_outlives_the_optimiser_and_asks_its_successor() {
    let sandbox = Sandbox::new();
    let words = ["run", "popup", "--json", "--quiet", "--real-time", "10"];
    let running = sandbox
        .protean(words)
        .set(PATIENCE)
        .set("processes.optimiser.on_failure=restart")
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 2);
    kill(&sandbox, "optimiser");
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let summary = outcome.json();
    assert_eq!(summary["robots"][0]["outcome"], "goal_reached", "{summary}");
    assert_eq!(of(&summary, "optimiser")["restarts"], 1);
    sandbox.assert_nothing_left();
}

/// Never becomes ready, writes to stderr, and starts another process.
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
        "error: process slow was not ready within 1s; its last output:",
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
    let line = format!("{} …\n", "\u{fffd}".repeat(2048));
    let ended = "error: process noisy ended with exit code 3";
    let echoed = format!("[noisy] {line}[noisy] after it\n");
    outcome.refused(1, &[&echoed, ended, "last output:\n    after it"]);
    assert!(outcome.stderr.len() < 20_000, "{}", outcome.stderr.len());
    sandbox.assert_nothing_left();
}

/// Lists the descriptors that its children inherit, without that of the listed folder.
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
