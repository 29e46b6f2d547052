//! Case 2 of the paper with fictive obstacles, and the mixture, driven.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use geometry::pose::Pose2;
use parameters::check;
use patrol::mission::Drive;
use patrol_planners::{PatrolFto, PatrolFtoParams};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::{WaypointKind, WaypointOutcome, WaypointReport};
use support::{Steers, drive, model};
use testing::rectangle;

/// Planner, with the numbers of ticks in which it saw a fictive obstacle, on the first leg and in
/// total.
struct Watched {
    planner: PatrolFto,
    seen: u32,
    seen_on_the_first_leg: u32,
}

impl Steers for Watched {
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let leg = self
            .planner
            .current()
            .and_then(|waypoint| self.planner.awg().place(waypoint.number))
            .map(|(_, leg, _)| leg);
        let steering = self.planner.steer(map, view);
        if self.planner.disc().is_some() {
            self.seen += 1;
            self.seen_on_the_first_leg += u32::from(leg == Some(0));
        }
        steering
    }

    fn reports(&self) -> &[WaypointReport] {
        self.planner.reports()
    }
}

const SQUARE: &str = "mission = { t_max = 100, contour = [[1, 1], [1, 11], [11, 11], [11, 1]] }\n";

fn start() -> Pose2 {
    Pose2::new(1.0, 1.0, 1.57)
}

fn patrol(more: &str) -> Watched {
    let params: PatrolFtoParams = toml::from_str(&(more.to_owned() + SQUARE)).unwrap();
    let model = model(start());
    let drive = Drive::from_model(&model).unwrap();
    Watched {
        planner: PatrolFto::new(&params, &drive, &model, 42).unwrap(),
        seen: 0,
        seen_on_the_first_leg: 0,
    }
}

#[test]
fn fictive_obstacles_push_the_robot_off_its_contour_and_the_route_is_kept() {
    let mut with = patrol("");
    let found = drive(vec![], start(), 300.0, &mut with);
    assert!(with.seen > 100, "{}", with.seen);
    assert_eq!(found.contacts(), 0);
    let off = |pose: &Pose2| {
        let (x, y) = (pose.x, pose.y);
        [x - 1.0, x - 11.0, y - 1.0, y - 11.0]
            .into_iter()
            .map(f64::abs)
            .fold(f64::INFINITY, f64::min)
    };
    let farthest = found.poses.iter().map(off).fold(0.0, f64::max);
    println!("{} ticks with an obstacle, {farthest:.3} m off", with.seen);
    assert!(farthest > 0.15, "{farthest}");
    // Six laps of 40 m at 1 m/s, with their detours: all corners, and nothing but corners.
    assert!(found.reports.len() >= 24, "{}", found.reports.len());
    for report in &found.reports {
        assert_eq!(report.waypoint.kind, WaypointKind::Route);
        assert_eq!(report.outcome, WaypointOutcome::Reached);
    }
}

#[test]
fn a_fictive_obstacle_beside_a_real_one_never_leads_to_a_contact() {
    // A corridor of 1.6 m along the left side, walls within the sensor's reach.
    let walls = vec![
        rectangle([0.1, 6.0], [0.1, 4.0]),
        rectangle([1.9, 6.0], [0.1, 4.0]),
    ];
    for key in ["1a", "2b", "3c"].map(|byte| byte.repeat(32)) {
        let mut planner = patrol(&format!("fto = {{ key = \"keyed:{key}\" }}\n"));
        let found = drive(walls.clone(), start(), 400.0, &mut planner);
        assert_eq!(found.contacts(), 0, "{key}");
        assert!(
            planner.seen_on_the_first_leg > 5,
            "{}",
            planner.seen_on_the_first_leg
        );
        assert!(found.reports.len() >= 8, "{}", found.reports.len());
    }
}

#[test]
fn the_mixture_has_fictive_obstacles_along_the_large_obstacle_only() {
    // It covers most of the zig-zag along the left side, but not the contour itself.
    let large = vec![
        rectangle([3.0, 6.0], [1.8, 3.5]),
        rectangle([-1.0, 6.0], [1.7, 3.5]),
    ];
    let mut planner =
        patrol("protection = 'mixed'\nobstacles_known = true\nmixed = { dropped_share = 0.25 }\n");
    let found = drive(large, start(), 320.0, &mut planner);
    assert_eq!(found.contacts(), 0);
    assert!(planner.seen > 20, "{}", planner.seen);
    assert_eq!(planner.seen, planner.seen_on_the_first_leg);
    // No additional waypoints on the left side, and all of them on the others.
    let per_lap = planner.planner.awg().waypoints_per_lap();
    let mut inserted = [0; 4];
    for report in found
        .reports
        .iter()
        .filter(|r| r.waypoint.number <= 2 * per_lap)
    {
        if report.waypoint.kind == WaypointKind::Inserted {
            let (_, leg, _) = planner.planner.awg().place(report.waypoint.number).unwrap();
            inserted[leg] += 1;
        }
    }
    assert_eq!(inserted, [0, 48, 48, 48]);
}

#[test]
fn parameters_that_cannot_be_are_named() {
    let refused = |more: &str| {
        let params: PatrolFtoParams = toml::from_str(&(more.to_owned() + SQUARE)).unwrap();
        check(&params).unwrap_err().to_string()
    };
    assert!(refused("fto = { radius = 0.0 }\n").starts_with("`fto.radius` is 0"));
    assert!(refused("mixed = { retry_laps = 0 }\n").starts_with("`mixed.retry_laps` is 0"));
    assert!(refused("driver = { stuck_s = 0.0 }\n").starts_with("`driver.stuck_s` is 0"));
    assert!(toml::from_str::<PatrolFtoParams>("protection = 'none'").is_err());
}
