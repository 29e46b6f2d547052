//! Single real processes against a test that plays all the others, honest and hostile.

mod endings;
mod perception;
mod planners;
mod simulator;

use crate::support::rig::{Rig, World};
use ipc_types::bus::Subscriber;
use ipc_types::messages::robot::Command;
use ipc_types::topics::{Commands, Plan};

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
const VIEWPOINTS: u32 = 1;
const COP: u32 = 2;
const THIEF: u32 = 3;

/// The outputs of a planner.
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
        let clocks = stamp.clone().clocks_mut().map(|clock| *clock);
        assert!(clocks.is_sorted() && clocks[0] > 0, "{stamp:?}");
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
pub fn send_map(world: &World, rig: &Rig) {
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
