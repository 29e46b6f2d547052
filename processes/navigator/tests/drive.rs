//! The navigator's model of the drive is that of the world.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use core::time::Duration;

use control::go_to::coast;
use geometry::map::{MapSpec, VectorMap};
use geometry::pose::{Pose2, Twist2};
use navigator::Trajectory;
use navigator::drive::Drive;
use navigator::follow::{Follow, Motion, Stops};
use navigator::trajectory::Sample;
use proptest::prelude::*;
use robot::spec::{ActuatorSpec, LimitsSpec, RobotSpec};
use robot::team::Role;
use sim_backend::spec::{RulesSpec, WorldSpec};
use sim_backend::world::World;

const DT: Duration = Duration::from_millis(50);

/// A world with one robot in the middle of a large empty map.
fn world(limits: LimitsSpec, actuator: ActuatorSpec) -> World {
    let robot = RobotSpec {
        limits,
        actuator,
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
        let limits = LimitsSpec {
            v_max: Some(1.0),
            v_reverse_max: Some(0.5),
            omega_max: Some(4.0),
            acceleration,
            angular_acceleration,
            wheel_speed_max,
        };
        let mut world = world(limits, ActuatorSpec::default());
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

/// A trajectory by stretches of controls that change linearly: duration (s), speeds (m/s) and turning
/// rates (rad/s) at both ends.
fn drive_through(start: Pose2, stretches: &[(f64, [f64; 2], [f64; 2])]) -> Trajectory {
    let (mut t, mut pose) = (0.0, start);
    let mut samples = Vec::new();
    for &(duration, v, omega) in stretches {
        let count = (duration / 0.05).ceil();
        let at = |i: f64| {
            let part = i / count;
            Twist2::new(
                v[0] + (v[1] - v[0]) * part,
                omega[0] + (omega[1] - omega[0]) * part,
            )
        };
        let sample = |t: f64, pose: Pose2, twist: Twist2| Sample { t, pose, twist };
        samples.push(sample(t, pose, at(0.0)));
        for i in 1..=count as u32 {
            let i = f64::from(i);
            pose = coast(&pose, at(i - 0.5), duration / count);
            t += duration / count;
            samples.push(sample(t, pose, at(i)));
        }
    }
    Trajectory::new(samples).unwrap()
}

/// The largest distance (m) between the robot and its reference, and the distance at the end.
fn follow_in_the_world(trajectory: Trajectory, limits: LimitsSpec) -> [f64; 2] {
    let imperfect = ActuatorSpec {
        slip: 0.02,
        noise: 0.05,
        angular_noise: 0.05,
        veer: 0.02,
        ..ActuatorSpec::default()
    };
    let mut world = world(limits, imperfect);
    let drive = Drive::new(world.robots()[0].model);
    let mut follow = Follow {
        trajectory,
        tau: 0.0,
        clearance: 0.1,
        blocked: None,
        careful: false,
        is_stretch: false,
    };
    let dt = DT.as_secs_f64();
    let mut most: f64 = 0.0;
    for _ in 0..(1.2 * follow.left() / dt) as u32 + 20 {
        let robot = &world.robots()[0];
        let motion = Motion {
            pose: robot.pose,
            twist: robot.twist,
        };
        most = most.max(follow.error(&motion.pose));
        let pace = follow.pace(&drive, &motion, &Stops::default(), dt);
        follow.tau += pace.rate * dt;
        world.step(&[Some(pace.command)], DT);
    }
    assert!(follow.left() < 1e-9, "{} s left", follow.left());
    [most, follow.error(&world.robots()[0].pose)]
}

#[test]
fn a_plan_with_cusps_is_followed_as_closely_as_one_without() {
    let start = Pose2::new(0.0, 0.0, 0.3);
    let (v, w) = (0.2, 0.5);
    let stretches = |sign: f64| {
        [
            (3.0, [v; 2], [w; 2]),
            (3.0, [sign * v; 2], [w; 2]),
            (2.0, [v; 2], [-w; 2]),
            (2.0, [sign * v; 2], [0.0; 2]),
        ]
    };
    // At 0.5 m/s², with speeds that change through 0.
    let ramps = |sign: f64| {
        let turn = if sign < 0.0 { 0.8 } else { 0.0 };
        [
            (0.4, [0.0, v], [0.0, w]),
            (3.0, [v; 2], [w; 2]),
            (0.8 + turn, [v, sign * v], [w; 2]),
            (3.0, [sign * v; 2], [w, -w]),
            (0.4, [sign * v, 0.0], [-w, 0.0]),
        ]
    };
    let quick = LimitsSpec::default();
    let slow = LimitsSpec {
        acceleration: Some(0.5),
        angular_acceleration: Some(3.0),
        ..quick
    };
    let error = |stretches: &[(f64, [f64; 2], [f64; 2])], limits: LimitsSpec| {
        follow_in_the_world(drive_through(start, stretches), limits)
    };
    for (forwards, cusps) in [
        (
            error(&stretches(1.0), quick),
            error(&stretches(-1.0), quick),
        ),
        (error(&ramps(1.0), slow), error(&ramps(-1.0), slow)),
    ] {
        // The navigator plans anew at 15 mm.
        assert!(
            forwards[0] < 0.01 && cusps[0] < 0.01,
            "{forwards:?} {cusps:?}"
        );
        assert!(
            cusps[0] < 1.5 * forwards[0] + 1e-3,
            "{forwards:?} {cusps:?}"
        );
        assert!(cusps[1] < 4e-3, "{cusps:?}");
    }
}
