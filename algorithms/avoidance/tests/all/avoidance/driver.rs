//! The driver's handling of waypoints.

use crate::drive::{DT, PATROL, Run, route, square};
use avoidance::tangent_bug::Mode;
use avoidance::waypoint_driver::{
    DriverOutput, DriverParams, Situation, WaypointDriver, lap_time, time_without_obstacles,
};
use control::go_to::{GoToParams, coast};
use geometry::pose::{Pose2, Twist2};
use geometry::shape::Convex;
use nalgebra::Point2;
use parameters::check;
use planner_view::limits::Limits;
use planner_view::waypoint::WaypointOutcome::{
    InsideObstacle, Reached, Stuck, TimedOut, Unreachable,
};
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointOutcome};

fn inserted(number: u64, x: f64, y: f64) -> Waypoint {
    Waypoint {
        kind: WaypointKind::Inserted,
        ..route(number, Point2::new(x, y))
    }
}

fn run(parts: Vec<Convex>, params: DriverParams) -> Run {
    Run::new(
        PATROL,
        square(6.0, parts),
        Pose2::new(-4.0, 0.0, 0.0),
        params,
    )
}

/// Drives through all waypoints; returns the lowest speed after the first tick.
fn through(run: &mut Run, waypoints: &[Waypoint], with_scan: bool) -> f64 {
    let mut next = waypoints.iter().copied();
    let mut slowest = f64::INFINITY;
    for _ in 0..20_000 {
        if !run.step(&mut || next.next(), with_scan) {
            return slowest;
        }
        slowest = slowest.min(run.twist.v);
    }
    panic!("no end: {:?}", run.reports);
}

fn outcomes(run: &Run) -> Vec<(u64, WaypointOutcome)> {
    run.reports
        .iter()
        .map(|report| (report.waypoint.number, report.outcome))
        .collect()
}

/// Waypoints ahead, slightly to the left and right in turn.
fn zig_zag() -> Vec<Waypoint> {
    (0..8)
        .map(|i| inserted(i, -3.0 + i as f64, if i % 2 == 0 { 0.1 } else { -0.1 }))
        .collect()
}

#[test]
fn waypoints_ahead_are_passed_at_full_speed() {
    for with_scan in [false, true] {
        for deceleration in [None, Some(0.5)] {
            let params = DriverParams {
                go_to: GoToParams {
                    deceleration,
                    ..GoToParams::default()
                },
                ..DriverParams::default()
            };
            let mut run = run(vec![], params);
            let mut waypoints = zig_zag();
            // At the end of the path, the robot slows down only with a deceleration.
            waypoints.push(inserted(8, 5.5, 0.0));
            let mut slowest = f64::INFINITY;
            let mut next = waypoints.iter().copied();
            while run.step(&mut || next.next(), with_scan) {
                if run.pose.x < 4.0 {
                    slowest = slowest.min(run.twist.v);
                }
            }
            assert_eq!(slowest, 1.0, "{with_scan} {deceleration:?}");
            assert_eq!(run.twist.v < 0.5, deceleration.is_some());
            let all: Vec<_> = (0..9).map(|number| (number, Reached)).collect();
            assert_eq!(outcomes(&run), all);
            assert!(run.reports.iter().all(|report| report.closest <= 0.05));
        }
    }
}

#[test]
fn a_waypoint_passed_between_two_ticks_is_reached() {
    // 0.3 m in a tick, a tolerance of 0.02 m.
    let limits = Limits::new(6.0, 0.0, 3.0).unwrap();
    let params = DriverParams {
        go_to: GoToParams {
            arrived: 0.02,
            ..GoToParams::default()
        },
        ..DriverParams::default()
    };
    let mut driver = WaypointDriver::new(params, limits, 0.1).unwrap();
    let mut reports = Vec::new();
    let mut point = Some(route(0, Point2::new(0.45, 0.0)));
    for (tick, x) in [0.0, 0.3, 0.6].into_iter().enumerate() {
        let situation = Situation {
            pose: Pose2::new(x, 0.0, 0.0),
            twist: Twist2::STOP,
            scan: None,
            known: None,
            time_s: DT * tick as f64,
            dt: DT,
        };
        driver.drive(&mut || point.take(), &situation, &mut reports);
    }
    assert_eq!(reports.len(), 1);
    assert_eq!((reports[0].outcome, reports[0].closest), (Reached, 0.0));
    assert_eq!(driver.current(), None);
}

