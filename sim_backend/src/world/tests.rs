mod contact;
mod game;
mod history;
mod obstacles;
mod sense;
mod start;

use core::time::Duration;

use geometry::map::MapSpec;
use geometry::shape::Shape;

use super::*;
use robot::spec::{LimitsSpec, RobotSpec};
use robot::team::Role;

const TICK: Duration = Duration::from_millis(50);

/// A room with corners (−5, −5) and (5, 5).
fn room(obstacles: Vec<Shape>) -> MapSpec {
    MapSpec::Vector(testing::map([-5.0; 2], [5.0; 2], 0.1, obstacles))
}

/// A robot of radius 0.1 m with limits of 100 m/s and 100 rad/s.
fn racer(name: &str, role: Role, x: f64, y: f64, theta: f64) -> RobotSpec {
    let mut robot = RobotSpec::new(name, role, Pose2::new(x, y, theta));
    robot.radius = Some(0.1);
    robot.limits = LimitsSpec {
        v_max: Some(100.0),
        v_reverse_max: Some(100.0),
        omega_max: Some(100.0),
        ..LimitsSpec::default()
    };
    robot
}

fn world(map: MapSpec, robots: Vec<RobotSpec>, rules: RulesSpec) -> World {
    World::new(WorldSpec {
        map,
        robots,
        rules,
        seed: 5,
    })
    .unwrap()
}

#[expect(clippy::unnecessary_wraps, reason = "a step takes optional commands")]
fn drive(v: f64, omega: f64) -> Option<Twist2> {
    Some(Twist2::new(v, omega))
}

fn kinds(events: &[WorldEvent]) -> Vec<EventKind> {
    events.iter().map(|e| e.kind).collect()
}
