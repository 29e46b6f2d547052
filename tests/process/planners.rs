//! Planners, and what every reader of states and maps has in common.

use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::robot::{Command, ScanHeader};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Belief, Scan};
use runtime::lockstep::SlotState;

use super::{Answers, COP, ROOM, THIEF, VIEWPOINTS, planner, room_with_scanner, send_map};
use crate::support::rig::{Rig, World};

/// A change that makes a belief invalid.
type Hostile = fn(&mut BeliefHeader, &mut Vec<Particle>);

/// A belief that the thief is at a place.
fn belief(world: &World, tick: u64, x: f64, y: f64) -> (BeliefHeader, Vec<Particle>) {
    let header = BeliefHeader {
        stamp: world.stamp(tick),
        mean_x: x,
        mean_y: y,
        robot: 1,
        ..BeliefHeader::default()
    };
    let particle = |i: u32| Particle {
        x: x as f32 + 0.01 * i as f32,
        y: y as f32,
        theta: 0.0,
        weight: 0.25,
    };
    (header, (0..4).map(particle).collect())
}

fn still(command: &Command) -> bool {
    command.v == 0.0 && command.omega == 0.0
}

#[test]
fn a_pursuer_answers_every_tick_with_one_command_and_one_plan() {
    let mut rig = Rig::new(ROOM, "cop");
    let (world, answers) = (World::open(&rig), Answers::open(&rig));
    let beliefs = rig.publisher::<Belief>(VIEWPOINTS, 100);
    rig.take_off();
    beliefs.update_connections().unwrap();
    world.begin(&mut rig, send_map);
    let mut moved = 0;
    for tick in 0..40 {
        let (header, particles) = belief(&world, tick, 0.5, 1.0);
        beliefs.send(header, &particles).unwrap();
        world.tick(&rig, tick);
        moved += u32::from(!still(&answers.take(&rig, tick, COP, 0)));
    }
    assert!(
        moved > 30,
        "it drives where it believes the thief to be: {moved} ticks"
    );
    rig.rejected(0);
}

#[test]
fn hostile_beliefs_are_rejected_and_counted() {
    let mut rig = Rig::new(ROOM, "cop");
    let (world, answers) = (World::open(&rig), Answers::open(&rig));
    let beliefs = rig.publisher::<Belief>(VIEWPOINTS, 100);
    rig.take_off();
    beliefs.update_connections().unwrap();
    world.begin(&mut rig, send_map);
    let hostile: [Hostile; 5] = [
        |_, particles| particles[1].x = f32::NAN,
        |_, particles| particles[2].weight = f32::INFINITY,
        |_, particles| particles[3].weight = -1.0,
        |header, _| header.mean_y = f64::NAN,
        |header, _| header.robot = 77,
    ];
    for (tick, change) in (0..).zip(hostile) {
        let (mut header, mut particles) = belief(&world, tick, 0.5, 1.0);
        beliefs.send(header, &particles).unwrap();
        change(&mut header, &mut particles);
        beliefs.send(header, &particles).unwrap();
        world.tick(&rig, tick);
        answers.take(&rig, tick, COP, 0);
    }
    // Valid: a belief without particles.
    let (header, _) = belief(&world, 5, 0.5, 1.0);
    beliefs.send(header, &[]).unwrap();
    world.tick(&rig, 5);
    answers.take(&rig, 5, COP, 0);
    rig.rejected(hostile.len() as u64);
}

/// Changes to a sound state that make it one to be rejected.
const HOSTILE: [fn(&mut Vec<RobotState>); 6] = [
    |robots| robots[0].x = f64::NAN,
    |robots| robots[1].theta = f64::INFINITY,
    |robots| robots[1].omega = f64::NEG_INFINITY,
    |robots| robots.truncate(1),
    |robots| robots.push(robots[0]),
    |robots| robots.swap(0, 1),
];

#[test]
fn hostile_states_and_maps_are_rejected_and_counted_by_every_reader() {
    for (text, name) in [
        (ROOM.to_owned(), "cop"),
        (ROOM.to_owned(), "thief"),
        (room_with_scanner(), "thief"),
        (ROOM.to_owned(), "eyes"),
    ] {
        let mut rig = Rig::new(&text, name);
        let world = World::open(&rig);
        rig.take_off();
        world.begin(&mut rig, |world, rig| {
            world.send_map(rig, |_, cells| cells[7].clearance = f32::NAN);
            world.send_map(rig, |header, _| header.width += 1);
            world.send_map(rig, |header, _| header.resolution = 0.0);
            send_map(world, rig);
        });
        for (tick, change) in (0..).zip(HOSTILE) {
            let mut robots = world.robots.clone();
            change(&mut robots);
            world.send(tick, &robots);
            world.tick(&rig, tick);
        }
        rig.rejected(3 + HOSTILE.len() as u64);
        assert!(rig.process.is_alive(), "{name}");
    }
}

