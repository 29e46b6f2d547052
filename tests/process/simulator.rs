//! The simulator.

use ipc_types::bus::Subscriber;
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{ObstacleEvent, RobotState, WorldEvent};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Commands, ObstacleEvents, WorldEvents, WorldMap, WorldState};
use runtime::lockstep::{BarrierMember, Phase, SlotState, TickWait};

use super::{COP, ROOM, THIEF, VIEWPOINTS};
use crate::support::rig::Rig;

/// The simulator in the air, with the test as its planners.
pub struct Drivers {
    pub rig: Rig,
    members: Vec<BarrierMember>,
    states: Subscriber<WorldState>,
    events: Subscriber<WorldEvents>,
}

impl Drivers {
    pub fn take_off(mut rig: Rig) -> Self {
        let slots: Vec<usize> = (1..rig.plan.launches.len()).collect();
        let members: Vec<BarrierMember> = slots
            .iter()
            .map(|&slot| {
                rig.monitor.assign_slot(slot, true, false);
                BarrierMember::new(rig.open_page(), slot, Vec::new())
            })
            .collect();
        let (states, events) = (rig.subscriber(), rig.subscriber());
        rig.take_off();
        rig.prepare();
        for member in &members {
            member.set_state(SlotState::Prepared);
        }
        Self {
            rig,
            members,
            states,
            events,
        }
    }

    /// Takes the turn of a tick: the state and the events of that tick, once they are there.
    #[track_caller]
    pub fn turn(&self, tick: u64) -> (Vec<RobotState>, Vec<WorldEvent>) {
        loop {
            match self.members[0].wait_tick(tick) {
                TickWait::Tick(_) => break,
                TickWait::Idle => {}
                TickWait::Stop => panic!("the run was stopped"),
            }
        }
        let state = self.states.receive().unwrap().expect("a state");
        assert_eq!(state.header().stamp.tick, tick);
        assert!(self.states.receive().unwrap().is_none());
        let mut events = Vec::new();
        while let Some(message) = self.events.receive().unwrap() {
            assert_eq!(message.header().stamp.tick, tick);
            events.extend_from_slice(message.elements());
        }
        (state.elements().to_vec(), events)
    }

    fn done(&self, tick: u64) {
        for member in &self.members {
            member.done(tick);
        }
        self.rig.monitor.recorded(tick);
    }
}

fn named<'a>(events: &'a [WorldEvent], name: &str) -> Vec<&'a WorldEvent> {
    events
        .iter()
        .filter(|e| WorldEvent::name_of(e.kind) == name)
        .collect()
}

