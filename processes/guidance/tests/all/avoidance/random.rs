//! Random worlds: what an exact planner reaches, the robot reaches; the rest it reports.

use super::{DriverParams, PATROL, Run, square};
use guidance::tangent_graph::TangentGraph;
use guidance::waypoint::WaypointOutcome::{Reached, Unreachable};
use nalgebra::Point2;
use proptest::prelude::*;
use sim_backend::pose::Pose2;
use sim_backend::shape::Convex;

/// Half the width of the worlds [m].
const HALF: f64 = 3.0;

fn any_obstacle() -> impl Strategy<Value = Convex> {
    let center = || (-HALF..HALF, -HALF..HALF).prop_map(|(x, y)| Point2::new(x, y));
    prop_oneof![
        (center(), 0.05..0.7f64).prop_map(|(center, radius)| Convex::disc(center, radius)),
        (center(), 0.05..1.2f64, 0.05..0.5f64, -1.6..1.6f64)
            .prop_map(|(center, a, b, angle)| Convex::rectangle(center, [a, b], angle)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn the_robot_reaches_what_can_be_reached_and_reports_the_rest(
        parts in proptest::collection::vec(any_obstacle(), 2..14),
        from in (-2.7..2.7f64, -2.7..2.7f64, -3.1..3.1f64),
        to in (-2.7..2.7f64, -2.7..2.7f64),
    ) {
        let space = square(HALF, parts);
        let (start, goal) = (Point2::new(from.0, from.1), Point2::new(to.0, to.1));
        let params = DriverParams::default();
        let (radius, grown) = (PATROL.radius, PATROL.radius + params.tangent_bug.margin);
        // What lies between surely passable and surely closed is not judged.
        prop_assume!(space.is_free(start, grown + 0.02));
        let reachable = |radius: f64| {
            let graph = TangentGraph::new(&space, radius).unwrap();
            graph.distance(start, goal).is_some()
        };
        let surely = reachable(grown + 0.04);
        // Whoever comes within the tolerance of the goal could go on there with a smaller robot.
        let surely_not = !reachable(radius - params.go_to.arrived - 0.01);
        let mut run = Run::new(PATROL, space.clone(), Pose2::new(from.0, from.1, from.2), params);
        let outcome = run.go(goal, 900.0);
        prop_assert!(run.least_clearance > 0.0, "contact: {}", run.least_clearance);
        prop_assert!(outcome.is_some(), "no end at {:?}", run.pose);
        if surely {
            prop_assert_eq!(outcome, Some(Reached), "gave up at {:?}", run.pose);
        }
        if surely_not {
            prop_assert_eq!(outcome, Some(Unreachable));
        }
    }
}
