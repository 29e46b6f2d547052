//! Single real processes against a test that plays all the others, honest and hostile.

mod support;

use ipc_types::bus::Subscriber;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::robot::{Command, ScanHeader};
use ipc_types::messages::world::{ObstacleEvent, RobotState, WorldEvent};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{
    Belief, Commands, ObstacleEvents, Plan, Scan, Sightings, WorldEvents, WorldMap, WorldState,
};
use kit::lockstep::{Participant, Phase, SlotState, Turn};
use rustix::process::Signal;
use support::rig::{Rig, World};

/// A room, a policeman and a thief, every kind of planner at hand.
const ROOM: &str = r#"
[run]
seed = 9
[world]
map = "builtin:hello"
[rules]
capture = { radius = 0.3 }
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 10.0
[[robots]]
name = "cop"
team = "police"
start = { x = 0.5, y = 2.5, theta = 0.0 }
[[robots]]
name = "thief"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }
scan = { beams = 8, angle_increment = 0.7853981633974483 }
[[processes]]
kind = "perception"
name = "eyes"
params = { filter = { particles = 100 } }
[[processes]]
kind = "pursuer"
name = "cop"
team = "police"
params = { assignment = { delay_s = 0.0 } }
[[processes]]
kind = "evader_potential"
name = "thief"
team = "evader"
"#;

/// The same with a thief that steers by its scanner.
fn room_with_scanner() -> String {
    ROOM.replace("evader_potential", "evader_braitenberg")
}

/// Indices of the processes in the room.
const EYES: u32 = 1;
const COP: u32 = 2;
const THIEF: u32 = 3;

/// What a planner answers.
struct Answers {
    commands: Subscriber<Commands>,
    plans: Subscriber<Plan>,
}

impl Answers {
    fn open(rig: &Rig) -> Self {
        Self {
            commands: rig.subscriber(),
            plans: rig.subscriber(),
        }
    }

    /// The one command and the one plan that answer to a tick; both make sense.
    #[track_caller]
    fn take(&self, rig: &Rig, tick: u64, source: u32, robot: u32) -> Command {
        let message = self.commands.receive().unwrap().expect("a command");
        let (stamp, command) = (message.header().stamp, message.elements()[0]);
        assert_eq!(message.elements().len(), 1);
        assert_eq!(
            (stamp.tick, stamp.source, stamp.sequence),
            (tick, source, tick)
        );
        assert_eq!(stamp.time_ns, tick * rig.plan.run.tick_period_ns);
        assert!(stamp.origin_ns <= stamp.received_ns && stamp.received_ns <= stamp.sent_ns);
        assert_eq!(command.robot, robot);
        let model = rig.plan.run.robots[robot as usize].model;
        let most = model.v_max + 1e-9;
        assert!(
            command.v.is_finite() && command.omega.is_finite(),
            "{command:?}"
        );
        assert!(
            (-model.v_reverse_max - 1e-9..=most).contains(&command.v),
            "{command:?}"
        );
        assert!(command.omega.abs() <= model.omega_max + 1e-9, "{command:?}");
        assert!(
            self.commands.receive().unwrap().is_none(),
            "a second command"
        );

        let plan = self.plans.receive().unwrap().expect("a plan");
        assert_eq!(
            (plan.header().stamp.tick, plan.header().robot),
            (tick, robot)
        );
        assert!(
            plan.elements()
                .iter()
                .all(|p| p.x.is_finite() && p.y.is_finite())
        );
        assert!(self.plans.receive().unwrap().is_none(), "a second plan");
        command
    }
}

/// The map of the scenario, as it is.
fn send_map(world: &World, rig: &Rig) {
    world.send_map(rig, |_, _| {});
}

/// A planner in the air, its first map taken.
fn planner(text: &str, name: &str) -> (Rig, World, Answers) {
    let mut rig = Rig::new(text, name);
    let (world, answers) = (World::open(&rig), Answers::open(&rig));
    rig.take_off();
    world.begin(&mut rig, send_map);
    (rig, world, answers)
}

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
    let beliefs = rig.publisher::<Belief>(EYES, 100);
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
    let beliefs = rig.publisher::<Belief>(EYES, 100);
    rig.take_off();
    beliefs.update_connections().unwrap();
    world.begin(&mut rig, send_map);
    type Hostile = fn(&mut BeliefHeader, &mut Vec<Particle>);
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
    // Not wrong in itself: nobody is anywhere.
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
        // Two robots in one place, and codes that nobody knows.
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

