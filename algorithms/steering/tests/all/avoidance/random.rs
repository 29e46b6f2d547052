//! Random worlds: the robot reaches every goal that an exact planner reaches, and reports the others.

use super::{Machine, PATROL, Run, square};
use geometry::pose::Pose2;
use geometry::shape::Convex;
use nalgebra::Point2;
use navigation::tangent_graph::TangentGraph;
use planner_view::waypoint::WaypointOutcome::{Reached, Unreachable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Half the width of the worlds (m).
const HALF: f64 = 3.0;
/// Number of worlds.
const WORLDS: u64 = 110;

fn any_obstacle(rng: &mut ChaCha8Rng) -> Convex {
    let mut within = |low: f64, high: f64| rng.random_range(low..high);
    let center = Point2::new(within(-HALF, HALF), within(-HALF, HALF));
    if within(0.0, 1.0) < 0.4 {
        Convex::disc(center, within(0.05, 0.7))
    } else {
        let sides = [within(0.05, 1.2), within(0.05, 0.5)];
        Convex::rectangle(center, sides, within(-1.6, 1.6))
    }
}

/// Drives a robot through the world of a seed; returns whether its goal was surely reachable, or `None` if
/// that is not decided.
fn drive(seed: u64, machine: Machine) -> Option<bool> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let count = rng.random_range(2..16);
    let parts: Vec<_> = (0..count).map(|_| any_obstacle(&mut rng)).collect();
    let space = square(HALF, parts);
    let params = machine.driver();
    let (radius, grown) = (
        machine.radius,
        machine.radius + steering::tangent_bug::MARGIN,
    );
    let start = space.random_free(&mut rng, grown + 0.02)?;
    let mut coordinate = || rng.random_range(-2.8..2.8);
    let goal = Point2::new(coordinate(), coordinate());
    let reachable = |radius: f64| {
        let graph = TangentGraph::new(&space, radius).unwrap();
        graph.distance(start, goal).is_some()
    };
    let surely = reachable(grown + 0.04);
    // A robot within the tolerance of the goal could continue there with a smaller radius.
    let surely_not = !reachable(radius - params.go_to.arrived - 0.01);
    let pose = Pose2::new(start.x, start.y, coordinate());
    let mut run = Run::new(machine, space.clone(), pose, params);
    let outcome = run.go(goal, 900.0);
    assert!(
        run.least_clearance > 0.0,
        "world {seed}: contact {}",
        run.least_clearance
    );
    assert!(outcome.is_some(), "world {seed}: no end at {:?}", run.pose);
    if surely {
        assert_eq!(outcome, Some(Reached), "world {seed}: at {:?}", run.pose);
    }
    if surely_not {
        assert_eq!(outcome, Some(Unreachable), "world {seed}");
    }
    (surely || surely_not).then_some(surely)
}

/// Numbers of worlds whose goal surely could not and surely could be reached.
fn drive_all(seeds: core::ops::Range<u64>, machine: Machine) -> [u32; 2] {
    let mut judged = [0; 2];
    for reachable in seeds.filter_map(|seed| drive(seed, machine)) {
        judged[usize::from(reachable)] += 1;
    }
    judged
}

#[test]
fn the_robot_reaches_what_can_be_reached_and_reports_the_rest() {
    let judged = drive_all(0..WORLDS, PATROL);
    // Both kinds of worlds occur.
    assert!(judged[0] > 15 && judged[1] > 50, "{judged:?}");
}

#[test]
fn the_robot_leaves_wedges() {
    // The tip of a wedge looks walled in, and a step outside it either wall may be the followed one.
    for seed in [2510, 2889, 5537, 6409, 7180] {
        assert_eq!(drive(seed, PATROL), Some(true), "world {seed}");
    }
}

#[test]
fn a_robot_whose_speeds_take_time_to_change_does_as_well() {
    let nimble = Machine {
        accelerations: Some((1.0, 8.0)),
        ..PATROL
    };
    let slow = Machine {
        v_max: 0.5,
        ..nimble
    };
    let sluggish = Machine {
        range: 0.7,
        accelerations: Some((0.5, 4.0)),
        ..PATROL
    };
    for (seeds, machine) in [(0..14, nimble), (30..40, slow), (50..58, sluggish)] {
        let judged = drive_all(seeds, machine);
        assert!(judged[1] > 3, "{judged:?}");
    }
}

#[test]
fn a_long_range_sensor_does_not_cause_oscillation_at_a_boundary() {
    let far = Machine {
        range: 3.5,
        ..PATROL
    };
    for seed in [56, 119, 208] {
        assert_ne!(drive(seed, far), Some(false), "{seed}");
    }
}