#[test]
fn inserted_waypoints_inside_known_obstacles_are_left_out_and_points_of_the_route_reported() {
    let block = Convex::rectangle(Point2::new(0.0, 2.0), [0.5, 0.5], 0.0);
    let mut run = run(vec![block], DriverParams::default());
    run.known = Some(run.space.clone());
    let inside = Point2::new(0.0, 1.4);
    through(
        &mut run,
        &[
            inserted(0, 0.0, 2.0),
            inserted(1, inside.x, inside.y),
            inserted(2, -3.0, 0.0),
            route(3, inside),
            route(4, Point2::new(f64::NAN, 0.0)),
            inserted(5, -2.0, 0.0),
        ],
        true,
    );
    let expected = [
        (0, InsideObstacle),
        (1, InsideObstacle),
        (2, Reached),
        (3, Unreachable),
        (4, Unreachable),
        (5, Reached),
    ];
    assert_eq!(outcomes(&run), expected);
    assert_eq!(run.reports[0].closest, f64::INFINITY);
}

#[test]
fn a_source_of_nothing_but_obstacles_does_not_hold_up_the_robot() {
    let block = Convex::rectangle(Point2::new(0.0, 2.0), [0.5, 0.5], 0.0);
    let mut run = run(vec![block], DriverParams::default());
    run.known = Some(run.space.clone());
    let mut number = 0;
    let mut next = || {
        number += 1;
        Some(inserted(number, 0.0, 2.0))
    };
    assert!(!run.step(&mut next, true));
    assert!(run.reports.len() < 100);
    assert_eq!(run.twist, Twist2::STOP);
}

#[test]
fn inserted_waypoints_time_out_after_twice_the_time_and_points_of_the_route_never() {
    let block = || Convex::disc(Point2::new(0.0, 0.0), 1.0);
    let mut late = run(vec![block()], DriverParams::default());
    through(
        &mut late,
        &[inserted(0, 0.0, 0.0), inserted(1, -4.0, 0.5)],
        true,
    );
    assert_eq!(outcomes(&late), [(0, TimedOut), (1, Reached)]);
    let report = late.reports[0];
    // 4 m ahead at 1 m/s.
    assert!(
        (report.ended_s - report.started_s - 8.0).abs() < 1.5 * DT,
        "{report:?}"
    );
    assert!((0.5..1.2).contains(&report.closest), "{report:?}");

    let mut patient = run(vec![block()], DriverParams::default());
    let (inside, behind) = (Point2::new(0.0, 0.0), Point2::new(4.0, 0.0));
    through(&mut patient, &[route(0, inside), route(1, behind)], true);
    assert_eq!(outcomes(&patient), [(0, Unreachable), (1, Reached)]);
    assert!(patient.reports[0].ended_s > 8.0);
    assert!(patient.least_clearance > 0.0);
}

/// Drives through waypoints ahead that are due every two seconds; returns the lowest speed while
/// driving.
fn on_time(run: &mut Run, waypoints: &[Waypoint], start_s: f64) -> f64 {
    let mut next = waypoints.iter().copied();
    let mut slowest = f64::INFINITY;
    loop {
        let situation = Situation {
            pose: run.pose,
            twist: run.twist,
            scan: None,
            known: None,
            time_s: f64::from(run.tick) * DT,
            dt: DT,
        };
        let mut due = |waypoint: &Waypoint| Some(start_s + 2.0 * (waypoint.number + 1) as f64);
        let reports = &mut run.reports;
        let driving =
            (run.driver).drive_on_time(&mut || next.next(), &mut due, &situation, reports);
        if run.driver.current().is_none() {
            return slowest;
        }
        run.twist = driving.command;
        run.pose = coast(&run.pose, run.twist, DT);
        run.tick += 1;
        slowest = slowest.min(run.twist.v);
    }
}

#[test]
fn a_robot_with_time_to_spare_slows_down_and_arrives_when_it_is_due() {
    let distances = [0.8, 1.6, 0.3, 1.2, 1.9, 0.1, 1.0];
    let mut x = -4.0;
    let mut waypoints = Vec::new();
    for (number, distance) in (0..).zip(distances) {
        x += distance;
        waypoints.push(inserted(number, x, 0.0));
    }
    let mut robot = run(vec![], DriverParams::default());
    let slowest = on_time(&mut robot, &waypoints, 0.0);
    // The robot does not stand still to wait.
    assert!((0.02..0.1).contains(&slowest), "{slowest}");
    assert_eq!(robot.reports.len(), distances.len());
    for (report, distance) in robot.reports.iter().zip(distances) {
        assert_eq!(report.outcome, Reached);
        let due = 2.0 * (report.waypoint.number + 1) as f64;
        // The robot has arrived when it is within the tolerance.
        let early = 2.0 * 0.05 / distance + 2.0 * DT;
        let late = report.ended_s - due;
        assert!((-early..=DT).contains(&late), "{late} {report:?}");
    }
}

