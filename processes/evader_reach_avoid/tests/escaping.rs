//! The evader in the city and in a room with a wall.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use evader_reach_avoid::{Evader, ReachAvoidParams};
use geometry::region::Region;
use nalgebra::Point2;
use planner_view::map::PlannerMap;
use robot::spec::{Preset, RobotModel};
use robot::team::Role;
use testing::{Arena, CITY, DT, EXIT, Kinematic, robot, street_starts, view};

const V_MAX: f64 = 0.45;

fn evader(exit: Region) -> Evader {
    let model = RobotModel {
        v_max: V_MAX,
        ..Preset::Turtlebot3Burger.model()
    };
    let mut evader = Evader::new(ReachAvoidParams::default(), model).unwrap();
    evader.rules(&[exit], 0.3);
    evader
}

fn circle(at: Point2<f64>, radius: f64) -> Region {
    Region::Circle {
        center: [at.x, at.y],
        radius,
    }
}

/// Time at which the axle is in the exit (s), if it gets there within 90 s.
fn drive(arena: &Arena, map: &PlannerMap, body: &mut Kinematic, exit: Region) -> Option<f64> {
    let mut evader = evader(exit);
    (0..1800).map(|tick| f64::from(tick) * DT).find(|&time| {
        let robots = [robot(0, Role::Evader, body.pose, V_MAX)];
        let steering = evader.command(map, &view(time, &robots, &[exit.center()]));
        body.step(arena, steering.command, DT);
        exit.contains(body.pose.position())
    })
}

#[test]
fn it_does_not_park_with_its_axle_before_the_exit() {
    let (arena, map) = &*CITY;
    for radius in [0.5, 0.1] {
        for start in street_starts() {
            let mut body = Kinematic::new(start.x, start.y, start.theta);
            let time = drive(arena, map, &mut body, circle(EXIT, radius));
            assert!(time.is_some(), "from {start:?} to {:?}", body.pose);
            assert_eq!(body.contacts, 0, "from {start:?}");
        }
    }
}

/// The room of the scenario `hello`: no node between the corner of the wall and the robot has an
/// earlier neighbour than the corner.
#[test]
fn it_does_not_aim_through_a_wall() {
    let arena = Arena {
        rectangles: vec![
            (1.9, 2.1, 0.0, 2.0),
            (-9.5, 0.0, -9.5, 9.5),
            (4.0, 9.5, -9.5, 9.5),
            (0.0, 4.0, -9.5, 0.0),
            (0.0, 4.0, 3.0, 9.5),
        ],
        chamfered: false,
    };
    let map = arena.map();
    for (x, y) in [(0.5, 0.5), (1.6, 0.4), (1.0, 2.5), (1.7, 1.9)] {
        let mut body = Kinematic::new(x, y, 0.0);
        let exit = circle(Point2::new(3.5, 0.5), 0.2);
        let time = drive(&arena, &map, &mut body, exit);
        assert!(
            time.is_some_and(|time| time < 16.0),
            "{x} {y}: {time:?}, {:?}",
            body.pose
        );
        assert_eq!(body.contacts, 0);
    }
}

/// An escape once found is kept: its course does not change while pursuers come nearer.
#[test]
fn it_keeps_its_course_once_its_escape_is_certain() {
    let map = &CITY.1;
    let mut evader = evader(circle(EXIT, 0.5));
    let mut body = Kinematic::new(4.5, 0.0, 1.6);
    let mut aims = Vec::new();
    for tick in 0..60 {
        let time = f64::from(tick) * DT;
        let pursuer = geometry::pose::Pose2::new(7.5, 7.0 - 0.3 * time, -1.57);
        let robots = [
            robot(0, Role::Evader, body.pose, V_MAX),
            robot(1, Role::Pursuer, pursuer, 0.3),
        ];
        let steering = evader.command(map, &view(time, &robots, &[EXIT]));
        body.step(&CITY.0, steering.command, DT);
        aims.push(steering.aim.unwrap());
    }
    assert!(aims.iter().all(|aim| *aim == aims[0]), "{aims:?}");
    assert!((aims[0] - EXIT).norm() < 0.5);
}
