//! Points of a path, dense enough for driving from one to the next.

use geometry::math;
use nalgebra::Point2;
use navigation::tangent_graph::PathLeg;

use crate::plan::Sample;

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Length of the path up to it (m).
    pub s: f64,
    /// Position (m).
    pub at: Point2<f64>,
    /// Direction of travel (rad), continuous along the path.
    pub theta: f64,
    /// Curvature (1/m): positive to the left.
    pub kappa: f64,
}

/// The points of a trajectory's path; curvatures are 0.
pub fn of_samples(samples: &[Sample]) -> Vec<PathPoint> {
    let mut points: Vec<PathPoint> = Vec::with_capacity(samples.len());
    for sample in samples {
        let at = Point2::new(sample.x, sample.y);
        let s = points
            .last()
            .map_or(0.0, |last| last.s + (at - last.at).norm());
        points.push(PathPoint {
            s,
            at,
            theta: sample.theta,
            kappa: 0.0,
        });
    }
    points
}

/// Maximum distance between points of a path (m).
pub const SPACING: f64 = 0.015;
/// Maximum length of a planned path (m): some hundred thousand points.
pub const MAX_LENGTH: f64 = 2e3;
/// Maximum distance (m) between the path and the chord of two points.
const SAGITTA: f64 = 5e-5;

/// Distance (m) between points of a path of this curvature (1/m).
pub fn spacing(kappa: f64) -> f64 {
    SPACING.min((8.0 * SAGITTA / kappa.abs().max(1e-12)).sqrt())
}

/// The points of a leg that begins with this heading (rad) after `s` (m) of path.
pub fn of_leg(leg: &PathLeg, s: f64, theta: f64) -> Vec<PathPoint> {
    let (length, kappa) = (leg.length(), leg.curvature());
    // A leg from rest to rest needs points at which the robot moves.
    let count = (length / spacing(kappa)).ceil().max(4.0);
    (0..=count as usize)
        .map(|i| {
            let part = i as f64 / count;
            PathPoint {
                s: s + part * length,
                at: leg.at(part),
                theta: theta + part * length * kappa,
                kappa,
            }
        })
        .collect()
}

/// The direction at the start of a leg (rad), as the representative nearest to `near` (rad).
pub fn leg_heading(leg: &PathLeg, near: f64) -> f64 {
    let u = leg.heading(0.0);
    near + math::angle_difference(math::atan2(u.y, u.x), near)
}
