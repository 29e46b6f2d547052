//! Guarantees of missions beyond the chase: robots without a driver stop, the visited area is
//! measured.

use std::collections::BTreeSet;

use crate::support::history::{History, Robot, State};
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, until, wait_for_tick};
use ipc_types::messages::world::WorldEvent;
use runtime::lockstep::TickBarrier;
use rustix::process::Signal;

/// Place of the only planner of `hello` on the tick barrier, behind the simulator.
const PLANNER: usize = 1;

/// Judged by what is in the log alone: how fast this machine is makes no difference.
#[test]
fn a_robot_whose_planner_stands_still_stops_at_its_deadline() {
    // 0.25 s at 20 Hz: its own tick and four more.
    const MAX_AGE: u64 = 4;
    let sandbox = Sandbox::new();
    let words = ["run", "hello", "--real-time", "--json", "--out", "run.mcap"];
    let running = sandbox
        .protean(words)
        .set("run.command_deadline_s=0.25")
        // Slow enough not to arrive before the test is over.
        .set("robots.robot.limits.v_max=0.03")
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 10);
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    let answered = |tick: u64| {
        until("answers of the planner", SOON, || {
            (page.ticks_done(PLANNER) >= tick).then_some(())
        });
    };
    answered(10);
    let planner = sandbox.process("evader_potential").pid;
    signal(planner, Signal::STOP);
    let stopped = page.ticks_posted();
    wait_for_tick(&run, stopped + 5 * MAX_AGE);
    signal(planner, Signal::CONT);
    answered(page.ticks_posted() + 5 * MAX_AGE);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");

    let history = History::read(&sandbox.path().join("run.mcap"));
    let mut stops = BTreeSet::new();
    let mut newest = None;
    let mut commands = history.commands.iter().peekable();
    for pair in history.states.windows(2) {
        let (before, after) = (&pair[0].robots[0], &pair[1].robots[0]);
        let tick = pair[0].tick;
        while let Some(command) = commands.next_if(|c| c.tick <= tick) {
            newest = Some(command.tick);
        }
        // A command counts from its arrival, which may be late: without a fresh one the robot
        // must stop, with one it may drive.
        if newest.is_none_or(|newest: u64| newest + MAX_AGE < tick) {
            assert!(after.fail_safe, "tick {tick}, command of {newest:?}");
        }
        if after.fail_safe {
            assert_eq!((after.v, after.omega), (0.0, 0.0), "tick {tick}");
            let place = |r: &Robot| (r.x, r.y, r.theta);
            assert_eq!(place(before), place(after), "tick {tick}");
            if !before.fail_safe {
                stops.insert(pair[1].tick);
            }
        }
    }
    let paused = |s: &&State| (stopped..=stopped + 2 * MAX_AGE).contains(&s.tick);
    let mut paused = history.states.iter().filter(paused);
    assert!(
        paused.any(|s| s.robots[0].fail_safe),
        "from {stopped}: {stops:?}"
    );
    let drives = |s: &State| s.tick > stopped + 2 * MAX_AGE && s.robots[0].v > 0.0;
    assert!(history.states.iter().any(drives), "it drives on");

    let missing = |kind: u32| WorldEvent::name_of(kind) == "missing_command";
    let told: BTreeSet<u64> = history
        .events
        .iter()
        .filter(|event| missing(event.kind))
        .map(|event| event.tick)
        .collect();
    assert_eq!(told, stops, "an event each");
    let summary = outcome.json();
    assert_eq!(summary["robots"][0]["fail_safe_stops"], stops.len());
    let events = summary["events"].as_array().unwrap();
    let listed = events.iter().filter(|e| e["kind"] == "missing_command");
    assert_eq!(listed.count(), stops.len());
    sandbox.assert_nothing_left();
}

#[test]
fn the_visited_area_is_reported_and_belongs_to_the_history() {
    let sandbox = Sandbox::new();
    let run = |more: &[&'static str]| {
        let words = ["run", "hello", "--quiet", "--out", "run.mcap", "--force"];
        let call = sandbox.protean(words);
        more.iter()
            .fold(call, |call, change| call.set(change))
            .json()
    };
    let plain = run(&[]);
    assert!(plain.get("coverage").is_none(), "{plain}");
    assert!(plain["topics"].get("world/coverage").is_none());

    let rule = "rules.coverage={ period = 0.5 }";
    let narrow = run(&[rule]);
    let wide = run(&[rule, "rules.coverage.radius=0.4"]);
    let number =
        |summary: &serde_json::Value, key: &str| summary["coverage"][key].as_f64().unwrap();
    // A room of 4 m × 3 m with a wall; the robot drives once around it.
    let free = number(&narrow, "free_m2");
    assert!((11.0..12.0).contains(&free), "{narrow}");
    let distance = narrow["robots"][0]["distance_m"].as_f64().unwrap();
    let swept = distance * 0.21 + 0.035;
    let visited = number(&narrow, "visited_m2");
    assert!(
        (visited / swept - 1.0).abs() < 0.1,
        "{visited} of {swept} m² swept"
    );
    assert!((number(&narrow, "fraction") - visited / free).abs() < 1e-9);
    assert!(number(&narrow, "coverable_fraction") > number(&narrow, "fraction"));
    assert!(number(&wide, "visited_m2") > 2.0 * visited);
    let time = narrow["sim_time_s"].as_f64().unwrap();
    assert_eq!(number(&narrow, "worst_idleness_s"), time);

    // Two a second from time 0 on, and one at the end.
    let ticks = narrow["ticks"].as_u64().unwrap();
    let reports = ticks / 10 + 1 + u64::from(!ticks.is_multiple_of(10));
    assert_eq!(narrow["topics"]["world/coverage"]["messages"], reports);
    let history = History::read(&sandbox.path().join("run.mcap"));
    let last = history.of("world/coverage").last().unwrap();
    assert_eq!(last.tick, ticks);

    // The account is part of the history, and changes nothing else in it.
    assert_eq!(run(&[rule])["digest"], narrow["digest"]);
    assert_ne!(plain["digest"], narrow["digest"]);
    assert_eq!(plain["robots"], narrow["robots"]);

    let table = sandbox
        .protean(["run", "hello", "--out", "table.mcap"])
        .set(rule)
        .run();
    assert!(table.stdout.contains("\ncoverage  "), "{table}");
    let unknown = sandbox
        .protean(["check", "hello"])
        .set("rules.coverage.robots=[\"rowboat\"]")
        .run();
    assert_eq!(unknown.code, Some(2), "{unknown}");
    assert!(unknown.stderr.contains("coverage.robots[0]"), "{unknown}");
    sandbox.assert_nothing_left();
}
