//! Problems in which the first search from a start fails; the best known times are those of another solver
//! from eight starts.

use core::f64::consts::PI;

use geometry::pose::Pose2;
use nalgebra::Point2;
use trajectory::{Basis, Options, Problem, RobotLimits, Status};

use crate::problems::{board, disc, faults, motors, plan};

/// A robot at nearly full speed, with a disc 6 cm ahead of it.
fn moving() -> Problem {
    let speed = 0.206_459;
    Problem {
        start: Pose2::new(0.9, 1.8, 0.0),
        start_speed: Some(speed),
        start_turn_rate: Some(0.0),
        goal: Point2::new(4.2, 2.865_078),
        goal_speed: Some(0.0),
        limits: RobotLimits {
            v_min: 0.0,
            ..motors()
        },
        obstacles: vec![disc(1.437_155, 1.8, 0.368_217)],
        clearance: 0.105,
        ..board()
    }
}

/// A robot that turns slowly, on whose path an obstacle grows.
fn slow() -> Problem {
    let px = 0.0075;
    let discs = [
        [70.272, 128.709, 20.683],
        [188.906, 300.245, 23.628],
        [78.799, 0.604, 26.677],
        [554.181, 105.488, 24.987],
        [273.749, 24.49, 29.312],
    ];
    Problem {
        start: Pose2::new(31.714 * px, 53.011 * px, -1.503_817),
        goal: Point2::new(465.598 * px, 147.831 * px),
        goal_heading: Some(2.261_863),
        limits: RobotLimits::simple(0.15, 0.4145).forwards(),
        obstacles: discs.map(|[x, y, r]| disc(x * px, y * px, r * px)).to_vec(),
        ..board()
    }
}

#[test]
fn a_search_that_fails_is_repeated() {
    for (problem, best) in [(moving(), 17.84), (slow(), 26.82)] {
        let plan = plan(&problem, &Options::default()).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0]);
        assert_eq!(plan.status, Status::Planned);
        assert!(matches!(plan.basis, Basis::Optimal { residual } if residual <= 1e-6));
        let most = best * 1.003;
        assert!(plan.final_time < most, "{} {most}", plan.final_time);
    }
}

#[test]
fn a_plan_tells_its_quality() {
    // Straight ahead, as fast as the bound; a curve near the bound; a local optimum.
    let straight = Problem {
        goal: board().start.position() + board().start.forward() * 2.0,
        ..board()
    };
    let curve = Problem {
        goal_heading: Some(0.7 + PI / 8.0),
        obstacles: vec![disc(2.4, 1.8, 0.3)],
        ..board()
    };
    let names = [straight, curve, moving()].map(|problem| {
        let plan = plan(&problem, &Options::default()).unwrap();
        assert_eq!(plan.status, Status::Planned);
        plan.basis.name()
    });
    assert_eq!(names, ["exact", "curve", "optimal"]);
}
