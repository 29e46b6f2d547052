//! Exits of processes, and errors that prevent their start.

use runtime::lockstep::{Phase, SlotState};
use rustix::process::Signal;

use super::simulator::Drivers;
use super::{ROOM, planner};
use crate::support::Sandbox;
use crate::support::rig::Rig;

/// Tells a process to end.
type Tell = fn(&mut Rig);

/// Ways to end a process, and the exit code that follows.
const ENDINGS: [(&str, Tell); 3] = [
    ("phase", |rig| rig.monitor.set_phase(Phase::Stop)),
    ("SIGTERM", |rig| rig.process.signal(Signal::TERM)),
    ("orphaned", |rig| drop(rig.process.stdin.take())),
];

#[test]
fn every_process_ends_when_told_or_orphaned_before_the_first_tick() {
    for name in ["simulator", "eyes", "cop", "thief"] {
        for (how, tell) in ENDINGS {
            let mut rig = Rig::new(ROOM, name);
            rig.wait_for(SlotState::Ready);
            tell(&mut rig);
            let (status, words) = rig.process.end();
            assert_eq!((status.code(), &*words), (Some(0), ""), "{name}, {how}");
            assert_eq!(rig.state(), SlotState::Stopped, "{name}, {how}");
        }
    }
}

#[test]
fn every_process_ends_when_told_or_orphaned_in_the_air() {
    for (how, tell) in ENDINGS {
        for name in ["eyes", "cop", "thief"] {
            let (mut rig, world, _answers) = planner(ROOM, name);
            world.tick(&rig, 0);
            tell(&mut rig);
            let (status, words) = rig.process.end();
            assert_eq!((status.code(), &*words), (Some(0), ""), "{name}, {how}");
            assert_eq!(rig.state(), SlotState::Stopped, "{name}, {how}");
        }
        let drivers = Drivers::take_off(Rig::new(ROOM, "simulator"));
        drivers.rig.monitor.set_phase(Phase::Run);
        drivers.turn(0);
        let mut rig = drivers.rig;
        tell(&mut rig);
        let (status, words) = rig.process.end();
        if how == "phase" {
            assert_eq!((status.code(), &*words), (Some(0), ""), "simulator, {how}");
            assert_eq!(rig.state(), SlotState::Stopped, "simulator, {how}");
            continue;
        }
        // The end of the simulator is not the end of the game and must not be reported as such.
        assert_eq!(status.code(), Some(1), "simulator, {how}: {words}");
        assert!(words.contains("in the middle of the run"), "{words}");
        assert_eq!(rig.state(), SlotState::Failed, "simulator, {how}");
        assert!(!rig.monitor.barrier().is_over(), "simulator, {how}");
    }
}

#[test]
fn configurations_that_cannot_be_used_are_named() {
    let sandbox = Sandbox::new();
    let call = |kind: &str| {
        let words = ["process", kind, "--config", "process.json"].map(str::to_owned);
        sandbox
            .protean(words.iter().map(String::as_str).collect::<Vec<_>>())
            .run()
    };
    call("pursuer").refused(1, &["process configuration process.json", "No such file"]);
    sandbox.file("process.json", "{ \"run\": 3 }");
    call("pursuer").refused(1, &["process configuration process.json", "line 1"]);
    call("unknown").refused(2, &["no process of kind \"unknown\""]);
}
