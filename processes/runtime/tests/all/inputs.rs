//! Inputs that planners receive from the bus.

use ipc_types::bus::{Bus, BusOptions, PublisherOptions, RunSpace};
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{Belief, RunSize, WorldState};
use runtime::inputs::{PerRobot, StateInput};

/// Separate run space that is deleted when the test ends, also by a panic.
struct Space(
    RunSpace,
    #[expect(dead_code, reason = "removed when dropped")] tempfile::TempDir,
);

impl Space {
    fn new(name: &str) -> Self {
        let directory = tempfile::Builder::new()
            .prefix("pt")
            .tempdir_in("/tmp")
            .unwrap();
        let prefix = format!("pt_{}_{name}_", std::process::id());
        let space = RunSpace::new(directory.path().join("r"), prefix).unwrap();
        space.create_root().unwrap();
        Self(space, directory)
    }
}

impl Drop for Space {
    fn drop(&mut self) {
        let _ = self.0.wipe();
    }
}

#[test]
fn states_are_taken_up_to_the_wanted_tick_and_unsound_ones_never() {
    let space = Space::new("states");
    let options = BusOptions {
        size: RunSize {
            robots: 1,
            processes: 2,
            events: 0,
        },
        recorder_ticks: 2,
        overflow: false,
    };
    let bus = Bus::join(&space.0, options, "test").unwrap();
    let _service = bus.create::<WorldState>().unwrap();
    let publisher = bus
        .publisher::<WorldState>(PublisherOptions::new(0, 1))
        .unwrap();
    let mut input = StateInput::open(&bus, 1).unwrap();
    publisher.update_connections().unwrap();
    input.connect().unwrap();
    for (tick, x) in [(0, 0.0), (1, f64::NAN), (1, 1.0), (2, 2.0)] {
        let mut header = WorldHeader::default();
        header.stamp.tick = tick;
        let robot = RobotState {
            x,
            ..RobotState::default()
        };
        publisher.send(header, &[robot]).unwrap();
    }

    assert!(input.update_to(1).unwrap());
    assert_eq!((input.header.stamp.tick, input.robots[0].x), (1, 1.0));
    assert_eq!(input.rejected, 1, "the state with a NaN");
    assert!(
        input.update().unwrap(),
        "the state of tick 2 was left unread"
    );
    assert_eq!((input.header.stamp.tick, input.robots[0].x), (2, 2.0));
    assert!(!input.update().unwrap());
}

#[test]
fn a_belief_with_one_unusable_number_is_unsound() {
    let is_sound = |header: BeliefHeader, change: fn(&mut Particle)| {
        let mut particles = [Particle::default(); 5];
        change(&mut particles[3]);
        Belief::is_sound(&header, &particles)
    };
    let header = BeliefHeader::default();
    assert!(is_sound(header, |p| p.weight = 0.5));
    let changes: [fn(&mut Particle); 5] = [
        |p| p.x = f32::NAN,
        |p| p.y = f32::INFINITY,
        |p| p.theta = f32::NEG_INFINITY,
        |p| p.weight = f32::INFINITY,
        |p| p.weight = -0.1,
    ];
    assert!(changes.iter().all(|&change| !is_sound(header, change)));
    let mean_x = f64::NAN;
    assert!(!is_sound(BeliefHeader { mean_x, ..header }, |_| {}));
}
