use proptest::prelude::*;
use testing::{circle, rectangle};

use super::*;
use crate::spec::ObstacleResponse;

fn wall(x: f64, y: f64, hx: f64, hy: f64) -> Shape {
    rectangle([x, y], [hx, hy])
}

fn position(world: &World, i: usize) -> nalgebra::Point2<f64> {
    world.robots()[i].pose.position()
}

#[test]
fn no_robot_tunnels_through_a_thin_wall() {
    let map = room(vec![wall(0.0, 0.0, 1e-6, 5.0)]);
    let mut world = world(
        map,
        vec![racer("a", Role::Neutral, -3.0, 0.0, 0.0)],
        RulesSpec::default(),
    );
    world.step(&[drive(100.0, 0.0)], Duration::from_secs(1));
    assert!(
        (position(&world, 0).x + 0.1).abs() < 1e-5,
        "{}",
        position(&world, 0).x
    );
    assert_eq!(
        kinds(world.events()),
        [EventKind::ContactBegan {
            robot: 0,
            with: ContactWith::Wall
        }]
    );
    assert!(world.robots()[0].twist.v < 3.0);
}

#[test]
fn a_blocked_robot_slides_or_stops_by_the_rules() {
    let heading = -core::f64::consts::FRAC_PI_4;
    for (blocked, x) in [
        (ObstacleResponse::Slide, 1.0),
        (ObstacleResponse::Stop, 0.2),
    ] {
        let rules = RulesSpec {
            blocked,
            ..RulesSpec::default()
        };
        let robot = racer("a", Role::Neutral, 0.0, -4.7, heading);
        let mut world = world(room(vec![]), vec![robot], rules);
        world.step(&[drive(2.0f64.sqrt(), 0.0)], Duration::from_secs(1));
        let p = position(&world, 0);
        assert!(
            (p.y + 4.9).abs() < 1e-6 && (p.x - x).abs() < 1e-5,
            "{blocked:?} {p}"
        );
        // Turning away frees it.
        world.step(
            &[drive(0.0, core::f64::consts::FRAC_PI_2)],
            Duration::from_secs(1),
        );
        world.step(&[drive(1.0, 0.0)], Duration::from_secs(1));
        assert!(position(&world, 0).y > -4.3);
        assert!(!world.robots()[0].touches_wall);
        assert_eq!(world.robots()[0].contacts.wall, 1);
    }
}

#[test]
fn a_corner_holds_a_robot_without_counting_it_again_and_again() {
    let robot = racer("a", Role::Neutral, 4.0, 4.0, 0.8);
    let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
    for _ in 0..100 {
        world.step(&[drive(1.0, 0.0)], TICK);
    }
    let p = position(&world, 0);
    assert!((p.x - 4.9).abs() < 1e-6 && (p.y - 4.9).abs() < 1e-6, "{p}");
    let contacts = world.robots()[0].contacts;
    assert_eq!(contacts.wall, 1);
    assert!(contacts.wall_ticks > 60);
    assert_eq!(world.robots()[0].twist.v, 0.0);
}

#[test]
fn sliding_around_a_round_obstacle_keeps_contact_precision() {
    let map = room(vec![circle([0.0, 0.0], 1.0)]);
    let robot = racer("a", Role::Neutral, -2.0, 0.3, 0.0);
    let mut world = world(map, vec![robot], RulesSpec::default());
    let mut touched = false;
    for _ in 0..200 {
        world.step(&[drive(0.5, 0.0)], TICK);
        let gap = position(&world, 0).coords.norm() - 1.1;
        assert!(gap > 0.0, "{gap}");
        touched |= world.robots()[0].touches_wall;
    }
    assert!(touched);
    assert_eq!(
        world.robots()[0].contacts.wall,
        1,
        "one slide is one contact"
    );
    assert!(
        position(&world, 0).x > 1.0,
        "it got past: {}",
        position(&world, 0)
    );
}

