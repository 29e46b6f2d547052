//! Cases 1 and 2 of the paper, driven and not only planned.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use geometry::pose::Pose2;
use geometry::shape::Shape;
use patrol::forecast::Forecast;
use patrol_planners::{PatrolAwg, PatrolAwgParams};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::{WaypointKind, WaypointOutcome, WaypointReport};
use support::{Drive, Steers, drive, model};
use testing::{circle, rectangle};

struct Awg(PatrolAwg);

impl Steers for Awg {
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.steer(map, view)
    }

    fn reports(&self) -> &[WaypointReport] {
        self.0.reports()
    }
}

const OCTAGON: &str = "mission = { t_max = 120, contour = [[5, 0], [0, 5], [0, 10], [5, 15], \
                       [10, 15], [15, 10], [15, 5], [10, 0]] }\n";
const SQUARE: &str = "mission = { t_max = 100, contour = [[1, 1], [1, 11], [11, 11], [11, 1]] }\n";

fn patrol(text: &str, more: &str, start: Pose2) -> Awg {
    let params: PatrolAwgParams = toml::from_str(&(text.to_owned() + more)).unwrap();
    Awg(PatrolAwg::new(&params, &model(start), 42).unwrap())
}

/// Returns the time at which each lap ended (s).
fn lap_ends(drive: &Drive, per_lap: u64) -> Vec<f64> {
    let ends = drive.reports.iter().filter(|r| {
        let number = r.waypoint.number;
        number > 0 && number.is_multiple_of(per_lap)
    });
    ends.map(|r| r.ended_s).collect()
}

#[test]
fn the_octagon_is_driven_in_time_through_every_waypoint_without_contact() {
    let start = Pose2::new(5.0, 0.0, 2.3);
    let mut planner = patrol(OCTAGON, "[driver]\ngo_to = { arrived = 0.1 }", start);
    let mission = planner.0.mission().clone();
    let found = drive(vec![], start, 6.0 * 120.0, &mut planner);
    assert_eq!(found.contacts(), 0);
    let ends = lap_ends(&found, mission.awg.waypoints_per_lap());
    assert!(ends.len() >= 6, "{ends:?}");
    let mut before = 0.0;
    for end in ends {
        assert!(end - before <= 120.0, "{} s", end - before);
        before = end;
    }
    // Distance from the contour by the corridor's width.
    let alpha = mission.awg.params().alpha;
    println!("alpha {alpha:.3} m");
    let off = found.poses.iter().map(|pose| {
        let segments = mission.contour.segments().iter();
        segments
            .map(|s| s.along.perp(&(pose.position() - s.from)).abs())
            .fold(f64::INFINITY, f64::min)
    });
    assert!(off.fold(0.0, f64::max) > 0.25 * alpha);
    // Every waypoint, in order, within the tolerance, where an ally with the key expects it.
    let forecast = Forecast::new(mission.awg, mission.key.source().unwrap());
    for (number, report) in (0..).zip(&found.reports) {
        assert_eq!(report.outcome, WaypointOutcome::Reached, "{report:?}");
        assert!(report.closest <= 0.1);
        assert_eq!(report.waypoint, forecast.waypoint(number).unwrap());
    }
}

/// A post and a crate on the contour of case 2, and a wall beside it.
fn obstacles() -> Vec<Shape> {
    vec![
        circle([1.0, 4.0], 0.25),
        rectangle([6.0, 11.2], [0.8, 0.4]),
        rectangle([10.2, 6.0], [0.3, 1.5]),
    ]
}

#[test]
fn known_obstacles_are_gone_around_and_waypoints_inside_them_left_out_at_once() {
    let start = Pose2::new(1.0, 1.0, 1.57);
    let mut planner = patrol(SQUARE, "obstacles_known = true", start);
    let found = drive(obstacles(), start, 220.0, &mut planner);
    assert_eq!(found.contacts(), 0);
    let count = |outcome| {
        found
            .reports
            .iter()
            .filter(|r| r.outcome == outcome)
            .count()
    };
    assert!(count(WaypointOutcome::InsideObstacle) > 3);
    assert!(count(WaypointOutcome::Reached) > 100);
    // No part of the route is left out.
    let route = found
        .reports
        .iter()
        .filter(|r| r.waypoint.kind == WaypointKind::Route);
    assert!(route.clone().count() >= 8);
    assert!(route.clone().all(|r| r.outcome == WaypointOutcome::Reached));
}

#[test]
fn waypoints_inside_unknown_obstacles_are_given_up_after_twice_their_time() {
    let start = Pose2::new(1.0, 1.0, 1.57);
    let mut planner = patrol(SQUARE, "", start);
    let found = drive(obstacles(), start, 240.0, &mut planner);
    assert_eq!(found.contacts(), 0);
    let given_up = found.reports.iter().filter(|r| {
        matches!(
            r.outcome,
            WaypointOutcome::TimedOut | WaypointOutcome::Unreachable | WaypointOutcome::Stuck
        )
    });
    assert!(given_up.clone().count() > 2);
    assert!(
        given_up
            .clone()
            .all(|r| r.waypoint.kind == WaypointKind::Inserted)
    );
    assert!(
        found
            .reports
            .iter()
            .all(|r| r.outcome != WaypointOutcome::InsideObstacle)
    );
}

