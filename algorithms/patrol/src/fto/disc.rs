//! A disc that does not exist, and a range scan that contains it.

use geometry::math;
use geometry::pose::Pose2;
use geometry::shape::Convex;
use nalgebra::{Point2, Vector2};
use planner_view::view::ScanView;

/// A fictive obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Centre (m).
    pub center: Point2<f64>,
    /// Radius (m), > 0.
    pub radius: f64,
}

/// The scan with a disc in it: each beam that meets the disc before a real echo ends there. The
/// ranges are stored in `buffer`, whose previous contents do not matter.
///
/// Without a disc, with a disc out of reach or around the sensor itself, or with a pose that is not
/// finite, the ranges are the real ones. A range never grows.
pub fn merged<'a>(
    scan: &ScanView<'_>,
    pose: &Pose2,
    disc: Option<&Disc>,
    buffer: &'a mut Vec<f32>,
) -> ScanView<'a> {
    buffer.clear();
    buffer.extend_from_slice(scan.ranges);
    let origin = pose.position();
    let seen = disc.filter(|disc| {
        let distance = (disc.center - origin).norm();
        distance > disc.radius && distance - disc.radius <= scan.range_max
    });
    if let Some(disc) = seen {
        let shape = Convex::disc(disc.center, disc.radius);
        for (i, range) in buffer.iter_mut().enumerate() {
            let angle = pose.theta + scan.angle_min + scan.angle_increment * i as f64;
            let (sin, cos) = math::sincos(angle);
            let Some(hit) = shape.ray(origin, Vector2::new(cos, sin)) else {
                continue;
            };
            if hit >= scan.range_min && hit <= scan.range_max && hit < f64::from(*range) {
                *range = hit as f32;
            }
        }
    }
    ScanView {
        ranges: buffer,
        ..*scan
    }
}
