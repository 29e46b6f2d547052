use std::sync::Arc;

use control::go_to::coast;
use coverage::goal::GoalSource as _;
use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::pose::Twist2;
use geometry::shape::{Aabb, Convex};
use planner_view::free_space::FreeSpace;
use planner_view::view::RobotView;
use planner_view::waypoint::WaypointOutcome;
use robot::spec::RobotModel;
use robot::team::Role;

use crate::follower::Follower;
use geometry::pose::Pose2;
use nalgebra::Point2;
use planner::Planner as _;
use planner_view::map::PlannerMap;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use runtime::config::RobotInfo;

use super::*;

const DT: f64 = 0.05;

fn map(parts: Vec<Convex>, revision: u64, exact: bool) -> PlannerMap {
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(4.0, 4.0),
    };
    let frame = GridFrame {
        width: 40,
        height: 40,
        resolution: 0.1,
        origin: bounds.min,
    };
    let blurred = BlurredMap::new(&Grid::filled(frame, true), 0.1).unwrap();
    let map = PlannerMap::new(blurred, Grid::filled(frame, 1.0), revision).unwrap();
    if exact {
        map.with_space(Arc::new(FreeSpace::new(parts, bounds, 0.1).unwrap()))
    } else {
        map
    }
}

fn robot() -> RobotInfo {
    RobotInfo {
        name: "mop".into(),
        team: "neutral".into(),
        role: Role::Neutral,
        opponents: Vec::new(),
        companions: Vec::new(),
        model: RobotModel::turtlebot3_burger(),
        beams: 0,
        start: Pose2::new(0.5, 0.5, 0.0),
        goal: None,
    }
}

fn planner(text: &str) -> ChebyshevPlanner {
    let params: ChebyshevParams = toml::from_str(text).unwrap();
    Follower::new(&params, &robot(), 7).unwrap()
}

/// Drives to the end; returns the results of the sub-goals.
fn run(planner: &mut ChebyshevPlanner, map: &PlannerMap, ticks: u32) -> Vec<WaypointReport> {
    planner.prepare(map, &robot());
    let mut pose = robot().start;
    let mut reports = Vec::new();
    for tick in 0..ticks {
        let me = RobotView {
            index: 0,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose,
            twist: Twist2::STOP,
            radius: 0.105,
            v_max: 0.22,
        };
        let view = View {
            time_s: f64::from(tick) * DT,
            dt: DT,
            me: 0,
            robots: &[me],
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        let steering = planner.steer(map, &view);
        reports.extend_from_slice(planner.waypoints());
        pose = coast(&pose, steering.command, DT);
        let clearance = map.space().unwrap().distance(pose.position());
        assert!(clearance > 0.105, "contact at {pose:?}");
        if steering.command == Twist2::STOP {
            break;
        }
    }
    reports
}

#[test]
fn a_loop_is_driven_by_either_interpolation() {
    let pillar = Convex::disc(Point2::new(2.0, 2.0), 0.5);
    for way in ["linear", "arc"] {
        let mut planner = planner(&format!(
            "loops = 1\niterations = {{ in_all = 30 }}\nfollow = {{ interpolation = \"{way}\" }}"
        ));
        let reports = run(&mut planner, &map(vec![pillar.clone()], 1, true), 100_000);
        assert!(planner.failure().is_none());
        assert!(reports.len() > 40, "{way}: {}", reports.len());
        for (number, report) in reports.iter().enumerate() {
            assert_eq!(report.waypoint.number, number as u64);
            assert_eq!(
                report.outcome,
                WaypointOutcome::Reached,
                "{way}: {report:?}"
            );
        }
    }
}

#[test]
fn a_new_map_goes_on_with_the_same_numbers() {
    let mut planner = planner("");
    let pillar = |x: f64| vec![Convex::disc(Point2::new(x, 2.0), 0.5)];
    planner.prepare(&map(pillar(2.0), 1, true), &robot());
    let goals = planner.goals().unwrap();
    for number in 0..5 {
        let goal = goals.next_goal(Point2::origin()).unwrap();
        assert_eq!(goal.waypoint.number, number);
    }
    planner.prepare(&map(pillar(3.0), 2, true), &robot());
    let goals = planner.goals().unwrap();
    assert_eq!(
        goals.next_goal(Point2::origin()).unwrap().waypoint.number,
        5
    );
}

#[test]
fn maps_that_cannot_be_covered_end_the_process_with_a_remedy() {
    let failure = |text: &str, map: &PlannerMap| {
        let mut planner = planner(text);
        planner.prepare(map, &robot());
        planner.failure().unwrap().to_string()
    };
    let block = Convex::rectangle(Point2::new(2.0, 2.0), [1.95, 1.95], 0.0);
    let text = failure("", &map(vec![block], 1, true));
    assert!(
        text.contains("leave no free space; keep less margin"),
        "{text}"
    );
    let text = failure("", &map(vec![], 1, false));
    assert!(text.contains("more pieces than"), "{text}");
    let text = failure("route = { cycle = [0, 3] }", &map(vec![], 1, true));
    assert!(text.contains("rectangle 3"), "{text}");
    let text = failure("follow = { margin = 2.0 }", &map(vec![], 1, true));
    assert!(text.contains("`follow.margin` is 2 m"), "{text}");
}

#[test]
fn parameters_out_of_range_are_refused_before_the_start() {
    let params: ChebyshevParams = toml::from_str("follow = { tolerance = -1 }").unwrap();
    let error = ChebyshevPlanner::new(&params, &robot(), 7).err().unwrap();
    assert!(
        error.to_string().starts_with("`follow.tolerance` is -1"),
        "{error}"
    );
}
