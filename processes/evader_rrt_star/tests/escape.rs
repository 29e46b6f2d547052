//! The evader in the paper's city, in a kinematic mini-simulation.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::sync::{Arc, LazyLock};

use evader_rrt_star::RrtStarEvader;
use evader_rrt_star::params::{Follower, Primitive, ReplanRule, RrtStarParams};
use geometry::pose::{Pose2, Twist2};
use geometry::shape::Convex;
use nalgebra::Point2;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::view::RobotView;
use robot::team::Role;
use support::{EXIT, POLICE, START};
use testing::{Arena, DT, Kinematic, street_starts, view};

const V_MAX: f64 = 0.6;

static CITY: LazyLock<(Arena, PlannerMap)> = LazyLock::new(|| {
    let arena = Arena::city();
    let map = arena.map().with_space(Arc::new(support::city()));
    (arena, map)
});

/// Returns a robot at full speed, as planners see it.
fn robot(index: usize, role: Role, pose: Pose2, v_max: f64) -> RobotView {
    RobotView {
        twist: Twist2::new(v_max, 0.0),
        ..testing::robot(index, role, pose, v_max)
    }
}

fn evader(params: &RrtStarParams) -> RrtStarEvader {
    let limits = Limits::new(V_MAX, V_MAX, 2.84).unwrap();
    RrtStarEvader::new(*params, limits, 7).unwrap()
}

/// Runs for up to `seconds`; returns the time at which the exit was reached, if it was.
fn run(
    params: &RrtStarParams,
    body: &mut Kinematic,
    police: &[Pose2],
    seconds: f64,
) -> Option<f64> {
    let (arena, map) = &*CITY;
    let mut evader = evader(params);
    let mut time = 0.0;
    while time < seconds {
        let mut robots = vec![robot(0, Role::Evader, body.pose, V_MAX)];
        let police = police.iter().enumerate();
        robots.extend(police.map(|(i, &pose)| robot(i + 1, Role::Pursuer, pose, 0.3)));
        let steering = evader.command(map, &view(time, &robots, &[EXIT]));
        body.step(arena, steering.command, DT);
        time += DT;
        if (body.pose.position() - EXIT).norm() < 0.5 {
            return Some(time);
        }
    }
    None
}

#[test]
fn unopposed_it_reaches_the_exit_without_touching_a_wall() {
    for start in street_starts().iter().step_by(4) {
        let mut body = Kinematic::new(start.x, start.y, start.theta);
        let time = run(&RrtStarParams::default(), &mut body, &[], 90.0);
        assert!(time.is_some(), "from {start:?} to {:?}", body.pose);
        assert_eq!(body.contacts, 0, "from {start:?}");
    }
}

#[test]
fn on_arcs_it_reaches_the_exit_too() {
    let params = RrtStarParams {
        primitive: Primitive::Arc,
        ..RrtStarParams::default()
    };
    let mut body = Kinematic::new(START.x, START.y, START.theta);
    let time = run(&params, &mut body, &[], 90.0);
    assert!(time.is_some(), "{:?}", body.pose);
    assert_eq!(body.contacts, 0);
}

#[test]
fn the_papers_follower_reaches_the_exit_as_well() {
    let params = RrtStarParams {
        follower: Follower::PotentialField,
        ..RrtStarParams::default()
    };
    let mut body = Kinematic::new(START.x, START.y, START.theta);
    let time = run(&params, &mut body, &[], 120.0);
    assert!(time.is_some(), "{:?}", body.pose);
}

#[test]
fn a_pursuer_in_a_street_turns_the_way_into_another() {
    let (_, map) = &*CITY;
    let lowest = |police: &[(f64, f64)]| {
        let mut evader = evader(&RrtStarParams {
            timing: evader_rrt_star::params::TimingParams {
                time_per_iteration_s: 0.0,
            },
            ..RrtStarParams::default()
        });
        let mut robots = vec![robot(0, Role::Evader, Pose2::new(0.0, 1.5, 0.0), V_MAX)];
        let police = police.iter().enumerate();
        robots.extend(
            police.map(|(i, &(x, y))| robot(i + 1, Role::Pursuer, Pose2::new(x, y, 0.0), 0.3)),
        );
        evader.command(map, &view(0.0, &robots, &[EXIT]));
        let route = evader.route().unwrap();
        assert!(route.is_complete);
        let points = route.path.points().iter();
        points.map(|p| p.y).fold(f64::INFINITY, f64::min)
    };
    // The path along y = 1.5, unless a robot stands in it.
    assert!(lowest(&[]) > -0.2);
    assert!(lowest(&[(4.5, 1.5)]) < -1.0);
}

#[test]
fn a_plan_holds_only_after_the_time_that_it_takes() {
    let (_, map) = &*CITY;
    let mut params = RrtStarParams::default();
    // A plan takes 0.3 s: in force after six ticks.
    params.timing.time_per_iteration_s = 0.3 / f64::from(params.search.iterations);
    let mut evader = evader(&params);
    let robots = [robot(0, Role::Evader, START, V_MAX)];
    for tick in 0..10 {
        let time = f64::from(tick) * DT;
        evader.command(map, &view(time, &robots, &[EXIT]));
        assert_eq!(evader.route().is_some(), tick >= 6, "tick {tick}");
        assert_eq!(evader.take_tree().is_some(), tick == 6, "tick {tick}");
    }
    params.timing.time_per_iteration_s = 0.0;
    let mut evader = self::evader(&params);
    evader.command(map, &view(0.0, &robots, &[EXIT]));
    assert!(evader.route().is_some());
}