#[test]
fn a_standing_robot_is_not_pushed_and_blocks_a_moving_one() {
    let robots = vec![
        racer("runner", Role::Neutral, -2.0, 0.0, 0.0),
        racer("post", Role::Neutral, 0.0, 0.0, 0.0),
    ];
    let mut world = world(room(vec![]), robots, RulesSpec::default());
    world.step(&[drive(50.0, 0.0), None], Duration::from_secs(1));
    assert_eq!(position(&world, 1), nalgebra::Point2::origin());
    assert!((position(&world, 0).x + 0.2).abs() < 1e-6);
    let with = ContactWith::Robot(1);
    assert_eq!(
        kinds(world.events()),
        [EventKind::ContactBegan { robot: 0, with }]
    );
    assert_eq!(world.robots()[0].contacts.robot, 1);
    assert_eq!(world.robots()[1].contacts.robot, 1);
    // The post drives away: no longer in contact, and never pushed.
    world.step(&[None, drive(1.0, 0.0)], Duration::from_secs(1));
    assert_eq!(
        kinds(world.events()),
        [EventKind::ContactEnded { robot: 0, with }]
    );
}

#[test]
fn two_that_drive_at_each_other_meet_in_the_middle() {
    let robots = vec![
        racer("a", Role::Neutral, -2.0, 0.0, 0.0),
        racer("b", Role::Neutral, 2.0, 0.0, core::f64::consts::PI),
    ];
    let mut world = world(room(vec![]), robots, RulesSpec::default());
    world.step(
        &[drive(90.0, 0.0), drive(90.0, 0.0)],
        Duration::from_secs(1),
    );
    assert!((position(&world, 0).x + 0.1).abs() < 1e-6);
    assert!((position(&world, 1).x - 0.1).abs() < 1e-6);
}

#[test]
fn a_robot_that_hits_from_behind_stops_and_the_other_drives_on() {
    let robots = vec![
        racer("slow", Role::Neutral, 0.0, 0.0, 0.0),
        racer("fast", Role::Neutral, -1.0, 0.0, 0.0),
    ];
    let mut world = world(room(vec![]), robots, RulesSpec::default());
    world.step(&[drive(1.0, 0.0), drive(3.0, 0.0)], Duration::from_secs(1));
    assert!((position(&world, 0).x - 1.0).abs() < 1e-12);
    // They met after 0.4 s at x = 0.4.
    assert!(
        (position(&world, 1).x - 0.2).abs() < 1e-5,
        "{}",
        position(&world, 1).x
    );
}

#[test]
fn near_walls_the_arc_is_exact_as_long_as_nothing_is_touched() {
    let start = Pose2::new(4.85, 0.0, core::f64::consts::FRAC_PI_2 + 0.2);
    let mut spec = racer("a", Role::Neutral, start.x, start.y, start.theta);
    spec.name = "near".to_owned();
    let mut world = world(room(vec![]), vec![spec], RulesSpec::default());
    let twist = Twist2::new(0.4, 0.3);
    world.step(&[Some(twist)], TICK);
    let exact = drive::integrate(start, twist, 0.05);
    assert_eq!(world.robots()[0].pose, exact);
    assert_eq!(world.robots()[0].twist, twist);
}

fn any_shape() -> impl Strategy<Value = Shape> {
    let center = || (-4.5..4.5f64, -4.5..4.5f64).prop_map(|(x, y)| [x, y]);
    prop_oneof![
        (center(), 0.05..1.0f64).prop_map(|(center, radius)| Shape::Circle { center, radius }),
        (
            center(),
            0.02..1.5f64,
            0.02..1.5f64,
            prop_oneof![Just(0.0), -3.0..3.0f64]
        )
            .prop_map(|(center, a, b, angle)| Shape::Rectangle {
                center,
                half_extents: [a, b],
                angle
            }),
        (center(), 0.3..1.0f64).prop_map(|([x, y], s)| Shape::Polygon {
            vertices: vec![
                [x, y],
                [x + s, y - s],
                [x + 2.0 * s, y],
                [x + s, y + 0.1 * s]
            ]
        }),
    ]
}

