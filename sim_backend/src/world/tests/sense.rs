use super::*;
use robot::spec::{OdometrySpec, ScanSpec};
use testing::rectangle;

fn scanner(spec: ScanSpec) -> World {
    let mut robot = racer("a", Role::Neutral, 0.0, 0.0, core::f64::consts::FRAC_PI_2);
    robot.scan = Some(spec);
    let other = racer("b", Role::Neutral, 0.0, -2.0, 0.0);
    let wall = rectangle([0.0, 3.0], [1.0, 0.5]);
    world(room(vec![wall]), vec![robot, other], RulesSpec::default())
}

fn exact() -> ScanSpec {
    ScanSpec {
        beams: 4,
        angle_increment: core::f64::consts::FRAC_PI_2,
        noise: 0.0,
        ..ScanSpec::default()
    }
}

#[test]
fn beams_turn_left_from_the_heading_and_see_walls_and_robots() {
    let world = scanner(exact());
    let mut ranges = Vec::new();
    // Ahead a wall; left the room's wall beyond the range; behind a robot; right out of range.
    world.scan(0, &mut ranges).unwrap();
    assert!((ranges[0] - 2.5).abs() < 1e-6);
    assert_eq!(ranges[1], f32::INFINITY);
    assert!((ranges[2] - 1.9).abs() < 1e-6);
    assert_eq!(ranges[3], f32::INFINITY);
    let world = scanner(ScanSpec {
        range_max: 6.0,
        range_min: 2.0,
        ..exact()
    });
    world.scan(0, &mut ranges).unwrap();
    assert!((ranges[1] - 5.0).abs() < 1e-6);
    assert_eq!(ranges[2], f32::NEG_INFINITY);
    assert!(world.scan(1, &mut ranges).is_none() && ranges.is_empty());
    assert!(world.scan(99, &mut ranges).is_none());
}

#[test]
fn scan_noise_depends_on_the_tick_and_not_on_the_number_of_calls() {
    let mut world = scanner(ScanSpec {
        noise: 0.01,
        ..exact()
    });
    let (mut first, mut again, mut later) = (Vec::new(), Vec::new(), Vec::new());
    world.scan(0, &mut first);
    world.scan(0, &mut again);
    assert_eq!(first, again);
    world.step(&[], TICK);
    world.scan(0, &mut later);
    assert_ne!(first, later);
    assert!((first[0] - 2.5).abs() < 0.06 && first[0] != 2.5);
}

#[test]
fn odometry_is_exact_without_noise_and_drifts_with_it() {
    let drive_around = |spec: Option<OdometrySpec>, slip: f64| {
        let mut robot = racer("a", Role::Neutral, 0.0, 0.0, 0.0);
        robot.odometry = spec;
        robot.actuator.slip = slip;
        let mut world = world(room(vec![]), vec![robot], RulesSpec::default());
        for _ in 0..100 {
            world.step(&[drive(1.0, 0.5)], TICK);
        }
        let (truth, belief) = (world.robots()[0].pose, world.odometry(0).unwrap());
        (truth.position() - belief.position()).norm()
    };
    assert_eq!(drive_around(None, 0.0), 0.0);
    assert!(drive_around(Some(OdometrySpec::default()), 0.0) < 1e-9);
    assert!(drive_around(Some(OdometrySpec::default()), 0.2) > 0.1);
    let noisy = OdometrySpec {
        distance_per_distance: 0.05,
        ..OdometrySpec::default()
    };
    let error = drive_around(Some(noisy), 0.0);
    assert!(error > 1e-4 && error < 1.0, "{error}");
}

#[test]
fn robots_see_each_other_unless_a_wall_is_between() {
    let robots = vec![
        racer("a", Role::Neutral, -2.0, 0.0, 0.0),
        racer("b", Role::Neutral, 2.0, 0.0, 0.0),
        racer("c", Role::Neutral, -2.0, 2.0, 0.0),
    ];
    let wall = Shape::Rectangle {
        center: [0.0, 0.0],
        half_extents: [0.1, 1.5],
        angle: 0.2,
    };
    let world = world(room(vec![wall]), robots, RulesSpec::default());
    assert!(!world.sees(0, 1) && !world.sees(1, 0));
    assert!(world.sees(0, 2) && world.sees(2, 0));
    assert!(!world.sees(0, 9));
}
