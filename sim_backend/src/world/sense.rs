//! Sensors of robots: ranges, lines of sight, odometry.

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use geometry::shape::ray_disc;
use nalgebra::{Point2, Vector2};

use super::{Purpose, World, has_body, stream_number};
use crate::random::Stream;
use robot::drive;
use robot::spec::ScanSpec;

impl World {
    /// The range scanner of a robot.
    pub fn scan_spec(&self, robot: usize) -> Option<&ScanSpec> {
        self.extras.get(robot).and_then(|extra| extra.scan.as_ref())
    }

    /// Measures with a robot's range scanner: one value per beam into `ranges` (m) (see
    /// [`ScanSpec`]). Its noise depends on seed, robot and tick, not on the number of calls.
    ///
    /// Returns the scanner, or `None` (and no ranges) if the robot has none.
    ///
    /// ```
    /// # use geometry::map::{MapSpec, VectorMap};
    /// # use geometry::pose::Pose2;
    /// # use robot::spec::{RobotSpec, ScanSpec};
    /// # use sim_backend::spec::{RulesSpec, WorldSpec};
    /// # use robot::team::Role;
    /// # use sim_backend::world::World;
    /// let mut robot = RobotSpec::new("walle", Role::Neutral, Pose2::new(1.0, 1.5, 0.0));
    /// robot.scan = Some(ScanSpec { beams: 1, noise: 0.0, ..ScanSpec::default() });
    /// let world = World::new(WorldSpec {
    ///     map: MapSpec::Vector(VectorMap::empty([0.0, 0.0], [4.0, 3.0], 0.05)),
    ///     robots: vec![robot],
    ///     rules: RulesSpec::default(),
    ///     seed: 1,
    /// })?;
    /// let mut ranges = Vec::new();
    /// world.scan(0, &mut ranges);
    /// assert_eq!(ranges, [3.0]);
    /// # Ok::<(), sim_backend::world::WorldError>(())
    /// ```
    pub fn scan(&self, robot: usize, ranges: &mut Vec<f32>) -> Option<&ScanSpec> {
        ranges.clear();
        let spec = self.scan_spec(robot)?;
        let pose = self.robots.get(robot)?.pose;
        let origin = pose.position();
        let reach = spec.range_max;
        // Robots beyond the range are excluded once, not per beam.
        let near = |p: Point2<f64>, radius: f64| (p - origin).norm() - radius < reach;
        let others = |i: usize| {
            let other = &self.robots[i];
            i != robot
                && has_body(other, &self.rules)
                && near(other.pose.position(), other.radius())
        };
        let mut discs = [(Point2::origin(), 0.0); 32];
        let mut count = 0;
        let mut overflow = Vec::new();
        for i in (0..self.robots.len()).filter(|&i| others(i)) {
            let disc = (self.robots[i].pose.position(), self.robots[i].radius());
            if let Some(slot) = discs.get_mut(count) {
                *slot = disc;
                count += 1;
            } else {
                overflow.push(disc);
            }
        }
        let mut noise = (spec.noise > 0.0)
            .then(|| Stream::new(self.seed, stream_number(robot, Purpose::Scan), self.tick));
        for beam in 0..spec.beams {
            let angle = pose.theta + spec.angle_min + beam as f64 * spec.angle_increment;
            let (sin, cos) = math::sincos(angle);
            let dir = Vector2::new(cos, sin);
            let mut range = self
                .map
                .cast_ray(origin, dir, reach)
                .unwrap_or(f64::INFINITY);
            for &(center, radius) in discs[..count].iter().chain(&overflow) {
                if let Some(t) = ray_disc(center, radius, origin, dir) {
                    range = range.min(t);
                }
            }
            if let Some(noise) = &mut noise {
                range += spec.noise * noise.normal();
            }
            ranges.push(if range < spec.range_min {
                f32::NEG_INFINITY
            } else if range > reach {
                f32::INFINITY
            } else {
                range as f32
            });
        }
        Some(spec)
    }

    /// Returns `true` if no obstacle lies between two robots' centres (other robots do not hide).
    pub fn sees(&self, from: usize, to: usize) -> bool {
        match (self.robots.get(from), self.robots.get(to)) {
            (Some(a), Some(b)) => self.map.line_of_sight(a.pose.position(), b.pose.position()),
            _ => false,
        }
    }

    /// The pose by a robot's odometry: exact at the start, and always exact without noise and wheel
    /// slip.
    pub fn odometry(&self, robot: usize) -> Option<Pose2> {
        self.extras.get(robot).map(|extra| extra.odometry_pose)
    }

    /// Integrates the wheels' turning, with its errors.
    pub(super) fn update_odometry(&mut self, dt: f64) {
        for i in 0..self.robots.len() {
            let (robot, extra) = (&self.robots[i], &mut self.extras[i]);
            if extra.odometry.is_none() && extra.actuator.is_none() {
                // The only error is a wall that pushes sideways, which wheels do not measure;
                // without a model the odometry counts as perfect.
                extra.odometry_pose = robot.pose;
                continue;
            }
            if !robot.is_active() || robot.twist == Twist2::STOP {
                continue;
            }
            // Slipping wheels turn farther than the robot moves.
            let slip = extra.actuator.unwrap_or_default();
            let mut distance = robot.twist.v * dt / (1.0 - slip.slip);
            let mut turn = robot.twist.omega * dt / (1.0 - slip.angular_slip);
            if let Some(spec) = &extra.odometry {
                let stream = stream_number(i, Purpose::Odometry);
                let mut noise = Stream::new(self.seed, stream, self.tick);
                let (way, angle) = (distance.abs().sqrt(), turn.abs().sqrt());
                distance += spec.distance_per_distance * way * noise.normal();
                turn += spec.heading_per_distance * way * noise.normal()
                    + spec.heading_per_rotation * angle * noise.normal();
            }
            extra.odometry_pose =
                drive::integrate(extra.odometry_pose, Twist2::new(distance, turn), 1.0);
        }
    }
}