#[test]
#[expect(clippy::too_many_lines, reason = "one sequence, tick by tick")]
fn the_simulator_obeys_the_driver_of_a_robot_only() {
    let rig = Rig::new(ROOM, "simulator");
    let cop = rig.publisher::<Commands>(COP, 1);
    let thief = rig.publisher::<Commands>(THIEF, 1);
    let perception = rig.publisher::<Commands>(VIEWPOINTS, 1);
    let drivers = Drivers::take_off(rig);
    for port in [&cop, &thief, &perception] {
        port.update_connections().unwrap();
    }
    let header = |tick: u64| {
        let mut header = PlainHeader::default();
        header.stamp.tick = tick;
        header.stamp.time_ns = tick * drivers.rig.plan.run.tick_period_ns;
        header
    };
    let command = |robot: u32, v: f64, omega: f64| {
        [Command {
            v,
            omega,
            robot,
            reserved: 0,
        }]
    };
    let ahead = |robot| command(robot, 0.1, 0.0);
    drivers.rig.monitor.set_phase(Phase::Run);
    let (first, _) = drivers.turn(0);
    let at = |robots: &[RobotState], i: usize| (robots[i].x, robots[i].y, robots[i].theta);

    // Both by their drivers.
    cop.send(header(0), &ahead(0)).unwrap();
    thief.send(header(0), &ahead(1)).unwrap();
    drivers.done(0);
    let (robots, events) = drivers.turn(1);
    for i in 0..2 {
        let driven = robots[i].x - first[i].x;
        assert!(
            (driven - 0.1 * 0.05).abs() < 1e-12 && robots[i].fail_safe == 0,
            "{robots:?}"
        );
    }
    assert!(events.is_empty(), "{events:?}");

    // The thief's planner and perception speak for the policeman, whose own planner is silent.
    let before = robots;
    thief.send(header(1), &ahead(1)).unwrap();
    thief.send(header(1), &ahead(0)).unwrap();
    perception.send(header(1), &ahead(0)).unwrap();
    perception.send(header(1), &ahead(99)).unwrap();
    drivers.done(1);
    let (robots, events) = drivers.turn(2);
    assert_eq!(
        at(&robots, 0),
        at(&before, 0),
        "no driver of it sent a command"
    );
    assert_eq!((robots[0].v, robots[0].fail_safe), (0.0, 1));
    assert_eq!(
        named(&events, "missing_command")
            .iter()
            .map(|e| e.robot)
            .collect::<Vec<_>>(),
        [0]
    );
    assert!(robots[1].x > before[1].x);
    drivers.rig.rejected(3);

    // Not a number: the robot stops, once reported, and goes on with the next sound command.
    let before = robots;
    cop.send(header(2), &command(0, f64::NAN, 0.0)).unwrap();
    thief
        .send(header(2), &command(1, 0.1, f64::INFINITY))
        .unwrap();
    drivers.done(2);
    let (robots, events) = drivers.turn(3);
    for i in 0..2 {
        assert_eq!(at(&robots, i), at(&before, i), "robot {i} stops");
        assert_eq!((robots[i].v, robots[i].omega), (0.0, 0.0));
    }
    let invalid: Vec<u32> = named(&events, "invalid_command")
        .iter()
        .map(|e| e.robot)
        .collect();
    assert_eq!(invalid, [0, 1]);

    // Faster than it can, and from the future: the limit holds, the future has not come.
    let before = robots;
    cop.send(header(3), &command(0, 1e3, -1e3)).unwrap();
    thief.send(header(9), &ahead(1)).unwrap();
    drivers.done(3);
    let (robots, events) = drivers.turn(4);
    let model = drivers.rig.plan.run.robots[0].model;
    assert!(
        robots[0].v <= model.v_max && robots[0].omega >= -model.omega_max,
        "{robots:?}"
    );
    assert!(robots[0].x.is_finite() && at(&robots, 0) != at(&before, 0));
    assert_eq!(at(&robots, 1), at(&before, 1));
    assert!(named(&events, "invalid_command").is_empty(), "{events:?}");
    drivers.rig.rejected(4);

    // Absurd commands: the robot stops, and the simulator reports it.
    for (tick, [v, omega]) in (4..).zip([
        [1e300, -1e300],
        [f64::NEG_INFINITY, 0.0],
        [0.0, 1e7],
        [f64::MAX, f64::NAN],
    ]) {
        cop.send(header(tick), &command(0, v, omega)).unwrap();
        thief.send(header(tick), &ahead(1)).unwrap();
        drivers.done(tick);
        let (robots, events) = drivers.turn(tick + 1);
        assert_eq!(
            (robots[0].v, robots[0].omega, robots[0].fail_safe),
            (0.0, 0.0, 1)
        );
        assert_eq!(robots[1].fail_safe, 0);
        let told = named(&events, "invalid_command").len();
        assert_eq!(
            told,
            usize::from(tick == 4),
            "once, not every tick: {events:?}"
        );
    }
}

#[test]
fn the_simulator_applies_obstacles_at_their_tick_and_refuses_impossible_ones() {
    let text = format!(
        "{ROOM}\n[[events]]\ntime_s = 0.1\naction = \"appear\"\nobstacle = \"box\"\n\
         shape.circle = {{ center = [3.0, 2.5], radius = 0.2 }}\n"
    );
    let rig = Rig::new(&text, "simulator");
    let obstacles = rig.publisher::<ObstacleEvents>(rig.plan.orchestrator_index(), 1);
    let maps = rig.subscriber::<WorldMap>();
    let drivers = Drivers::take_off(rig);
    obstacles.update_connections().unwrap();
    let sound = drivers.rig.plan.obstacle_changes[0].event;
    let send = |tick: u64, event: ObstacleEvent| {
        let mut header = PlainHeader::default();
        header.stamp.tick = tick;
        header.stamp.time_ns = tick * drivers.rig.plan.run.tick_period_ns;
        obstacles.send(header, &[event]).unwrap();
    };
    send(2, sound);
    let hostile = [
        ObstacleEvent {
            x: f64::NAN,
            id: 900,
            ..sound
        },
        ObstacleEvent {
            radius: -1.0,
            id: 901,
            ..sound
        },
        ObstacleEvent {
            shape: 77,
            id: 902,
            ..sound
        },
        ObstacleEvent {
            action: 77,
            id: 903,
            ..sound
        },
    ];
    drivers.rig.monitor.set_phase(Phase::Run);
    let mut revisions = Vec::new();
    for tick in 0..8 {
        if (3..7).contains(&tick) {
            send(tick, hostile[tick as usize - 3]);
        }
        drivers.turn(tick);
        while let Some(map) = maps.receive().unwrap() {
            revisions.push((tick, map.header().revision));
        }
        drivers.done(tick);
    }
    assert_eq!(revisions, [(0, 1), (2, 2)], "one change, at its tick");
}
