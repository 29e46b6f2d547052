//! Random worlds, by number, and the judgement of a drive through one of them.

use crate::drive::{Machine, Run, square};
use avoidance::tangent_bug;
use geometry::pose::Pose2;
use geometry::shape::Convex;
use nalgebra::Point2;
use navigation::tangent_graph::TangentGraph;
use planner_view::free_space::FreeSpace;
use planner_view::waypoint::WaypointOutcome;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Half the width of the worlds (m).
const HALF: f64 = 3.0;
/// Time after which a drive counts as endless (s).
const MAX_TIME_S: f64 = 900.0;
/// Clearance beyond the grown radius with which a goal surely is reachable (m).
const ROOM: f64 = 0.04;

/// Task of a robot in a random world.
pub struct RandomWorld {
    pub space: FreeSpace,
    pub start: Pose2,
    pub goal: Point2<f64>,
}

/// A drive that has ended, or has not.
pub struct Driven {
    /// `true` if the goal surely was reachable, `false` if it surely was not; `None` if neither is sure.
    pub reachable: Option<bool>,
    /// Outcome; `None` for an endless drive.
    pub outcome: Option<WaypointOutcome>,
    /// The robot at the end.
    pub run: Run,
}

impl RandomWorld {
    /// The world of a number; `None` if this robot has no place in it.
    pub fn new(number: u64, machine: &Machine) -> Option<Self> {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let count = rng.random_range(2..16);
        let parts: Vec<_> = (0..count).map(|_| any_obstacle(&mut rng)).collect();
        let space = square(HALF, parts);
        let start = space.random_free(&mut rng, grown(machine) + 0.02)?;
        let mut coordinate = || rng.random_range(-2.8..2.8);
        let goal = Point2::new(coordinate(), coordinate());
        let start = Pose2::new(start.x, start.y, coordinate());
        Some(Self { space, start, goal })
    }

    /// Drives the robot to the goal.
    pub fn drive(&self, machine: Machine) -> Driven {
        let params = machine.driver();
        let reachable = |radius: f64| {
            let graph = TangentGraph::new(&self.space, radius).unwrap();
            graph.distance(self.start.position(), self.goal).is_some()
        };
        // A robot within the tolerance of the goal could continue there with a smaller radius.
        let surely_not = || !reachable(machine.radius - params.go_to.arrived - 0.01);
        let reachable = if reachable(grown(&machine) + ROOM) {
            Some(true)
        } else {
            surely_not().then_some(false)
        };
        let mut run = Run::new(machine, self.space.clone(), self.start, params);
        let outcome = run.go(self.goal, MAX_TIME_S);
        Driven {
            reachable,
            outcome,
            run,
        }
    }
}

fn grown(machine: &Machine) -> f64 {
    machine.radius + tangent_bug::MARGIN
}

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
