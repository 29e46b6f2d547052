//! Random problems: every plan passes the check, and "no path" occurs only where there is none.

use geometry::pose::Pose2;
use geometry::shape::Convex;
use nalgebra::Point2;
use proptest::prelude::*;
use trajectory::{Method, PlanError, Problem, RobotLimits, Wheels};

use crate::problems::{board, disc, faults, options, plan};

fn obstacle() -> impl Strategy<Value = Convex> {
    let place = (0.0..4.8, 0.0..3.6);
    prop_oneof![
        (place.clone(), 0.0..0.4).prop_map(|((x, y), r)| disc(x, y, r)),
        (place, 0.02..0.4, 0.02..0.4, -3.0..3.0).prop_map(|((x, y), a, b, angle)| {
            Convex::rectangle(Point2::new(x, y), [a, b], angle)
        }),
    ]
}

fn limits() -> impl Strategy<Value = RobotLimits> {
    let maybe = |range: core::ops::Range<f64>| proptest::option::of(range);
    (
        (0.05..1.0, prop_oneof![Just(0.0), 0.0..1.0]),
        0.5..16.0,
        maybe(0.1..0.4),
        maybe(0.1..2.0),
        maybe(0.5..8.0),
    )
        .prop_map(
            |((v_max, backwards), omega_max, wheels, acceleration, angular)| RobotLimits {
                v_max,
                v_min: 0.0 - v_max * backwards,
                omega_max,
                wheels: wheels.map(|separation| Wheels {
                    speed: v_max,
                    separation,
                }),
                acceleration,
                angular_acceleration: angular,
            },
        )
}

fn problem() -> impl Strategy<Value = Problem> {
    (
        (0.0..4.8, 0.0..3.6, -3.2..3.2),
        (0.0..4.8, 0.0..3.6),
        proptest::collection::vec(obstacle(), 0..12),
        limits(),
        (
            proptest::option::of(-3.2..3.2),
            proptest::option::of(-1.0..1.0),
            proptest::option::of(Just(0.0)),
            0.01..0.2,
        ),
    )
        .prop_map(
            |(start, goal, obstacles, limits, (heading, speed, end, clearance))| Problem {
                start: Pose2::new(start.0, start.1, start.2),
                start_speed: speed.map(|part: f64| {
                    part * if part < 0.0 {
                        -limits.v_min
                    } else {
                        limits.v_max
                    }
                }),
                goal: Point2::new(goal.0, goal.1),
                goal_heading: heading,
                goal_speed: end,
                limits,
                obstacles,
                clearance,
                ..board()
            },
        )
}

fn check(problem: &Problem, method: Method) -> Result<(), TestCaseError> {
    match plan(problem, &options(method)) {
        Ok(plan) => {
            // A start that was pushed out of an obstacle is inside it.
            let grown = Problem {
                clearance: (problem.clearance - 0.006).max(0.0),
                ..problem.clone()
            };
            let faults = faults(&grown, &plan);
            prop_assert!(faults.is_empty(), "{method:?} {faults:?}");
            prop_assert!(plan.min_clearance > -1e-3);
        }
        Err(PlanError::NoPath) => {
            let free = Problem {
                obstacles: Vec::new(),
                ..problem.clone()
            };
            prop_assert!(!matches!(
                plan(&free, &options(Method::Tangent)),
                Err(PlanError::NoPath)
            ));
        }
        Err(PlanError::Invalid(e)) => {
            prop_assert!(e.field == "start" || e.field == "goal", "{e}");
        }
        // Too fast to stop, or to arrive as prescribed.
        Err(PlanError::Infeasible(_)) => prop_assert!(!problem.limits.is_without_inertia()),
        Err(e) => prop_assert!(false, "{e}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn plans_are_valid(problem in problem(), method in proptest::sample::select(&Method::ALL[..])) {
        check(&problem, method)?;
    }

    #[test]
    fn plans_of_the_papers_robot_are_valid(problem in problem()) {
        let problem = Problem { limits: RobotLimits::simple(0.15, 16.0), start_speed: None, ..problem };
        for method in Method::ALL {
            check(&problem, method)?;
        }
    }
}