#[test]
fn a_late_robot_hurries_until_it_has_caught_up() {
    let waypoints: Vec<_> = (0..10).map(|i| inserted(i, -3.0 + i as f64, 0.0)).collect();
    let mut robot = run(vec![], DriverParams::default());
    on_time(&mut robot, &waypoints, -3.5);
    let late = |i: usize| robot.reports[i].ended_s - (2.0 * (i + 1) as f64 - 3.5);
    assert!((late(0) - 2.5).abs() < 0.2 && (late(1) - 1.5).abs() < 0.2);
    assert!((2..10).all(|i| late(i) < late(1)));
    assert!((4..10).all(|i| late(i).abs() < 0.2));
}

#[test]
fn the_time_limit_waits_for_what_is_due_late() {
    // A robot that does not move: half a metre takes half a second, and the waypoint is due after
    // ten.
    let limits = Limits::new(1.0, 0.0, 3.0).unwrap();
    let mut driver = WaypointDriver::new(DriverParams::default(), limits, 0.1).unwrap();
    let mut reports = Vec::new();
    let mut point = Some(inserted(0, 0.5, 0.0));
    let mut tick = 0_u32;
    while reports.is_empty() {
        let situation = Situation {
            pose: Pose2::default(),
            twist: Twist2::STOP,
            scan: None,
            known: None,
            time_s: DT * f64::from(tick),
            dt: DT,
        };
        let mut due = |_: &Waypoint| Some(10.0);
        driver.drive_on_time(&mut || point.take(), &mut due, &situation, &mut reports);
        tick += 1;
    }
    assert_eq!(reports[0].outcome, TimedOut);
    assert!((reports[0].ended_s - 10.5).abs() < 1.5 * DT);
}

#[test]
fn drive_limits_replace_absent_parameters() {
    let given = DriverParams {
        braking: Some(0.4),
        ..DriverParams::default()
    };
    let filled = given.for_drive(Some(1.0), Some(8.0));
    assert_eq!(
        (filled.braking, filled.angular_acceleration),
        (Some(0.4), Some(8.0))
    );
    let wrong = DriverParams {
        angular_acceleration: Some(0.0),
        ..given
    };
    assert_eq!(check(&wrong).unwrap_err().field, "angular_acceleration");
}

#[test]
fn a_robot_that_does_not_move_is_stuck() {
    let limits = Limits::new(1.0, 0.0, 3.0).unwrap();
    let mut driver = WaypointDriver::new(DriverParams::default(), limits, 0.1).unwrap();
    let mut reports = Vec::new();
    let mut points = [
        route(0, Point2::new(3.0, 0.0)),
        route(1, Point2::new(0.0, 0.0)),
    ]
    .into_iter();
    let mut tick = 0_u32;
    while tick == 0 || driver.current().is_some() {
        let situation = Situation {
            pose: Pose2::default(),
            twist: Twist2::STOP,
            scan: None,
            known: None,
            time_s: DT * f64::from(tick),
            dt: DT,
        };
        driver.drive(&mut || points.next(), &situation, &mut reports);
        tick += 1;
    }
    assert_eq!(reports[0].outcome, Stuck);
    assert!((reports[0].ended_s - 15.0).abs() < 2.0 * DT);
    assert_eq!(reports[1].outcome, Reached);
}