#[test]
fn a_turn_without_a_sound_state_ends_the_process_in_order_and_says_why() {
    for name in ["cop", "thief", "eyes"] {
        for change in [HOSTILE[0], HOSTILE[3]] {
            let (mut rig, world, _answers) = planner(ROOM, name);
            world.tick(&rig, 0);
            let mut robots = world.robots.clone();
            change(&mut robots);
            world.send(1, &robots);
            assert!(!world.turn(&rig, 1), "{name} answered to nonsense");
            let (status, words) = rig.process.end();
            assert_eq!(status.code(), Some(1), "{name}: {words}");
            assert!(words.contains("turn of tick 1"), "{name}: {words}");
            assert_eq!(rig.state(), SlotState::Failed);
        }
    }
}

#[test]
fn wild_but_finite_states_are_answered_within_the_limits() {
    for (name, source, robot) in [("cop", COP, 0), ("thief", THIEF, 1)] {
        let (rig, mut world, answers) = planner(ROOM, name);
        let sound = world.robots.clone();
        let mut tick = 0;
        for wild in [1e300, -1e300, 1e9, f64::MAX, f64::MIN_POSITIVE, -0.0] {
            for changed in 0..2 {
                for field in 0..3 {
                    world.robots.clone_from(&sound);
                    let robot = &mut world.robots[changed];
                    *[&mut robot.x, &mut robot.y, &mut robot.theta][field] = wild;
                    world.tick(&rig, tick);
                    answers.take(&rig, tick, source, u32::from(name == "thief"));
                    tick += 1;
                }
            }
        }
        // Two robots in one place, and unknown codes.
        world.robots.clone_from(&sound);
        world.robots[1].x = world.robots[0].x;
        world.robots[1].y = world.robots[0].y;
        world.robots[0].team = 200;
        world.robots[1].status = 200;
        world.tick(&rig, tick);
        answers.take(&rig, tick, source, robot);
        rig.rejected(0);
    }
}

#[test]
fn an_evader_by_scanner_takes_hostile_scans_for_none() {
    let mut rig = Rig::new(&room_with_scanner(), "thief");
    let (world, answers) = (World::open(&rig), Answers::open(&rig));
    let scans = rig.publisher::<Scan>(0, 64);
    rig.take_off();
    scans.update_connections().unwrap();
    world.begin(&mut rig, send_map);
    let sound = ScanHeader {
        angle_min: 0.0,
        angle_increment: std::f64::consts::FRAC_PI_4,
        range_min: 0.1,
        range_max: 3.5,
        robot: 1,
        ..ScanHeader::default()
    };
    let infinite = [f32::INFINITY; 8];
    let mut broken = infinite;
    broken[3] = f32::NAN;
    for tick in 0..4 {
        let header = ScanHeader {
            stamp: world.stamp(tick),
            ..sound
        };
        scans.send(header, &infinite).unwrap();
        match tick {
            0 => drop(scans.send(header, &broken).unwrap()),
            1 => drop(
                scans
                    .send(ScanHeader { robot: 9, ..header }, &infinite)
                    .unwrap(),
            ),
            2 => drop(
                scans
                    .send(
                        ScanHeader {
                            range_max: f64::NAN,
                            ..header
                        },
                        &infinite,
                    )
                    .unwrap(),
            ),
            // Nothing hit and too near at once, and no beams at all: both are possible.
            _ => drop(
                scans
                    .send(header, &[f32::NEG_INFINITY, f32::INFINITY])
                    .unwrap(),
            ),
        }
        world.tick(&rig, tick);
        answers.take(&rig, tick, THIEF, 1);
    }
    scans
        .send(
            ScanHeader {
                stamp: world.stamp(4),
                ..sound
            },
            &[],
        )
        .unwrap();
    world.tick(&rig, 4);
    answers.take(&rig, 4, THIEF, 1);
    rig.rejected(3);
}