#[test]
fn perception_tells_what_is_seen_and_believed_at_every_tick() {
    let mut rig = Rig::new(ROOM, "eyes");
    let mut world = World::open(&rig);
    let (sightings, beliefs) = (rig.subscriber::<Sightings>(), rig.subscriber::<Belief>());
    rig.take_off();
    world.begin(&mut rig, send_map);
    for tick in 0..60_u64 {
        // Seen across the room, then behind the wall, then out of the game.
        let (x, y) = if tick < 20 { (0.8, 0.6) } else { (3.0, 0.3) };
        (world.robots[1].x, world.robots[1].y) = (x, y);
        world.robots[1].status = u8::from(tick >= 40);
        world.tick(&rig, tick);
        let message = sightings.receive().unwrap().expect("sightings");
        assert!(sightings.receive().unwrap().is_none());
        let stamp = message.header().stamp;
        assert_eq!(
            (stamp.tick, stamp.source, stamp.sequence),
            (tick, EYES, tick)
        );
        if tick >= 40 {
            assert_eq!(message.elements().len(), 0);
            assert!(beliefs.receive().unwrap().is_none(), "about nobody");
            continue;
        }
        let [seen] = message.elements() else {
            panic!("{message:?}")
        };
        assert_eq!(
            (seen.robot, seen.seen != 0),
            (1, tick < 20),
            "tick {tick}: {seen:?}"
        );
        if tick < 20 {
            assert_eq!(seen.observer, 0);
            assert!(
                (seen.x - x).abs() < 0.2 && (seen.y - y).abs() < 0.2,
                "{seen:?}"
            );
            assert_eq!(
                (seen.theta, seen.heading_known),
                (0.0, 0),
                "no leaked heading"
            );
        } else {
            assert_eq!(
                (seen.x, seen.y, seen.theta),
                (0.0, 0.0, 0.0),
                "no leaked place"
            );
        }
        let belief = beliefs.receive().unwrap().expect("a belief");
        assert!(beliefs.receive().unwrap().is_none());
        let header = belief.header();
        assert_eq!((header.stamp.tick, header.robot), (tick, 1));
        let finite = |p: &Particle| {
            [p.x, p.y, p.theta, p.weight].iter().all(|v| v.is_finite()) && p.weight >= 0.0
        };
        assert!(!belief.elements().is_empty() && belief.elements().iter().all(finite));
        let weight: f32 = belief.elements().iter().map(|p| p.weight).sum();
        assert!((weight - 1.0).abs() < 1e-3, "{weight}");
        assert!(
            header.mean_x.is_finite() && header.covariance_xx >= 0.0,
            "{header:?}"
        );
    }
    rig.rejected(0);
}

/// The simulator in the air, with the test as its planners.
struct Drivers {
    rig: Rig,
    seats: Vec<Participant>,
    states: Subscriber<WorldState>,
    events: Subscriber<WorldEvents>,
}

impl Drivers {
    fn take_off(mut rig: Rig) -> Self {
        let slots: Vec<usize> = (1..rig.plan.launches.len()).collect();
        let seats: Vec<Participant> = slots
            .iter()
            .map(|&slot| {
                rig.overseer.seat(slot, true, false);
                Participant::new(rig.open_page(), slot, Vec::new(), false)
            })
            .collect();
        let (states, events) = (rig.subscriber(), rig.subscriber());
        rig.take_off();
        rig.prepare();
        for seat in &seats {
            seat.set_state(SlotState::Prepared);
        }
        Self {
            rig,
            seats,
            states,
            events,
        }
    }

    /// Takes the turn of a tick: the state and the events of that tick, once they are there.
    #[track_caller]
    fn turn(&self, tick: u64) -> (Vec<RobotState>, Vec<WorldEvent>) {
        loop {
            match self.seats[0].wait_turn(tick) {
                Turn::Tick(_) => break,
                Turn::Idle => {}
                Turn::Stop => panic!("nobody stops this run"),
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
        for seat in &self.seats {
            seat.done(tick);
        }
        self.rig.overseer.recorded(tick);
    }
}

fn named<'a>(events: &'a [WorldEvent], name: &str) -> Vec<&'a WorldEvent> {
    events
        .iter()
        .filter(|e| WorldEvent::name_of(e.kind) == name)
        .collect()
}

#[test]
fn the_simulator_obeys_the_driver_of_a_robot_and_nobody_else() {
    let rig = Rig::new(ROOM, "simulator");
    let cop = rig.publisher::<Commands>(COP, 1);
    let thief = rig.publisher::<Commands>(THIEF, 1);
    let eyes = rig.publisher::<Commands>(EYES, 1);
    let drivers = Drivers::take_off(rig);
    for port in [&cop, &thief, &eyes] {
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
    drivers.rig.overseer.set_phase(Phase::Run);
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
    eyes.send(header(1), &ahead(0)).unwrap();
    eyes.send(header(1), &ahead(99)).unwrap();
    drivers.done(1);
    let (robots, events) = drivers.turn(2);
    assert_eq!(
        at(&robots, 0),
        at(&before, 0),
        "nobody who drives it said anything"
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
    cop.send(header(3), &command(0, 1e300, -1e300)).unwrap();
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
    let sound = drivers.rig.plan.replays[0].event;
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
    drivers.rig.overseer.set_phase(Phase::Run);
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

/// Ways in which a process is told to end, and the exit code that follows.
const ENDINGS: [(&str, fn(&mut Rig)); 3] = [
    ("phase", |rig| rig.overseer.set_phase(Phase::Stop)),
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
        drivers.rig.overseer.set_phase(Phase::Run);
        drivers.turn(0);
        let mut rig = drivers.rig;
        tell(&mut rig);
        let (status, words) = rig.process.end();
        assert_eq!((status.code(), &*words), (Some(0), ""), "simulator, {how}");
        assert_eq!(rig.state(), SlotState::Stopped, "simulator, {how}");
    }
}

#[test]
fn configurations_that_cannot_be_used_are_named() {
    let sandbox = support::Sandbox::new();
    let call = |kind: &str| {
        let words = ["process", kind, "--config", "process.json"].map(str::to_owned);
        sandbox
            .protean(words.iter().map(String::as_str).collect::<Vec<_>>())
            .run()
    };
    call("pursuer").refused(1, &["process configuration process.json", "No such file"]);
    sandbox.file("process.json", "{ \"run\": 3 }");
    call("pursuer").refused(1, &["process configuration process.json", "line 1"]);
    call("nobody").refused(2, &["no process of kind \"nobody\""]);
}
