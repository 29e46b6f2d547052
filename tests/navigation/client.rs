//! The navigator process, with the test in the place of an optimiser that is silent, gone or hostile.

use crate::process::send_map;
use crate::support::rig::{Rig, World};
use ipc_types::bus::{ActiveRequest, Server, Subscriber};
use ipc_types::messages::optimiser::{PlanResponse, TrajectorySample};
use ipc_types::topics::{Commands, OptimiserPlan};

const ROOM: &str = r#"
[world]
map = "builtin:hello"
[rules]
time_limit = 10.0
[[robots]]
name = "scout"
team = "neutral"
start = { x = 0.5, y = 0.5, theta = 0.0 }
goal = { circle = { center = [3.5, 0.5], radius = 0.2 } }
[[processes]]
kind = "optimiser"
[[processes]]
kind = "navigator"
robots = ["scout"]
"#;

struct Navigator {
    rig: Rig,
    world: World,
    commands: Subscriber<Commands>,
    server: Option<Server<OptimiserPlan>>,
}

/// A running navigator, and the server that answers it.
fn navigator(is_served: bool) -> Navigator {
    let mut rig = Rig::new(ROOM, "navigator");
    let server = is_served.then(|| rig.bus.server(1, 16).unwrap());
    let (world, commands) = (World::open(&rig), rig.subscriber());
    rig.take_off();
    world.begin(&mut rig, send_map);
    Navigator {
        rig,
        world,
        commands,
        server,
    }
}

impl Navigator {
    /// The next request; the robot stands until then.
    fn asked(&self, tick: &mut u64) -> ActiveRequest<OptimiserPlan> {
        loop {
            self.world.tick(&self.rig, *tick);
            assert_eq!(self.command(), (0.0, 0.0), "tick {tick}");
            *tick += 1;
            assert!(*tick < 200, "it asks again");
            let server = self.server.as_ref().unwrap();
            if let Some(request) = server.receive().unwrap() {
                return request;
            }
        }
    }

    fn command(&self) -> (f64, f64) {
        let message = self.commands.receive().unwrap().expect("a command");
        (message.elements()[0].v, message.elements()[0].omega)
    }
}

#[test]
fn an_optimiser_that_is_gone_leaves_the_robot_standing_until_one_is_back() {
    let mut navigator = navigator(false);
    for tick in 0..30 {
        navigator.world.tick(&navigator.rig, tick);
        assert_eq!(navigator.command(), (0.0, 0.0), "tick {tick}");
    }
    navigator.server = Some(navigator.rig.bus.server(1, 16).unwrap());
    navigator.asked(&mut 30);
}

#[test]
fn answers_that_make_no_sense_leave_the_robot_standing() {
    let navigator = navigator(true);
    let sample = |time_s: f64, x: f64, v: f64| TrajectorySample {
        time_s,
        x,
        y: 0.5,
        v,
        ..TrajectorySample::default()
    };
    let hostile: [&[TrajectorySample]; 5] = [
        &[],
        &[sample(f64::NAN, 0.5, 0.2)],
        &[sample(0.0, 0.5, 0.2), sample(1.0, f64::INFINITY, 0.2)],
        &[sample(0.0, 0.5, 0.2), sample(-1.0, 0.7, 0.2)],
        &[sample(0.0, 0.5, 0.2), sample(1.0, 1e300, 0.2)],
    ];
    let mut tick = 0;
    for samples in hostile {
        // It is answered nonsense, and asks again a second later.
        let request = navigator.asked(&mut tick);
        request.answer(PlanResponse::default(), samples).unwrap();
    }
    // What makes sense is driven.
    let request = navigator.asked(&mut tick);
    let sensible = [sample(0.0, 0.5, 0.2), sample(5.0, 1.5, 0.2)];
    request.answer(PlanResponse::default(), &sensible).unwrap();
    navigator.world.tick(&navigator.rig, tick);
    let (v, omega) = navigator.command();
    assert!((v - 0.2).abs() < 1e-9 && omega == 0.0, "{v} {omega}");
}