/// The published program forgets a path when the next search finds none; the default keeps it.
#[test]
fn a_failed_plan_drops_the_path_by_the_papers_rule_only() {
    let wall = |x: f64, y: f64, half| Convex::rectangle(Point2::new(x, y), half, 0.0);
    let room = vec![
        wall(0.0, 1.0, [1.2, 0.1]),
        wall(0.0, -1.0, [1.2, 0.1]),
        wall(1.0, 0.0, [0.1, 1.2]),
        wall(-1.0, 0.0, [0.1, 1.2]),
    ];
    let map = CITY
        .1
        .clone()
        .with_space(Arc::new(support::space(room, 9.5)));
    let (outside, inside) = (Point2::new(1.8, 0.0), Point2::new(0.0, 0.0));
    let robots = [
        robot(0, Role::Evader, Pose2::new(1.8, -1.5, 0.0), V_MAX),
        // Near enough that the paper's rule plans again.
        robot(1, Role::Pursuer, Pose2::new(2.6, -0.5, 0.0), 0.3),
    ];
    for rule in [ReplanRule::Paper, ReplanRule::Periodic] {
        let mut params = RrtStarParams::default();
        params.replan.rule = rule;
        params.replan.period_s = 0.5;
        params.timing.time_per_iteration_s = 0.0;
        let mut evader = evader(&params);
        evader.command(&map, &view(0.0, &robots, &[outside]));
        assert!(
            evader.route().is_some_and(|route| route.is_complete),
            "{rule:?}"
        );
        let mut plans = 0;
        for tick in 1..60 {
            let time = f64::from(tick) * DT;
            evader.command(&map, &view(time, &robots, &[inside]));
            plans += u32::from(evader.take_tree().is_some());
        }
        assert!(plans > 1, "{rule:?}: no plan failed");
        let keeps = evader.route().is_some();
        assert_eq!(keeps, rule == ReplanRule::Periodic, "{rule:?}");
    }
}

#[test]
fn the_same_seed_makes_the_same_decisions() {
    let police: Vec<Pose2> = POLICE.iter().map(|&(x, y)| Pose2::new(x, y, 0.0)).collect();
    let run = || {
        let mut body = Kinematic::new(START.x, START.y, START.theta);
        run(&RrtStarParams::default(), &mut body, &police, 5.0);
        body.pose
    };
    assert_eq!(run(), run());
}

#[test]
fn without_an_exit_or_with_one_behind_walls_it_goes_on_within_its_limits() {
    let (_, map) = &*CITY;
    let limits = Limits::new(V_MAX, V_MAX, 2.84).unwrap();
    let robots = [
        robot(0, Role::Evader, START, V_MAX),
        robot(1, Role::Pursuer, Pose2::new(-3.0, 7.5, 0.0), 0.3),
    ];
    // None; in a block; not a number; beyond the edge of the world.
    let nowhere = Point2::new(f64::NAN, 0.0);
    for exits in [
        &[][..],
        &[Point2::new(0.0, 0.0)],
        &[nowhere],
        &[Point2::new(50.0, 0.0)],
    ] {
        let mut evader = evader(&RrtStarParams::default());
        for tick in 0..20 {
            let time = f64::from(tick) * DT;
            let steering = evader.command(map, &view(time, &robots, exits));
            assert!(limits.allow(steering.command), "{exits:?}: {steering:?}");
        }
        assert!(evader.route().is_none_or(|route| !route.is_complete));
    }
}

#[test]
fn a_start_that_touches_a_wall_is_led_away_from_it() {
    let (_, map) = &*CITY;
    // The wall of the ring road is at y = 8; the body reaches 5 mm into it.
    for y in [7.9, 7.895, 7.87] {
        let mut evader = evader(&RrtStarParams::default());
        let robots = [robot(0, Role::Evader, Pose2::new(-4.5, y, 0.0), V_MAX)];
        for tick in 0..3 {
            let time = f64::from(tick) * DT;
            evader.command(map, &view(time, &robots, &[EXIT]));
        }
        let route = evader.route().unwrap();
        assert!(route.is_complete, "y = {y}");
        assert!(route.path.points()[0].y <= 7.895 + 1e-9);
    }
}

#[test]
fn a_map_without_exact_shapes_leaves_the_potential_field() {
    let (arena, _) = &*CITY;
    let map = arena.map();
    let mut evader = evader(&RrtStarParams::default());
    let robots = [robot(0, Role::Evader, START, V_MAX)];
    let steering = evader.command(&map, &view(0.0, &robots, &[EXIT]));
    assert!(steering.command.v > 0.0);
    assert!(evader.route().is_none());
}

#[test]
fn an_inactive_robot_stands_still_and_has_no_plan() {
    let (_, map) = &*CITY;
    let mut evader = evader(&RrtStarParams::default());
    let mut robots = [robot(0, Role::Evader, START, V_MAX)];
    for tick in 0..3 {
        let time = f64::from(tick) * DT;
        evader.command(map, &view(time, &robots, &[EXIT]));
    }
    assert!(evader.route().is_some());
    robots[0].active = false;
    let steering = evader.command(map, &view(0.2, &robots, &[EXIT]));
    assert_eq!(steering.command, Twist2::STOP);
    assert!(evader.route().is_none());
}