/// The gaps (m) of every active robot to obstacles and to every other robot with a body.
fn smallest_gap(world: &World) -> f64 {
    let mut smallest = f64::INFINITY;
    for (i, a) in world
        .robots()
        .iter()
        .enumerate()
        .filter(|(_, r)| r.is_active())
    {
        assert!(a.pose.is_finite() && a.twist.is_finite() && a.distance_travelled.is_finite());
        let p = a.pose.position();
        smallest = smallest.min(world.map().distance(p) - a.radius());
        for b in world
            .robots()
            .iter()
            .skip(i + 1)
            .filter(|r| has_body(r, world.rules()))
        {
            let distance = (b.pose.position() - p).norm();
            smallest = smallest.min(distance - a.radius() - b.radius());
        }
    }
    smallest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    #[test]
    fn nothing_ever_penetrates_anything(
        shapes in proptest::collection::vec(any_shape(), 0..8),
        places in proptest::collection::vec((-4.8..4.8f64, -4.8..4.8f64, -3.1..3.1f64, 0.02..0.6f64), 1..8),
        speed in prop_oneof![Just(0.5), Just(5.0), Just(100.0)],
        dt in prop_oneof![Just(0.05), Just(1.0), 0.001..1.0f64],
        stop in any::<bool>(),
        commands in proptest::collection::vec((-1.0..1.0f64, -30.0..30.0f64), 8 * 12),
    ) {
        let rules = RulesSpec {
            blocked: if stop { ObstacleResponse::Stop } else { ObstacleResponse::Slide },
            capture: Some(crate::spec::CaptureSpec::default()),
            ..RulesSpec::default()
        };
        let map = WorldMap::new(&room(shapes.clone())).unwrap();
        let mut robots: Vec<RobotSpec> = Vec::new();
        for (i, (x, y, theta, radius)) in places.into_iter().enumerate() {
            let p = nalgebra::Point2::new(x, y);
            let free = map.distance(p) >= radius && robots.iter().all(|other| {
                (other.start.position() - p).norm() >= radius + other.radius.unwrap()
            });
            if free {
                let team = [Role::Pursuer, Role::Evader, Role::Neutral][i % 3];
                let mut robot = racer(&format!("r{i}"), team, x, y, theta);
                robot.radius = Some(radius);
                robots.push(robot);
            }
        }
        prop_assume!(!robots.is_empty());
        let n = robots.len();
        let spec = WorldSpec { map: room(shapes), robots, rules, seed: 1 };
        let mut world = World::on_map(map, spec).unwrap();
        let dt = Duration::from_secs_f64(dt);
        for step in commands.chunks(8) {
            let commands: Vec<_> = step[..n].iter().map(|&(v, w)| drive(v * speed, w)).collect();
            let before: Vec<_> =
                world.robots().iter().map(|r| (r.pose.position(), r.distance_travelled)).collect();
            world.step(&commands, dt);
            let gap = smallest_gap(&world);
            prop_assert!(gap > -1e-6, "{gap}");
            for (robot, (p, way)) in world.robots().iter().zip(before) {
                let moved = (robot.pose.position() - p).norm();
                let driven = robot.distance_travelled - way;
                prop_assert!(moved <= driven + 1e-9, "moved {moved}, drove {driven}");
                prop_assert!(driven <= speed * dt.as_secs_f64() * (1.0 + 1e-9));
            }
        }
    }

    #[test]
    fn the_same_commands_make_the_same_history(
        commands in proptest::collection::vec((-5.0..5.0f64, -3.0..3.0f64), 3 * 20),
    ) {
        let run = || {
            let robots = vec![
                racer("a", Role::Pursuer, -0.5, 0.0, 0.0),
                racer("b", Role::Evader, 0.5, 0.0, 3.0),
                racer("c", Role::Neutral, 0.0, 0.5, 1.0),
            ];
            let mut world = world(room(vec![wall(2.0, 2.0, 0.5, 0.5)]), robots, RulesSpec::default());
            let mut events = Vec::new();
            for step in commands.chunks(3) {
                let commands: Vec<_> = step.iter().map(|&(v, w)| drive(v, w)).collect();
                events.extend_from_slice(world.step(&commands, TICK));
            }
            (world.robots().to_vec(), events)
        };
        prop_assert_eq!(run(), run());
    }
}
