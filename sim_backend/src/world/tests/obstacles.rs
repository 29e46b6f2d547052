use geometry::map::{ObstacleChange, ObstacleError, ObstacleId};
use testing::rectangle;

use super::*;

fn block(x: f64, y: f64, half: f64) -> Shape {
    rectangle([x, y], [half, half])
}

#[test]
fn obstacles_come_move_and_go_and_the_map_follows() {
    let robot = racer("a", Role::Neutral, -3.0, 0.0, 0.0);
    let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
    let id = ObstacleId(7);
    let clear = |world: &World| {
        world
            .map()
            .line_of_sight([-3.0, 0.0].into(), [3.0, 0.0].into())
    };
    let fresh = world.map().clone();
    assert!(clear(&world));
    world
        .apply(&ObstacleChange::Appear {
            id,
            shape: block(0.0, 0.0, 0.5),
        })
        .unwrap();
    assert!(!clear(&world));
    assert_eq!(
        kinds(world.step(&[], TICK)),
        [EventKind::ObstacleApplied {
            id,
            action: ObstacleAction::Appeared,
            revision: 1
        }]
    );
    world
        .apply(&ObstacleChange::Move {
            id,
            shape: block(0.0, 3.0, 0.5),
        })
        .unwrap();
    assert!(clear(&world));
    assert!(world.map().occupancy().at([0.0, 3.0].into()) == Some(&true));
    world.apply(&ObstacleChange::Disappear { id }).unwrap();
    assert_eq!(world.map().revision(), 3);
    assert_eq!(world.map().occupancy(), fresh.occupancy());
    assert_eq!(world.map().clearance(), fresh.clearance());
    assert_eq!(kinds(world.step(&[], TICK)).len(), 2);
}

#[test]
fn impossible_changes_are_refused_and_change_nothing() {
    let robot = racer("a", Role::Neutral, -3.0, 0.0, 0.0);
    let mut world = world(
        room(vec![block(0.0, 0.0, 0.5)]),
        vec![robot],
        RulesSpec::default(),
    );
    let id = ObstacleId(0);
    let shape = block(2.0, 2.0, 0.1);
    let error = world
        .apply(&ObstacleChange::Appear {
            id,
            shape: shape.clone(),
        })
        .unwrap_err();
    assert_eq!(error, ObstacleError::InUse(id));
    let id = ObstacleId(9);
    let error = world
        .apply(&ObstacleChange::Move { id, shape })
        .unwrap_err();
    assert_eq!(error, ObstacleError::Unknown(id));
    let shape = block(f64::NAN, 0.0, 1.0);
    let error = world
        .apply(&ObstacleChange::Appear { id, shape })
        .unwrap_err();
    assert!(
        error.to_string().contains("`rectangle.center[0]` is NaN"),
        "{error}"
    );
    assert_eq!(world.map().revision(), 0);
    assert!(world.step(&[], TICK).is_empty());
}

#[test]
fn a_robot_under_a_new_obstacle_is_pushed_to_the_nearest_free_place() {
    let robots = vec![
        racer("under", Role::Neutral, 0.3, 0.0, 0.0),
        racer("beside", Role::Neutral, 1.0, 1.0, 0.0),
    ];
    let mut world = world(room(vec![]), robots, RulesSpec::default());
    world
        .apply(&ObstacleChange::Appear {
            id: ObstacleId(1),
            shape: block(0.0, 0.0, 0.5),
        })
        .unwrap();
    let pose = world.robots()[0].pose;
    assert!(
        (pose.x - 0.6).abs() < 1e-4 && pose.y.abs() < 1e-9,
        "{pose:?}"
    );
    let events = kinds(world.step(&[], TICK));
    assert!(
        matches!(events[1], EventKind::PushedOut { robot: 0, distance } if (distance - 0.3).abs() < 1e-4)
    );
    assert_eq!(world.robots()[1].pose.x, 1.0);
    assert!(world.map().is_clear(pose.position(), 0.1));
}

#[test]
fn no_robot_is_pushed_through_another_wall() {
    // Below the robot a thin wall, beyond it the nearest free place; above it a longer path.
    let thin = rectangle([0.0, -0.2], [5.0, 0.01]);
    let robot = racer("a", Role::Neutral, 0.0, 0.0, 0.0);
    let mut world = world(room(vec![thin]), vec![robot], RulesSpec::default());
    let shape = rectangle([0.0, 0.2], [5.0, 0.25]);
    world
        .apply(&ObstacleChange::Appear {
            id: ObstacleId(1),
            shape,
        })
        .unwrap();
    assert!(
        world.robots()[0].pose.y > 0.5,
        "{:?}",
        world.robots()[0].pose
    );
}

#[test]
fn without_a_free_place_a_robot_is_trapped_until_the_obstacle_goes() {
    let robot = racer("a", Role::Neutral, 0.0, 0.0, 0.0);
    let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
    let id = ObstacleId(1);
    world
        .apply(&ObstacleChange::Appear {
            id,
            shape: block(0.0, 0.0, 3.0),
        })
        .unwrap();
    let events = kinds(world.step(&[drive(10.0, 1.0)], TICK));
    assert_eq!(events[1], EventKind::Trapped { robot: 0 });
    for _ in 0..10 {
        world.step(&[drive(10.0, 1.0)], TICK);
    }
    let robot = &world.robots()[0];
    assert!(robot.trapped && robot.pose.x == 0.0 && robot.pose.y == 0.0);
    assert_eq!(robot.distance_travelled, 0.0);
    assert!(robot.pose.theta > 0.5, "it can turn");
    world.apply(&ObstacleChange::Disappear { id }).unwrap();
    let events = kinds(world.step(&[drive(10.0, 0.0)], TICK));
    assert!(events.contains(&EventKind::Released { robot: 0 }));
    assert!(world.robots()[0].distance_travelled > 0.4);
}

/// Distances to obstacles that were known before have no effect on the motion, also when obstacles come and go.
#[test]
fn known_room_does_not_change_the_motion() {
    let robots = || {
        let place = |k: usize| (k as f64 - 1.5, 0.7 * k as f64 - 1.0);
        let robot = |k: usize| {
            let (x, y) = place(k);
            racer(&format!("r{k}"), Role::Neutral, x, y, 1.3 * k as f64)
        };
        (0..4).map(robot).collect()
    };
    let map = || room(vec![block(3.0, 0.0, 0.5), block(-3.0, 2.0, 0.8)]);
    let mut worlds = [(); 2].map(|()| world(map(), robots(), RulesSpec::default()));
    let mut random = Stream::new(3, 1, 0);
    let mut touched = 0;
    for tick in 0..2000 {
        let commands: Vec<_> = (0..4)
            .map(|_| drive(2.0 + 2.0 * random.normal(), 3.0 * random.normal()))
            .collect();
        let [known, fresh] = &mut worlds;
        fresh.motion.forget();
        let id = ObstacleId(100 + tick / 50);
        for world in [&mut *known, &mut *fresh] {
            let shape = block(0.1 * f64::from(tick % 37), 1.5, 0.3);
            match tick % 50 {
                20 => world.apply(&ObstacleChange::Appear { id, shape }).unwrap(),
                45 => world.apply(&ObstacleChange::Disappear { id }).unwrap(),
                _ => {}
            }
            world.step(&commands, TICK);
        }
        assert_eq!(known.robots(), fresh.robots(), "tick {tick}");
        touched += known
            .robots()
            .iter()
            .filter(|robot| robot.touches_wall)
            .count();
    }
    assert!(touched > 100, "{touched}");
}
