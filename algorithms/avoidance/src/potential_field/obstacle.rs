//! Repulsion from obstacles: the gradient of the blurred map, ∇(G∗I).

use nalgebra::{Point2, Vector2};
use parameters::{Fidelity, Parameters, at_least};

use super::capped;
use planner_view::map::{PlannerMap, cell_of};

/// Velocity per gradient (m²/s); the product of the paper's field speed 2 and gradient gain 2.2.
const GAIN: f64 = 4.4;

/// Maximum magnitude of the push (m/s).
const MAX_SPEED: f64 = 6.0;

parameters::table! {
    /// Parameters of the obstacle field.
    #[derive(Copy)]
    pub struct ObstacleParams {
        /// Variant of the gradient. [`Fidelity::Ours`]: the gradient of the plain blur, interpolated
        /// between cells; continuous, bounded, and still pointing outwards inside an obstacle.
        /// [`Fidelity::Published`]: the gradient of the blur that is set to 0 in obstacles, constant within
        /// a cell; it jumps from cell to cell, and near a wall grows with the map's resolution.
        pub fidelity: Fidelity = Fidelity::Ours,
        /// Clearance beyond the robot's radius below which the part of the summed field that points at the obstacle
        /// is removed; 0 to disable (the paper).
        pub guard: f64 [at_least(0).unit("m")] = 0.1,
    }
}

impl Parameters for ObstacleParams {}

impl ObstacleParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            fidelity: Fidelity::Published,
            guard: 0.0,
        }
    }
}

/// The push of the obstacles at a point (m/s); zero outside the map.
pub fn obstacle(map: &PlannerMap, at: Point2<f64>, fidelity: Fidelity) -> Vector2<f64> {
    match fidelity {
        Fidelity::Ours => capped(map.blurred().gradient(at) * GAIN, MAX_SPEED),
        Fidelity::Published => masked_cell_gradient(map, at) * GAIN,
    }
}

/// The field without the part that would drive a robot of this radius (m) at `at` into a near wall.
///
/// At a clearance beyond the radius of `guard` (m) or more the field is unchanged; at contact the whole inward
/// part is removed; linear in between.
pub fn slide_along_obstacles(
    map: &PlannerMap,
    at: Point2<f64>,
    radius: f64,
    field: Vector2<f64>,
    guard: f64,
) -> Vector2<f64> {
    // Also false for a guard or radius of NaN.
    if !(guard > 0.0 && radius.is_finite()) {
        return field;
    }
    let spare = map.clearance(at) - radius;
    if spare >= guard {
        return field;
    }
    let Some(away) = map.away_from_obstacles(at) else {
        return field;
    };
    let inward = field.dot(&away).min(0.0);
    let share = 1.0 - (spare / guard).clamp(0.0, 1.0);
    field - away * (inward * share)
}

/// Central difference of the masked blur around the cell at a point (1/m).
fn masked_cell_gradient(map: &PlannerMap, at: Point2<f64>) -> Vector2<f64> {
    let blurred = map.blurred();
    let frame = blurred.grid().frame;
    let Some((col, row)) = frame.cell_at(at) else {
        return Vector2::zeros();
    };
    let (col, row) = (col as i64, row as i64);
    let value = |col: i64, row: i64| {
        let (c, r) = (
            col.clamp(0, frame.width as i64 - 1),
            row.clamp(0, frame.height as i64 - 1),
        );
        let index = frame.index(c as usize, r as usize);
        let occupied = blurred.occupied().cells.get(index).copied().unwrap_or(true);
        if occupied {
            0.0
        } else {
            cell_of(blurred.grid(), c, r)
        }
    };
    Vector2::new(
        value(col + 1, row) - value(col - 1, row),
        value(col, row + 1) - value(col, row - 1),
    ) / (2.0 * frame.resolution)
}