#[test]
fn a_robot_that_does_not_move_among_echoes_plans_a_detour_before_it_is_stuck() {
    // A wall ahead that the robot could go around, and a drive that does not obey.
    let wall = Convex::rectangle(Point2::new(-3.4, 0.0), [0.1, 0.4], 0.0);
    let mut robot = run(vec![wall], DriverParams::default());
    let ranges = robot.scan();
    let mut point = Some(route(0, Point2::new(3.0, 0.0)));
    let mut reports = Vec::new();
    let mut detour_s = None;
    for tick in 0.. {
        let time_s = DT * f64::from(tick);
        let situation = Situation {
            pose: robot.pose,
            twist: Twist2::STOP,
            scan: Some(robot.machine.view(&ranges)),
            known: None,
            time_s,
            dt: DT,
        };
        let driving = (robot.driver).drive(&mut || point.take(), &situation, &mut reports);
        if robot.driver.current().is_none() {
            break;
        }
        if driving.mode == Some(Mode::Detour) {
            detour_s = detour_s.or(Some(time_s));
        }
    }
    assert!((detour_s.unwrap() - 7.5).abs() < 2.0 * DT, "{detour_s:?}");
    assert_eq!(reports[0].outcome, Stuck);
    assert!((reports[0].ended_s - 15.0).abs() < 2.0 * DT);
}

#[test]
fn input_that_is_not_finite_stops_the_robot_and_changes_nothing() {
    let limits = Limits::new(1.0, 0.0, 3.0).unwrap();
    let mut driver = WaypointDriver::new(DriverParams::default(), limits, 0.1).unwrap();
    let good = Situation {
        pose: Pose2::default(),
        twist: Twist2::STOP,
        scan: None,
        known: None,
        time_s: 0.0,
        dt: DT,
    };
    let lost = Pose2 {
        theta: f64::NAN,
        ..Pose2::default()
    };
    let bad = [
        Situation { pose: lost, ..good },
        Situation {
            time_s: f64::NAN,
            ..good
        },
        Situation { dt: 0.0, ..good },
    ];
    let mut reports = Vec::new();
    for situation in &bad {
        let mut next = || -> Option<Waypoint> { panic!("nothing is taken up") };
        let DriverOutput {
            command, towards, ..
        } = driver.drive(&mut next, situation, &mut reports);
        assert_eq!((command, towards), (Twist2::STOP, None));
    }
    assert!(reports.is_empty());
    assert!(WaypointDriver::new(DriverParams::default(), limits, f64::NAN).is_err());
    let wrong = DriverParams {
        go_to: GoToParams {
            turn_gain: 0.0,
            ..GoToParams::default()
        },
        ..DriverParams::default()
    };
    let error = WaypointDriver::new(wrong, limits, 0.1).unwrap_err();
    assert_eq!(error.field, "go_to.turn_gain");
}

#[test]
fn the_lap_time_is_the_time_the_driver_needs() {
    let corners = [
        (-4.0, 4.0),
        (4.0, 4.0),
        (4.0, -4.0),
        (-4.0, -4.0),
        (-4.0, 0.0),
    ];
    let lap: Vec<_> = corners.iter().map(|&(x, y)| Point2::new(x, y)).collect();
    let waypoints: Vec<_> = (0..).zip(&lap).map(|(i, &point)| route(i, point)).collect();
    let limits = Limits::new(PATROL.v_max, 0.0, PATROL.omega_max).unwrap();
    let params = DriverParams::default();
    let mut run = run(vec![], params);
    let start = run.pose;
    through(&mut run, &waypoints, false);
    let driven = run.reports.last().unwrap().ended_s;
    let told = lap_time(&start, &lap, &limits, &params.go_to, DT).unwrap();
    assert!((told - driven).abs() < 1e-9, "{told} {driven}");
    // 32 m and five quarter turns (the robot begins to drive before their end).
    let mut pose = start;
    let mut bound = 0.0;
    for &point in &lap {
        bound += time_without_obstacles(&pose, point, &limits, &params.go_to);
        let leg = point - pose.position();
        pose = Pose2::new(point.x, point.y, geometry::math::atan2(leg.y, leg.x));
    }
    assert!(told > 31.0 && told < bound + 0.5, "{told} {bound}");
}

#[test]
fn laps_that_cannot_be_simulated_are_refused() {
    let limits = Limits::new(1.0, 0.0, 3.0).unwrap();
    let go_to = GoToParams::default();
    let field = |points: &[Point2<f64>], dt| {
        lap_time(&Pose2::default(), points, &limits, &go_to, dt)
            .unwrap_err()
            .field
    };
    assert_eq!(field(&[Point2::new(f64::NAN, 0.0)], DT), "points");
    assert_eq!(field(&[Point2::new(1.0, 0.0)], 0.0), "dt");
    assert_eq!(field(&[Point2::new(1e9, 0.0)], 1e-3), "dt");
    assert_eq!(
        lap_time(&Pose2::default(), &[], &limits, &go_to, DT),
        Ok(0.0)
    );
}