#[test]
fn the_waypoints_ahead_are_shown_and_a_robot_without_a_pose_stands() {
    let start = Pose2::new(5.0, 0.0, 0.0);
    let mut planner = patrol(OCTAGON, "", start);
    let shown = |planner: &Awg| planner.0.ahead().map(|w| w.number).collect::<Vec<u64>>();
    assert_eq!(shown(&planner), (0..12).collect::<Vec<u64>>());
    let found = drive(vec![], start, 10.0, &mut planner);
    let next = found.reports.len() as u64;
    assert_eq!(shown(&planner), (next..next + 12).collect::<Vec<u64>>());
    // No robot is listed with the planner's index.
    let view = View {
        time_s: 10.0,
        dt: 0.05,
        me: 3,
        robots: &[],
        beliefs: &[],
        exits: &[],
        scan: None,
    };
    let steering = planner.steer(&support::planner_map(&found.world), &view);
    assert_eq!(steering, Steering::stop());
    assert!(planner.reports().is_empty());
}

#[test]
fn an_impossible_patrol_names_the_field() {
    let made = |text: &str| {
        let params: PatrolAwgParams = toml::from_str(text).unwrap();
        let start = Pose2::new(0.0, 0.0, 0.0);
        PatrolAwg::new(&params, &model(start), 1)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        made(""),
        "`mission.contour` is a list of 0: expected at least 2 values"
    );
    let slow = "mission = { contour = [[0, 0], [100, 0]], t_max = 60 }";
    assert!(made(slow).contains("at least 200.000 s"));
    let driver = "mission = { contour = [[0, 0], [9, 0]] }\n[driver]\nstuck_s = -1";
    assert!(made(driver).starts_with("`driver.stuck_s` is -1"));
}

/// Returns the distances of the robot from its forecast, tick by tick (m).
fn errors(drive: &Drive, planner: &Awg) -> Vec<f64> {
    let mission = planner.0.mission();
    let forecast = Forecast::new(mission.awg.clone(), mission.key.source().unwrap());
    let set_out_s = planner.0.set_out_s().unwrap();
    let ticks = drive.poses.iter().enumerate();
    ticks
        .map(|(tick, pose)| (tick as f64 * 0.05 - set_out_s, pose))
        .filter(|(t, _)| *t >= 0.0)
        .map(|(t, pose)| (forecast.at_time(t).unwrap().point - pose.position()).norm())
        .collect()
}

fn mean_and_max(errors: &[f64]) -> (f64, f64) {
    let sum: f64 = errors.iter().sum();
    (
        sum / errors.len() as f64,
        errors.iter().copied().fold(0.0, f64::max),
    )
}

#[test]
fn with_a_clock_the_robot_is_where_its_forecast_predicts() {
    // Two metres beside the contour: the clock does not run before it is there.
    let start = Pose2::new(7.0, 0.0, core::f64::consts::PI);
    let mut planner = patrol(OCTAGON, "[driver]\ngo_to = { arrived = 0.1 }", start);
    let found = drive(vec![], start, 12.0 * 118.0 + 5.0, &mut planner);
    let set_out_s = planner.0.set_out_s().unwrap();
    assert!((1.8..2.2).contains(&set_out_s), "{set_out_s}");
    let (mean, max) = mean_and_max(&errors(&found, &planner));
    println!("mean {mean:.3} m, max {max:.3} m");
    assert!(mean < 0.2 && max < 1.8, "{mean} {max}");
    // It waits for nothing, but does not hurry either.
    let awg = &planner.0.mission().awg;
    let lateness = |r: &WaypointReport| r.ended_s - set_out_s - awg.due_s(r.waypoint.number);
    let late = found.reports.iter().map(lateness);
    assert!(late.clone().fold(f64::INFINITY, f64::min) > -2.5);
    assert!(late.fold(f64::NEG_INFINITY, f64::max) < 3.0);
    let ends = lap_ends(&found, awg.waypoints_per_lap());
    assert_eq!(ends.len(), 12);
    let mut before = set_out_s;
    for end in ends {
        assert!(end - before <= 120.0, "{} s", end - before);
        before = end;
    }
}

#[test]
fn at_the_fastest_pace_the_robot_is_ahead_of_its_forecast() {
    let start = Pose2::new(5.0, 0.0, 2.3);
    let mut planner = patrol(OCTAGON, "pace = \"fastest\"", start);
    let found = drive(vec![], start, 120.0, &mut planner);
    let (mean, _) = mean_and_max(&errors(&found, &planner));
    assert!(mean > 1.0, "{mean}");
    let per_lap = planner.0.mission().awg.waypoints_per_lap();
    assert!(lap_ends(&found, per_lap)[0] < 110.0);
}

#[test]
fn a_robot_that_obstacles_have_made_late_catches_up() {
    let start = Pose2::new(1.0, 1.0, 1.57);
    // Unknown obstacles cost more: the robot tries to reach waypoints inside for a while.
    for (known, most_mean, most_max) in [(true, 0.3, 2.0), (false, 3.0, 7.0)] {
        let mut planner = patrol(SQUARE, &format!("obstacles_known = {known}"), start);
        let found = drive(obstacles(), start, 310.0, &mut planner);
        assert_eq!(found.contacts(), 0);
        let (mean, max) = mean_and_max(&errors(&found, &planner));
        println!("known: {known}; mean {mean:.3} m, max {max:.3} m");
        assert!(mean < most_mean && max < most_max, "{mean} {max}");
        let awg = &planner.0.mission().awg;
        let ends = lap_ends(&found, awg.waypoints_per_lap());
        assert_eq!(ends.len(), 3);
        for (lap, end) in (1..).zip(ends) {
            let late = end - awg.lap_time() * f64::from(lap);
            assert!(late < 7.0, "{late}");
        }
    }
}
