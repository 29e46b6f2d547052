//! Route of the robot: a found path with its length at every point.

use control::path_tracking::Path;
use geometry::pose::Pose2;
use nalgebra::Point2;

use crate::motion::Leg;
use crate::search::Waypoint;

/// Maximum length of the pieces that draw an arc (m).
const PIECE: f64 = 0.05;

/// Path from the robot's predicted pose to an exit, or as far towards one as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Its points, the start first.
    pub waypoints: Vec<Waypoint>,
    /// The same as straight pieces.
    pub path: Path,
    /// Cost (m).
    pub cost: f64,
    /// `true` if it ends at a goal.
    pub is_complete: bool,
}

impl Route {
    /// Returns a route over these points; `None` if there are fewer than two.
    pub fn new(waypoints: Vec<Waypoint>, is_complete: bool) -> Option<Self> {
        let cost = waypoints.last().filter(|_| waypoints.len() > 1)?.cost;
        let path = Path::new(drawn(&waypoints));
        Some(Self {
            waypoints,
            path,
            cost,
            is_complete,
        })
    }

    /// Returns the pose at a distance along the route (m).
    pub fn pose_at(&self, along: f64) -> Option<Pose2> {
        let p = self.path.at(along)?;
        Some(Pose2::new(p.x, p.y, self.path.direction(along)?))
    }
}

fn drawn(waypoints: &[Waypoint]) -> Vec<Point2<f64>> {
    let mut points = Vec::with_capacity(waypoints.len());
    for waypoint in waypoints {
        if let Leg::Arc(arc) = &waypoint.leg {
            let pieces = (arc.length() / PIECE).ceil().clamp(1.0, 1e4) as u32;
            points.extend((1..pieces).map(|i| arc.at(f64::from(i) / f64::from(pieces))));
        }
        points.push(waypoint.pose.position());
    }
    points
}
