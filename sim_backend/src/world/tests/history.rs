//! Long histories: they stay valid under changes of the map, and have the same bits on every
//! machine.

use geometry::map::{ObstacleChange, ObstacleId};
use proptest::prelude::*;

use super::*;
use crate::random::Stream;
use crate::spec::CaptureSpec;
use robot::spec::{ActuatorSpec, ScanSpec};

/// Steps a crowded world with noise, contacts and captures, and hashes all states, scans and numbers
/// of events (FNV-1a).
fn digest() -> u64 {
    let mut digest = 0xcbf2_9ce4_8422_2325u64;
    let mut fold = |bits: u64| {
        for byte in bits.to_le_bytes() {
            digest = (digest ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    let tower = Shape::Circle {
        center: [1.0, 1.0],
        radius: 0.7,
    };
    let turned = Shape::Rectangle {
        center: [-1.0, 1.5],
        half_extents: [1.0, 0.2],
        angle: 0.4,
    };
    let robots = (0..6).map(|i| {
        let role = if i < 4 { Role::Pursuer } else { Role::Evader };
        let x = -4.0 + 1.5 * f64::from(i);
        let mut robot = racer(&format!("r{i}"), role, x, -2.0, f64::from(i));
        robot.limits.v_max = Some(1.0);
        robot.actuator = ActuatorSpec {
            noise: 0.1,
            veer: 0.2,
            ..ActuatorSpec::default()
        };
        robot.scan = Some(ScanSpec {
            beams: 16,
            ..ScanSpec::default()
        });
        robot
    });
    let rules = RulesSpec {
        capture: Some(CaptureSpec {
            radius: 0.25,
            dwell: 0.1,
            ..CaptureSpec::default()
        }),
        ..RulesSpec::default()
    };
    let mut world = world(room(vec![tower, turned]), robots.collect(), rules);
    let mut random = Stream::new(9, 9, 9);
    let mut ranges = Vec::new();
    for _ in 0..2000 {
        let commands: Vec<_> = (0..6)
            .map(|_| drive(random.uniform(), random.normal()))
            .collect();
        fold(world.step(&commands, TICK).len() as u64);
        for i in 0..6 {
            let robot = &world.robots()[i];
            for value in [robot.pose.x, robot.pose.y, robot.pose.theta, robot.twist.v] {
                fold(value.to_bits());
            }
            world.scan(i, &mut ranges);
            for range in &ranges {
                fold(u64::from(range.to_bits()));
            }
        }
    }
    digest
}

/// If this fails after an intended change of histories, enter the new number here; if it fails on
/// another machine, a computation differs there.
#[test]
fn a_history_has_the_same_bits_on_every_machine() {
    assert_eq!(format!("{:016x}", digest()), "9a49ee214de0922c");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn obstacles_that_pop_up_anywhere_leave_a_sound_world(
        changes in proptest::collection::vec(
            (0..3u32, 0..3u8, -5.0..5.0f64, -5.0..5.0f64, 0.05..2.0f64), 25,
        ),
        seed in any::<u64>(),
    ) {
        let robots = (0..5)
            .map(|i| {
                racer(&format!("r{i}"), Role::Neutral, -3.0 + 1.5 * f64::from(i), 0.0, f64::from(i))
            })
            .collect();
        let mut world = world(room(vec![]), robots, RulesSpec::default());
        let mut random = Stream::new(seed, 0, 0);
        for (id, action, x, y, size) in changes {
            let id = ObstacleId(id);
            let shape = Shape::Rectangle { center: [x, y], half_extents: [size, 0.3], angle: x };
            let change = match action {
                0 => ObstacleChange::Appear { id, shape },
                1 => ObstacleChange::Move { id, shape },
                _ => ObstacleChange::Disappear { id },
            };
            let stands = world.map().obstacles().iter().any(|o| o.id == id);
            prop_assert_eq!(world.apply(&change).is_ok(), stands == (action != 0));
            for _ in 0..3 {
                let commands: Vec<_> =
                    (0..5).map(|_| drive(10.0 * random.uniform(), 5.0 * random.normal())).collect();
                world.step(&commands, TICK);
                for (i, a) in world.robots().iter().enumerate() {
                    prop_assert!(a.pose.is_finite() && a.twist.is_finite());
                    let gap = world.map().distance(a.pose.position()) - a.radius();
                    prop_assert!(a.trapped || gap > -1e-6, "{} {gap}", a.name);
                    for b in &world.robots()[..i] {
                        let distance = (a.pose.position() - b.pose.position()).norm();
                        prop_assert!(distance - a.radius() - b.radius() > -1e-6);
                    }
                }
            }
        }
    }
}
