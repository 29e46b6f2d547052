use parameters::check;
use proptest::prelude::*;

use super::*;

fn limits() -> Limits {
    Limits::new(0.45, 0.45, 2.84).unwrap()
}

fn path(points: &[(f64, f64)]) -> Path {
    Path::new(points.iter().map(|&(x, y)| Point2::new(x, y)))
}

/// Drives until arrival; returns the maximum distance from the path, and the time taken.
fn drive(path: &Path, start: Pose2, params: &TrackingParams) -> (f64, Option<f64>) {
    let mut tracker = PathTracker::default();
    tracker.set_path(path.clone());
    let (mut pose, mut worst, dt) = (start, 0.0_f64, 0.05);
    for tick in 0..4000 {
        let tracking = tracker
            .track(&pose, &limits(), params, |_, _| true)
            .unwrap();
        assert!(limits().allow(tracking.command));
        if tracking.arrived {
            return (worst, Some(f64::from(tick) * dt));
        }
        worst = worst.max(tracking.off_path);
        let Twist2 { v, omega } = tracking.command;
        let (sin, cos) = math::sincos(pose.theta + 0.5 * omega * dt);
        pose = Pose2::new(
            pose.x + v * dt * cos,
            pose.y + v * dt * sin,
            pose.theta + omega * dt,
        );
    }
    (worst, None)
}

#[test]
fn a_straight_path_is_driven_at_full_speed() {
    let params = TrackingParams::default();
    let (worst, time) = drive(&path(&[(0.0, 0.0), (4.5, 0.0)]), Pose2::default(), &params);
    assert!(worst < 1e-9);
    assert!((time.unwrap() - 9.9).abs() < 0.15, "{time:?}");
}

#[test]
fn an_arriving_robot_slows_down_and_stops() {
    let params = TrackingParams {
        arrival_deceleration: Some(0.2),
        ..TrackingParams::default()
    };
    let straight = path(&[(0.0, 0.0), (2.0, 0.0)]);
    let (_, time) = drive(&straight, Pose2::default(), &params);
    assert!(time.is_some());
    let mut tracker = PathTracker::default();
    tracker.set_path(straight);
    let near = Pose2::new(1.9, 0.0, 0.0);
    tracker.progress = 1.9;
    let slow = tracker
        .track(&near, &limits(), &params, |_, _| true)
        .unwrap();
    assert!((slow.command.v - 0.2).abs() < 1e-9, "{slow:?}");
    let there = Pose2::new(2.0, 0.01, 0.0);
    let stop = tracker
        .track(&there, &limits(), &params, |_, _| true)
        .unwrap();
    assert!(stop.arrived && stop.command == Twist2::STOP);
}

#[test]
fn a_robot_turns_first_to_a_path_behind_it() {
    let mut tracker = PathTracker::default();
    tracker.set_path(path(&[(0.0, 0.0), (-3.0, 0.1)]));
    let params = TrackingParams::default();
    let tracking = tracker
        .track(&Pose2::default(), &limits(), &params, |_, _| true)
        .unwrap();
    assert_eq!(tracking.command, Twist2::new(0.0, 2.84));
}

#[test]
fn a_corner_is_not_cut_where_the_short_cut_is_not_clear() {
    let corner = path(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
    let mut tracker = PathTracker::default();
    tracker.set_path(corner);
    tracker.progress = 0.8;
    let params = TrackingParams {
        look_ahead: 0.5,
        ..TrackingParams::default()
    };
    let pose = Pose2::new(0.8, 0.0, 0.0);
    let cut = tracker
        .clone()
        .track(&pose, &limits(), &params, |_, _| true);
    assert!(cut.unwrap().target.y > 0.2);
    let around = tracker.track(&pose, &limits(), &params, |_, to| to.y == 0.0);
    assert_eq!(around.unwrap().target.y, 0.0);
}

#[test]
fn a_path_is_found_again_where_it_crosses_itself() {
    let eight = path(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, -1.0)]);
    let mut tracker = PathTracker::default();
    tracker.set_path(eight);
    let params = TrackingParams::default();
    // At the crossing: on the first pass the robot goes straight on.
    tracker.progress = 0.9;
    let pose = Pose2::new(1.0, 0.0, 0.0);
    let first = tracker
        .clone()
        .track(&pose, &limits(), &params, |_, _| true)
        .unwrap();
    assert!(first.target.x > 1.1, "{first:?}");
    tracker.progress = 4.9;
    let second = tracker
        .track(&pose, &limits(), &params, |_, _| true)
        .unwrap();
    assert!(second.target.y < 0.0, "{second:?}");
}

