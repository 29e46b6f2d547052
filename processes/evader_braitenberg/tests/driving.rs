//! The Braitenberg vehicle in a corridor and in the paper's city.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use evader_braitenberg::{Braitenberg, BraitenbergParams};
use geometry::pose::{Pose2, Twist2};
use planner_view::limits::Limits;
use planner_view::view::{RobotView, ScanView, View};
use proptest::prelude::*;
use robot::team::Role;
use testing::{Arena, DT, Kinematic, street_starts};

const V_MAX: f64 = 0.6;
const RANGE: f64 = 3.5;

fn limits() -> Limits {
    Limits::new(V_MAX, V_MAX, 2.84).unwrap()
}

fn robot(pose: Pose2) -> RobotView {
    testing::robot(0, Role::Evader, pose, V_MAX)
}

fn view<'a>(robots: &'a [RobotView], scan: Option<ScanView<'a>>) -> View<'a> {
    View {
        scan,
        ..testing::view(0.0, robots, &[])
    }
}

fn drive(params: BraitenbergParams, arena: &Arena, body: &mut Kinematic, seconds: f64) {
    let mut vehicle = Braitenberg::new(params, limits(), 3).unwrap();
    for _ in 0..(seconds / DT) as usize {
        let ranges = arena.scan(&body.pose, RANGE);
        let scan = ScanView {
            angle_min: 0.0,
            angle_increment: 1.0_f64.to_radians(),
            range_min: 0.12,
            range_max: RANGE,
            ranges: &ranges,
        };
        let steering = vehicle.command(&view(&[robot(body.pose)], Some(scan)));
        assert!(limits().allow(steering.command));
        body.step(arena, steering.command, DT);
    }
}

/// A street along x, 1 m wide, open for 40 m.
fn corridor() -> Arena {
    Arena {
        rectangles: vec![(-20.0, 20.0, 0.5, 1.5), (-20.0, 20.0, -1.5, -0.5)],
        chamfered: false,
    }
}

#[test]
fn it_centres_itself_in_a_corridor_and_drives_at_its_speed_without_touching() {
    for (y, theta) in [(0.0, 0.0), (0.25, 0.3), (-0.3, -0.5), (0.3, 0.8)] {
        let mut body = Kinematic::new(-10.0, y, theta);
        drive(BraitenbergParams::default(), &corridor(), &mut body, 15.0);
        assert_eq!(body.contacts, 0, "from {y}, {theta}");
        assert!(
            body.pose.y.abs() < 0.05 && body.pose.theta.abs() < 0.1,
            "{:?}",
            body.pose
        );
        assert!(body.travelled > 0.85 * 15.0 * V_MAX, "{} m", body.travelled);
    }
}

#[test]
fn the_papers_formula_takes_eight_times_as_long() {
    let mut body = Kinematic::new(-10.0, 0.0, 0.0);
    drive(BraitenbergParams::paper(), &corridor(), &mut body, 15.0);
    assert!(
        (0.08..0.14).contains(&(body.travelled / (15.0 * V_MAX))),
        "{} m",
        body.travelled
    );
}

#[test]
fn it_keeps_moving_through_the_city_without_touching_a_wall() {
    let arena = Arena::city();
    for start in street_starts().into_iter().step_by(8) {
        let mut body = Kinematic::new(start.x, start.y, start.theta);
        drive(BraitenbergParams::default(), &arena, &mut body, 30.0);
        assert_eq!(body.contacts, 0, "from {start:?}");
        assert!(body.travelled > 4.0, "{} m from {start:?}", body.travelled);
    }
}

#[test]
fn it_stands_still_without_a_scan_and_when_caught() {
    let mut vehicle = Braitenberg::new(BraitenbergParams::default(), limits(), 3).unwrap();
    let robots = [robot(Pose2::default())];
    assert_eq!(vehicle.command(&view(&robots, None)).command, Twist2::STOP);
    let ranges = [2.0; 360];
    let scan = ScanView {
        angle_min: 0.0,
        angle_increment: 1.0_f64.to_radians(),
        range_min: 0.12,
        range_max: RANGE,
        ranges: &ranges,
    };
    assert_ne!(
        vehicle.command(&view(&robots, Some(scan))).command,
        Twist2::STOP
    );
    let caught = [RobotView {
        active: false,
        ..robots[0]
    }];
    assert_eq!(
        vehicle.command(&view(&caught, Some(scan))).command,
        Twist2::STOP
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn commands_are_finite_and_within_limits_for_any_scan(
        ranges in prop::collection::vec(prop::num::f32::ANY, 0..80),
        angle_min in prop::num::f64::ANY,
        angle_increment in prop::num::f64::ANY,
        range_min in prop::num::f64::ANY,
        range_max in prop::num::f64::ANY,
        paper in any::<bool>(),
        tame in any::<bool>(),
    ) {
        let params =
            if paper { BraitenbergParams::paper() } else { BraitenbergParams::default() };
        let mut vehicle = Braitenberg::new(params, limits(), 3).unwrap();
        let scan = if tame {
            ScanView { angle_min: -2.0, angle_increment: 0.05, range_min, range_max, ranges: &ranges }
        } else {
            ScanView { angle_min, angle_increment, range_min, range_max, ranges: &ranges }
        };
        let steering = vehicle.command(&view(&[robot(Pose2::default())], Some(scan)));
        prop_assert!(limits().allow(steering.command), "{:?}", steering.command);
    }
}
