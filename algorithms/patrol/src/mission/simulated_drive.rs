//! Laps driven in a simulated drive without obstacles, to measure their times.

use avoidance::waypoint_driver::lap_time;
use control::go_to::GoToParams;
use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use planner_view::limits::Limits;

use super::Drive;
use crate::alpha::LapTimes;

/// Tick of the simulated drive (s). It differs from the run's tick: the width must not depend on
/// that.
const TICK_S: f64 = 0.05;

/// A robot that the waypoint driver drives through laps in open space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedDrive {
    limits: Limits,
    go_to: GoToParams,
    /// Additional time per waypoint, compared with the ideal drive (s).
    loss_s: f64,
}

impl SimulatedDrive {
    /// Creates a robot with these limits. With finite accelerations, each waypoint costs it a stop
    /// and a start, of wheels and of turning; this is more than it really loses.
    pub fn new(drive: &Drive, go_to: &GoToParams) -> Self {
        let time = |speed: f64, acceleration: Option<f64>| {
            acceleration.map_or(0.0, |acceleration| speed / acceleration)
        };
        Self {
            limits: drive.limits,
            go_to: *go_to,
            loss_s: time(drive.limits.v_max(), drive.acceleration)
                + time(drive.limits.omega_max(), drive.angular_acceleration),
        }
    }
}

impl LapTimes for SimulatedDrive {
    fn lap_times(&mut self, laps: &[Vec<Point2<f64>>]) -> Option<Vec<f64>> {
        let mut heading: Option<f64> = None;
        let mut times = Vec::with_capacity(laps.len());
        for lap in laps {
            let (&start, rest) = lap.split_first()?;
            let towards =
                |from: Point2<f64>, to: Point2<f64>| math::atan2(to.y - from.y, to.x - from.x);
            // The robot arrives in the direction of the last leg, and leaves in that of the first
            // one.
            let first = rest.first().map_or(0.0, |&to| towards(start, to));
            let pose = Pose2::new(start.x, start.y, heading.unwrap_or(first));
            let time = lap_time(&pose, rest, &self.limits, &self.go_to, TICK_S).ok()?;
            times.push(time + self.loss_s * rest.len() as f64);
            if let [.., from, to] = lap[..] {
                heading = Some(towards(from, to));
            }
        }
        Some(times)
    }
}
