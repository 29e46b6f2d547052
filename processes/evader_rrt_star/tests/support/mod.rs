//! The chasing-game paper's city as exact shapes, for tests and benches.
#![allow(dead_code, reason = "each user needs another part of it")]

use evader_rrt_star::cost::{CostModel, Pursuer};
use evader_rrt_star::params::{Algorithm, CostParams};
use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use planner_view::free_space::FreeSpace;

/// Radius of the TurtleBot3 Burger's body as a disc (m).
pub const RADIUS: f64 = 0.105;
/// The city's exit (m).
pub const EXIT: Point2<f64> = Point2::new(9.0, 0.0);
/// Start pose of the first evader.
pub const START: Pose2 = Pose2 {
    x: -4.5,
    y: 7.5,
    theta: 0.0,
};
/// Start positions of the Police (m).
pub const POLICE: [(f64, f64); 4] = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)];

/// 25 blocks, a wall with a gap at +x, cut corners.
pub fn city() -> FreeSpace {
    let rectangle =
        |x: f64, y: f64, half: [f64; 2]| Convex::rectangle(Point2::new(x, y), half, 0.0);
    let mut parts = Vec::new();
    for x in [-6.0, -3.0, 0.0, 3.0, 6.0] {
        for y in [-6.0, -3.0, 0.0, 3.0, 6.0] {
            parts.push(rectangle(x, y, [1.0, 1.0]));
        }
    }
    parts.push(rectangle(-8.5, 0.0, [0.5, 9.0]));
    parts.push(rectangle(0.0, -8.5, [9.0, 0.5]));
    parts.push(rectangle(0.0, 8.5, [9.0, 0.5]));
    parts.push(rectangle(8.5, -5.0, [0.5, 3.75]));
    parts.push(rectangle(8.5, 5.0, [0.5, 3.75]));
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let corner = |x: f64, y: f64| Point2::new(sx * x, sy * y);
        let mut corners = [corner(8.0, 8.0), corner(7.5, 8.0), corner(8.0, 7.5)];
        if sx * sy < 0.0 {
            // Mirrored: the other way round.
            corners.reverse();
        }
        parts.push(Convex::polygon(&corners));
    }
    space(parts, 9.5)
}

/// Returns a square world of this half side (m) with some pieces.
pub fn space(parts: Vec<Convex>, half: f64) -> FreeSpace {
    let bounds = Aabb {
        min: Point2::new(-half, -half),
        max: Point2::new(half, half),
    };
    FreeSpace::new(parts, bounds, 0.05).expect("a sane world")
}

/// Returns the costs for an evader of 0.45 m/s with the Police at their start.
pub fn costs(params: CostParams, algorithm: Algorithm) -> CostModel {
    let mut cost = CostModel::new(params, algorithm, 0.45);
    cost.set_pursuers(POLICE.iter().map(|&(x, y)| Pursuer {
        at: Point2::new(x, y),
        v_max: 0.3,
    }));
    cost
}
