//! A robot with a range sensor and a waypoint driver in a world of convex obstacles.

use avoidance::waypoint_driver::{DriverParams, Situation, WaypointDriver};
use control::go_to::coast;
use geometry::math;
use geometry::pose::{Pose2, Twist2};
use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Vector2};
use planner_view::free_space::FreeSpace;
use planner_view::limits::Limits;
use planner_view::view::ScanView;
use planner_view::waypoint::{Waypoint, WaypointKind, WaypointOutcome, WaypointReport};
use sim_backend::random::Stream;

pub const DT: f64 = 0.05;

/// A robot and its sensor.
#[derive(Debug, Clone, Copy)]
pub struct Machine {
    pub radius: f64,
    pub v_max: f64,
    pub omega_max: f64,
    pub range: f64,
    pub beams: usize,
    /// Standard deviation of a measured distance (m).
    pub noise: f64,
    /// Limits of acceleration, linear and angular (m/s², rad/s²).
    pub accelerations: Option<(f64, f64)>,
}

/// The robot of the patrol paper: 1 m/s, a sensor with a range of 0.5 m.
pub const PATROL: Machine = Machine {
    radius: 0.15,
    v_max: 1.0,
    omega_max: 3.0,
    range: 0.5,
    beams: 180,
    noise: 0.0,
    accelerations: None,
};

/// That robot with a far sensor.
pub const FAR: Machine = Machine {
    range: 3.5,
    ..PATROL
};

/// That robot with a short, a far and the default sensor.
pub const SENSORS: [Machine; 3] = [
    PATROL,
    FAR,
    Machine {
        beams: 360,
        noise: 0.01,
        ..FAR
    },
];

impl Machine {
    /// The driver's parameters, with the accelerations of this drive.
    pub fn driver(&self) -> DriverParams {
        let (linear, angular) = self.accelerations.unzip();
        DriverParams::default().for_drive(linear, angular)
    }

    /// A scan of this sensor.
    pub fn view<'a>(&self, ranges: &'a [f32]) -> ScanView<'a> {
        ScanView {
            angle_min: 0.0,
            angle_increment: core::f64::consts::TAU / self.beams as f64,
            range_min: 0.0,
            range_max: self.range,
            ranges,
        }
    }
}

/// A drive through a world.
pub struct Run {
    pub machine: Machine,
    pub space: FreeSpace,
    pub driver: WaypointDriver,
    pub pose: Pose2,
    pub twist: Twist2,
    pub tick: u32,
    pub travelled: f64,
    /// Minimum clearance of the robot's edge so far (m).
    pub least_clearance: f64,
    pub reports: Vec<WaypointReport>,
    pub known: Option<FreeSpace>,
}

impl Run {
    pub fn new(machine: Machine, space: FreeSpace, pose: Pose2, params: DriverParams) -> Self {
        let limits = Limits::new(machine.v_max, 0.0, machine.omega_max).unwrap();
        assert!(
            space.is_free(pose.position(), machine.radius),
            "the start is not free"
        );
        Self {
            machine,
            space,
            driver: WaypointDriver::new(params, limits, machine.radius).unwrap(),
            pose,
            twist: Twist2::STOP,
            tick: 0,
            travelled: 0.0,
            least_clearance: f64::INFINITY,
            reports: Vec::new(),
            known: None,
        }
    }

    pub fn scan(&self) -> Vec<f32> {
        let mut noise = Stream::new(7, 0, u64::from(self.tick));
        let step = core::f64::consts::TAU / self.machine.beams as f64;
        (0..self.machine.beams)
            .map(|beam| {
                let (sin, cos) = math::sincos(self.pose.theta + beam as f64 * step);
                let (from, dir) = (self.pose.position(), Vector2::new(cos, sin));
                let range = self.space.shapes().cast_ray(from, dir, self.machine.range);
                range.map_or(f32::INFINITY, |range| {
                    (range + self.machine.noise * noise.normal()) as f32
                })
            })
            .collect()
    }

    /// Executes one tick with the next waypoints from `next`; returns `true` if there still is one.
    pub fn step(&mut self, next: &mut dyn FnMut() -> Option<Waypoint>, with_scan: bool) -> bool {
        let ranges = self.scan();
        let scan = with_scan.then(|| self.machine.view(&ranges));
        let situation = Situation {
            pose: self.pose,
            twist: self.twist,
            scan,
            known: self.known.as_ref(),
            time_s: f64::from(self.tick) * DT,
            dt: DT,
        };
        let driving = self.driver.drive(next, &situation, &mut self.reports);
        if self.driver.current().is_none() {
            return false;
        }
        self.twist = match self.machine.accelerations {
            None => driving.command,
            Some((a, b)) => Twist2::new(
                driving
                    .command
                    .v
                    .clamp(self.twist.v - a * DT, self.twist.v + a * DT),
                driving
                    .command
                    .omega
                    .clamp(self.twist.omega - b * DT, self.twist.omega + b * DT),
            ),
        };
        for _ in 0..4 {
            self.pose = coast(&self.pose, self.twist, DT / 4.0);
            let clearance = self.space.distance(self.pose.position()) - self.machine.radius;
            self.least_clearance = self.least_clearance.min(clearance);
        }
        self.travelled += self.twist.v * DT;
        self.tick += 1;
        true
    }

    /// Drives to one point of a route; returns the outcome, `None` after `most` seconds.
    pub fn go(&mut self, goal: Point2<f64>, most: f64) -> Option<WaypointOutcome> {
        let mut point = Some(route(0, goal));
        let ticks = (most / DT) as u32;
        for _ in 0..ticks {
            if !self.step(&mut || point.take(), true) {
                break;
            }
        }
        self.reports.last().map(|report| report.outcome)
    }
}

pub fn route(number: u64, point: Point2<f64>) -> Waypoint {
    Waypoint {
        number,
        lap: 0,
        kind: WaypointKind::Route,
        point,
    }
}

/// A square of this half width (m) about the origin with obstacles in it.
pub fn square(half: f64, parts: Vec<Convex>) -> FreeSpace {
    let bounds = Aabb {
        min: Point2::new(-half, -half),
        max: Point2::new(half, half),
    };
    FreeSpace::new(parts, bounds, 0.05).unwrap()
}

/// A wall of this thickness (m) along a line.
pub fn wall(from: (f64, f64), to: (f64, f64), thickness: f64) -> Convex {
    let (a, b) = (Point2::new(from.0, from.1), Point2::new(to.0, to.1));
    let along = (b - a).normalize() * (0.5 * thickness);
    let side = Vector2::new(-along.y, along.x);
    Convex::polygon(&[
        a - along - side,
        b + along - side,
        b + along + side,
        a - along + side,
    ])
}
