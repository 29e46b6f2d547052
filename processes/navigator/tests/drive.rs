//! The navigator's model of the drive is that of the world.

use core::time::Duration;

use geometry::map::{MapSpec, VectorMap};
use geometry::pose::{Pose2, Twist2};
use navigator::drive::Drive;
use proptest::prelude::*;
use sim_backend::spec::{LimitsSpec, RobotSpec, RulesSpec, WorldSpec};
use sim_backend::team::Role;
use sim_backend::world::World;
use steering::go_to::coast;

const DT: Duration = Duration::from_millis(50);

/// A world with one robot in the middle of a large empty map.
fn world(limits: LimitsSpec) -> World {
    let robot = RobotSpec {
        limits,
        ..RobotSpec::new("scout", Role::Neutral, Pose2::new(0.0, 0.0, 0.3))
    };
    World::new(WorldSpec {
        map: MapSpec::Vector(VectorMap::empty([-50.0, -50.0], [50.0, 50.0], 0.5)),
        robots: vec![robot],
        rules: RulesSpec::default(),
        seed: 1,
    })
    .unwrap()
}

proptest! {
    #[test]
    fn a_prediction_is_what_the_world_executes(
        acceleration in proptest::option::of(0.05..3.0f64),
        angular_acceleration in proptest::option::of(0.1..10.0f64),
        wheel_speed_max in proptest::option::of(0.1..1.2f64),
        commands in proptest::collection::vec((-1.5..1.5f64, -6.0..6.0f64), 1..40),
    ) {
        let mut world = world(LimitsSpec {
            v_max: Some(1.0),
            v_reverse_max: Some(0.5),
            omega_max: Some(4.0),
            acceleration,
            angular_acceleration,
            wheel_speed_max,
        });
        let drive = Drive::new(world.robots()[0].model);
        let (mut pose, mut twist) = (world.robots()[0].pose, Twist2::STOP);
        for (v, omega) in commands {
            let command = drive.clip(Twist2::new(v, omega));
            twist = drive.execute(twist, command, DT.as_secs_f64());
            pose = coast(&pose, twist, DT.as_secs_f64());
            world.step(&[Some(command)], DT);
            let robot = &world.robots()[0];
            prop_assert_eq!(robot.twist, twist);
            prop_assert!((robot.pose.position() - pose.position()).norm() < 1e-9);
        }
    }
}