#[test]
fn an_end_beside_an_earlier_part_of_the_path_is_not_arrived_at_there() {
    let loop_back = path(&[(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 0.03)]);
    let length = loop_back.length();
    let mut tracker = PathTracker::default();
    tracker.set_path(loop_back);
    let params = TrackingParams::default();
    tracker.progress = 0.95;
    let beside = Pose2::new(1.0, 0.0, 0.0);
    let passing = tracker
        .track(&beside, &limits(), &params, |_, _| true)
        .unwrap();
    assert!(!passing.arrived && passing.remaining > 4.0, "{passing:?}");
    tracker.progress = length - 0.1;
    let there = tracker
        .track(&beside, &limits(), &params, |_, _| true)
        .unwrap();
    assert!(there.arrived, "{there:?}");
}

#[test]
fn nothing_to_follow_gives_no_command() {
    let params = TrackingParams::default();
    let mut tracker = PathTracker::default();
    assert!(
        tracker
            .track(&Pose2::default(), &limits(), &params, |_, _| true)
            .is_none()
    );
    tracker.set_path(path(&[(f64::NAN, 0.0)]));
    assert!(
        tracker
            .track(&Pose2::default(), &limits(), &params, |_, _| true)
            .is_none()
    );
    tracker.set_path(path(&[(1.0, 0.0), (1.0, 0.0)]));
    assert_eq!(tracker.path().points().len(), 1);
    let lost = Pose2::new(f64::NAN, 0.0, 0.0);
    assert!(
        tracker
            .track(&lost, &limits(), &params, |_, _| true)
            .is_none()
    );
}

#[test]
fn parameters_out_of_range_are_named() {
    let bad = |change: fn(&mut TrackingParams)| {
        let mut params = TrackingParams::default();
        change(&mut params);
        check(&params).unwrap_err().field
    };
    assert_eq!(bad(|p| p.look_ahead = 0.0), "look_ahead");
    assert_eq!(bad(|p| p.min_look_ahead = 1.0), "min_look_ahead");
    assert_eq!(bad(|p| p.turn_on_spot = 4.0), "turn_on_spot");
    assert_eq!(bad(|p| p.omega_cap = Some(-1.0)), "omega_cap");
    check(&TrackingParams::default()).unwrap();
}

proptest! {
    #[test]
    fn every_path_with_gentle_corners_is_followed_to_its_end(
        turns in prop::collection::vec(-1.0..1.0, 1..12),
        theta in -3.0..3.0,
    ) {
        let (mut at, mut heading) = (Point2::origin(), 0.0);
        let mut points = vec![at];
        for turn in turns {
            heading += turn;
            let (sin, cos) = math::sincos(heading);
            at += nalgebra::Vector2::new(cos, sin);
            points.push(at);
        }
        let start = Pose2::new(0.0, 0.0, theta);
        let (worst, time) = drive(&Path::new(points), start, &TrackingParams::default());
        prop_assert!(time.is_some());
        // At a look-ahead of 0.43 m the inside of a corner of 1 rad is cut by up to 0.15 m. A start
        // with a wrong heading that does not turn on the spot deviates by as much.
        prop_assert!(worst < 0.25, "{}", worst);
    }

    #[test]
    fn commands_are_within_limits_for_any_pose(
        x in prop::num::f64::ANY, y in prop::num::f64::ANY, theta in prop::num::f64::ANY,
    ) {
        let mut tracker = PathTracker::default();
        tracker.set_path(path(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]));
        let pose = Pose2::new(x, y, theta);
        let params = TrackingParams::default();
        if let Some(tracking) = tracker.track(&pose, &limits(), &params, |_, _| true) {
            prop_assert!(limits().allow(tracking.command));
        }
    }

    #[test]
    fn points_along_a_path_project_onto_themselves(along in 0.0..3.0) {
        let path = path(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 2.0)]);
        let p = path.at(along).unwrap();
        let (found, distance) = path.project(p, 0.0, path.length()).unwrap();
        prop_assert!(distance < 1e-9 && (found - along).abs() < 1e-9);
    }
}
