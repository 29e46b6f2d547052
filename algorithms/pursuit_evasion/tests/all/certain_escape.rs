//! Escapes that no pursuer can prevent, in the city.

use std::path::Path;
use std::sync::LazyLock;

use geometry::map::{MapSpec, UnknownCells, WorldMap};
use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use nalgebra::Point2;
use navigation::dominance::{Arena, Dominance, DominanceParams, Runner};
use navigation::tangent_graph::{TangentGraph, Towards};
use planner_view::free_space::FreeSpace;
use proptest::prelude::*;
use pursuit_evasion::escape::{Escape, Robot, plan};
use robot::drive::limit;
use robot::spec::{Preset, RobotModel};
use testing::{CITY, DT, EXIT, RADIUS, street_starts};

const CAPTURE: f64 = 0.3;

static ARENA: LazyLock<Arena> = LazyLock::new(|| {
    let exit = Region::Circle {
        center: [EXIT.x, EXIT.y],
        radius: 0.5,
    };
    Arena::new(
        &CITY.1,
        &DominanceParams::default(),
        RADIUS,
        &[exit],
        CAPTURE,
    )
});

/// Exact shortest paths in the city.
static PATHS: LazyLock<TangentGraph> = LazyLock::new(|| {
    let file = MapSpec::File {
        path: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/maps/city.toml"),
        unknown: UnknownCells::default(),
    };
    let map = WorldMap::new(&file.load(Path::new("")).unwrap()).unwrap();
    TangentGraph::new(&FreeSpace::from(map.shapes().clone()), RADIUS).unwrap()
});

fn model() -> RobotModel {
    RobotModel {
        v_max: 0.45,
        ..Preset::Turtlebot3Burger.model()
    }
}

fn escape(pose: Pose2, model: RobotModel, police: &[(f64, f64)]) -> Option<Escape> {
    let police: Vec<Runner> = police
        .iter()
        .map(|&(x, y)| Runner {
            at: Point2::new(x, y),
            speed: 0.3,
            reach: CAPTURE,
        })
        .collect();
    let runner = Runner {
        at: pose.position(),
        speed: model.v_max,
        reach: 0.0,
    };
    let robot = Robot {
        pose,
        twist: Twist2::STOP,
        model,
        dt: DT,
    };
    let mut dominance = Dominance::default();
    dominance.assess(&CITY.1, &ARENA, &police, &[runner]);
    plan(&CITY.1, &ARENA, &mut dominance, 0, &runner, &robot)
}

#[test]
fn without_pursuers_every_place_has_an_escape_along_its_shortest_path() {
    for start in street_starts() {
        let found = escape(start, model(), &[]).unwrap_or_else(|| panic!("none from {start:?}"));
        assert!(found.margin == f64::INFINITY && found.exit == 0);
        let points = found.course.points();
        let length: f64 = points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        // A turn on the spot, and slower around the corners.
        let drive = length / 0.45;
        assert!(
            (drive - 1.5..drive + 4.0).contains(&found.time),
            "{} {drive}",
            found.time
        );
    }
}

/// The farthest that a pursuer on the ring road may be for the escape to be impossible (m from the
/// street along which the evader would drive).
fn reach_of_pursuer(theta: f64, model: RobotModel) -> f64 {
    let possible = |y: f64| escape(Pose2::new(4.5, 1.5, theta), model, &[(7.5, y)]).is_some();
    (2..60)
        .map(|step| f64::from(step) * 0.1)
        .filter(|&y| !possible(1.5 + y))
        .fold(0.0, f64::max)
}

#[test]
fn an_evader_that_must_turn_first_needs_a_greater_lead() {
    let ahead = reach_of_pursuer(0.0, model());
    let away = reach_of_pursuer(3.1, model());
    let slow = RobotModel {
        omega_max: 0.5,
        ..model()
    };
    let slowly = reach_of_pursuer(3.1, slow);
    // Half a turn takes 1.1 s, in which the pursuer drives 0.33 m; at 0.5 rad/s, 6.3 s.
    assert!(
        ahead > 0.5 && away > ahead + 0.15 && slowly > away + 0.5,
        "{ahead} {away} {slowly}"
    );
}

#[test]
fn an_evader_that_accelerates_slowly_needs_a_greater_lead() {
    let heavy = RobotModel {
        acceleration: Some(0.05),
        ..model()
    };
    assert!(reach_of_pursuer(0.0, heavy) > reach_of_pursuer(0.0, model()) + 0.3);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// The follower keeps off the walls, arrives exactly when it was told, and is always where no
    /// pursuer could be by the exact shortest path.
    #[test]
    fn the_drive_arrives_when_it_was_told_and_before_any_pursuer(
        start in 0_usize..30,
        theta in -3.1_f64..3.1,
        police in prop::collection::vec((-7.9_f64..7.9, -7.9_f64..7.9), 0..4),
        speed in 0.2_f64..0.8,
    ) {
        let model = RobotModel { v_max: speed, ..model() };
        let at = street_starts()[start];
        let pose = Pose2::new(at.x, at.y, theta);
        let Some(mut found) = escape(pose, model, &police) else {
            return Ok(());
        };
        let mut robot = Robot { pose, twist: Twist2::STOP, model, dt: DT };
        let limits = robot.limits().unwrap();
        let chase: Vec<Towards> = police
            .iter()
            .map(|&(x, y)| PATHS.towards(Point2::new(x, y)))
            .collect();
        let mut ticks = 0;
        while (robot.pose.position() - EXIT).norm() >= 0.5 {
            let tracking = found.course.follow(&CITY.1, &robot.pose, &limits).unwrap();
            prop_assert_eq!(limit(&model, robot.twist, tracking.command, DT), tracking.command);
            robot = robot.after(tracking.command);
            prop_assert!(CITY.0.clearance(robot.pose.position()) > RADIUS);
            ticks += 1;
            let time = f64::from(ticks) * DT;
            prop_assert!(time <= found.time + 1e-9);
            // A pursuer in a wall has no path.
            let nearest = chase
                .iter()
                .filter_map(|towards| towards.distance(robot.pose.position()))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(nearest - CAPTURE > 0.3 * time, "{} m at {} s", nearest, time);
        }
        prop_assert!((f64::from(ticks) * DT - found.time).abs() < 1e-9);
    }

    #[test]
    fn any_input_gives_no_panic(numbers in prop::collection::vec(prop::num::f64::ANY, 10)) {
        let model = RobotModel {
            v_max: numbers[3],
            omega_max: numbers[4],
            radius: numbers[5],
            ..model()
        };
        escape(Pose2::new(numbers[0], numbers[1], numbers[2]), model, &[(numbers[6], numbers[7])]);
        let sane = Pose2::new(1.5, 1.5, 0.0);
        escape(sane, RobotModel { acceleration: Some(numbers[8]), ..super::certain_escape::model() }, &[]);
    }
}
