//! Follower of a trajectory at a safe rate.
//!
//! The reference moves along the trajectory at the rate r ∈ [0, 1]: its path is that of the
//! trajectory, its speed may be less. r is below 1 in three cases: the robot lags behind and could
//! not catch up with a reference at full speed; the reference must brake to stop before an
//! obstacle; it accelerates again.

use control::go_to::coast;
use geometry::pose::{Pose2, Twist2};

use crate::drive::Drive;
use crate::tracking::{self, K_X};
use crate::trajectory::Trajectory;

/// Number of bisections of the search for a rate.
const HALVINGS: u32 = 30;
/// Speed below which the robot stands (m/s).
pub const STANDING: f64 = 1e-6;
/// Distance before a required stop at which the robot stops (m).
const BEFORE: f64 = 1e-3;
/// Distance (m) from a standing reference below which the robot stops correcting.
const THERE: f64 = 2e-3;

/// Trajectory and the state of its follower.
#[derive(Debug, Clone)]
pub struct Follow {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// Time of the reference on the trajectory (s).
    pub tau: f64,
    /// Minimum distance of the robot's centre from obstacles on it (m).
    pub clearance: f64,
    /// Distance along the trajectory (m) at which something blocks the robot.
    pub blocked: Option<f64>,
    /// `true` if there is no room for tracking errors. Ticks then end where speeds step, so that no
    /// command is the mean of a turn on the spot and a straight segment.
    pub careful: bool,
    /// `true` if it ends before the goal, on the route to it.
    pub is_stretch: bool,
}

/// State of the robot while it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Pose.
    pub pose: Pose2,
    /// Speeds.
    pub twist: Twist2,
}

/// Limits of the path in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stops {
    /// `true` if the robot shall stop as soon as it can.
    pub halt: bool,
    /// Distance along the path (m) that other robots leave free.
    pub traffic: Option<f64>,
}

/// Command of a tick, and the advance of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// The command.
    pub command: Twist2,
    /// The rate of the reference, 0…1.
    pub rate: f64,
}

impl Follow {
    /// The reference's pose.
    pub fn reference(&self) -> Pose2 {
        self.trajectory.at(self.tau).0
    }

    /// Time left on it at full speed (s).
    pub fn left(&self) -> f64 {
        (self.trajectory.duration() - self.tau).max(0.0)
    }

    /// Returns the distance of the robot from its reference (m).
    pub fn error(&self, pose: &Pose2) -> f64 {
        (self.reference().position() - pose.position()).norm()
    }

    /// Returns the command for the next `dt` (s).
    pub fn pace(&self, drive: &Drive, motion: &Motion, stops: &Stops, dt: f64) -> Pace {
        let rate = self.rate(drive, motion, stops, dt);
        let (from, to) = (self.tau, self.tau + rate * dt);
        let (a, b) = (self.trajectory.at(from).0, self.trajectory.at(to).0);
        let ahead = self.trajectory.ahead(to) - self.trajectory.ahead(from);
        // Exact for the tick: the command applies to all of it.
        let reference = Twist2::new(ahead / dt, (b.theta - a.theta) / dt);
        let command = if reference != Twist2::STOP {
            tracking::command(&motion.pose, &a, reference)
        } else if stops.halt || self.room(stops).is_some_and(|room| room <= 0.0) {
            Twist2::STOP
        } else {
            self.settle(&motion.pose)
        };
        Pace {
            command: drive.clip(command),
            rate,
        }
    }

    /// Returns the motion after a tick at this pace, and moves the reference.
    pub fn advance(&mut self, drive: &Drive, motion: &mut Motion, pace: &Pace, dt: f64) {
        let twist = drive.execute(motion.twist, pace.command, dt);
        motion.pose = coast(&motion.pose, twist, dt);
        motion.twist = twist;
        self.tau += pace.rate * dt;
    }

    /// Returns the remaining correction at a stationary reference, at the end or while it waits.
    fn settle(&self, pose: &Pose2) -> Twist2 {
        let error = tracking::error(pose, &self.reference());
        let v = if error.x.abs() > THERE {
            K_X * error.x
        } else {
            0.0
        };
        Twist2::new(v, 0.0)
    }

    /// Returns the distance (m) along the path that the reference may still cover; `None` for all
    /// of it.
    fn room(&self, stops: &Stops) -> Option<f64> {
        let stop = match (self.blocked, stops.traffic) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        stop.map(|stop| stop - BEFORE - self.trajectory.along(self.tau))
    }

    fn rate(&self, drive: &Drive, motion: &Motion, stops: &Stops, dt: f64) -> f64 {
        let start = self.trajectory.along(self.tau);
        let theta = self.trajectory.at(self.tau).0.theta;
        let speed = |rate: f64| (self.trajectory.along(self.tau + rate * dt) - start) / dt;
        let turn = |rate: f64| {
            let to = self.trajectory.at(self.tau + rate * dt).0.theta;
            ((to - theta) / dt).abs()
        };
        let model = drive.model();
        let backwards = self.trajectory.is_backwards(self.tau);
        let sign = if backwards { -1.0 } else { 1.0 };
        // Of the robot in the direction of the reference.
        let now = Twist2::new(sign * motion.twist.v, motion.twist.omega);
        let mut high = 1.0f64;
        // The drive limits its speed.
        if let Some(a) = model.acceleration {
            high = high.min(largest(|r| speed(r) <= now.v + a * dt * (1.0 + 1e-9)));
        }
        if let Some(a) = model.angular_acceleration {
            let most = now.omega.abs() + a * dt * (1.0 + 1e-9);
            high = high.min(largest(|r| turn(r) <= most));
        }
        // The reference waits for a robot that lags behind: the robot keeps a reserve of speed to
        // catch up.
        let lag = sign * tracking::error(&motion.pose, &self.reference()).x;
        if lag > 0.0 {
            let left = (drive.top_speed(backwards) - K_X * lag).max(0.0);
            high = high.min(largest(|r| speed(r) <= left));
        }
        if let Some(room) = self.room(stops) {
            let stops_in_time = |r: f64| {
                let v = speed(r);
                v * dt + drive.braking_distance(v) <= room
            };
            high = high.min(largest(stops_in_time));
        }
        if self.careful
            && let Some(step) = self.trajectory.next_step(self.tau + 1e-9)
        {
            high = high.min((step - self.tau) / dt);
        }
        if stops.halt {
            high = 0.0;
        }
        // The drive's braking limit is a lower bound.
        if let Some(a) = model.acceleration {
            let least = now.v - a * dt;
            if least > 0.0 {
                high = high.max(1.0 - largest(|s| speed(1.0 - s) >= least));
            }
        }
        high
    }
}

/// Returns the largest rate in [0, 1] up to which a condition holds; 0 if it never holds. It must
/// be monotonic: true up to some rate.
fn largest(holds: impl Fn(f64) -> bool) -> f64 {
    if holds(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Returns the motion after a tick of stopping.
pub fn stop(drive: &Drive, motion: &mut Motion, dt: f64) {
    let twist = drive.execute(motion.twist, Twist2::STOP, dt);
    motion.pose = coast(&motion.pose, twist, dt);
    motion.twist = twist;
}

#[cfg(test)]
mod tests {
    use robot::spec::RobotModel;

    use super::*;
    use crate::trajectory::Sample;

    const DT: f64 = 0.05;

    fn drive(acceleration: Option<f64>) -> Drive {
        Drive::new(RobotModel {
            acceleration,
            ..RobotModel::turtlebot3_burger()
        })
    }

    /// Straight path of 2 m in 14 s; the speed falls in the last 8 s.
    fn straight() -> Follow {
        let sample = |t: f64, x: f64, v: f64| Sample {
            t,
            pose: Pose2 {
                x,
                y: 0.0,
                theta: 0.0,
            },
            twist: Twist2::new(v, 0.0),
        };
        let samples = vec![
            sample(0.0, 0.0, 0.2),
            sample(6.0, 1.2, 0.2),
            sample(14.0, 2.0, 0.0),
        ];
        Follow {
            trajectory: Trajectory::new(samples).unwrap(),
            tau: 0.0,
            clearance: 0.1,
            blocked: None,
            careful: false,
            is_stretch: false,
        }
    }

    fn run(follow: &mut Follow, drive: &Drive, motion: &mut Motion, ticks: u32, stops: Stops) {
        for _ in 0..ticks {
            let pace = follow.pace(drive, motion, &stops, DT);
            follow.advance(drive, motion, &pace, DT);
        }
    }

    fn at(x: f64, v: f64) -> Motion {
        Motion {
            pose: Pose2::new(x, 0.0, 0.0),
            twist: Twist2::new(v, 0.0),
        }
    }

    #[test]
    fn it_arrives_when_the_trajectory_does() {
        let (mut follow, mut motion) = (straight(), at(0.0, 0.0));
        run(
            &mut follow,
            &drive(None),
            &mut motion,
            280,
            Stops::default(),
        );
        assert!((motion.pose.x - 2.0).abs() < 1e-9, "{motion:?}");
        run(&mut follow, &drive(None), &mut motion, 5, Stops::default());
        assert_eq!(motion.twist, Twist2::STOP);
    }

    #[test]
    fn it_stops_before_an_obstacle_at_any_deceleration_and_continues_after_it() {
        for acceleration in [None, Some(1.0), Some(0.05)] {
            let drive = drive(acceleration);
            let (mut follow, mut motion) = (straight(), at(0.0, 0.2));
            follow.blocked = Some(1.0);
            run(&mut follow, &drive, &mut motion, 400, Stops::default());
            let x = motion.pose.x;
            assert!(x < 1.0 && x > 0.98, "{acceleration:?}: {x}");
            assert!(motion.twist.v.abs() < 1e-3, "{acceleration:?}: {motion:?}");
            follow.blocked = None;
            run(&mut follow, &drive, &mut motion, 600, Stops::default());
            assert!((motion.pose.x - 2.0).abs() < 5e-3, "{motion:?}");
        }
    }

    #[test]
    fn a_halt_is_as_short_as_it_can_be() {
        let halt = Stops {
            halt: true,
            ..Stops::default()
        };
        let (mut follow, mut motion) = (straight(), at(0.0, 0.2));
        run(&mut follow, &drive(None), &mut motion, 1, halt);
        assert_eq!((motion.pose.x, motion.twist.v), (0.0, 0.0));
        let (mut follow, mut motion) = (straight(), at(0.0, 0.2));
        let slow = drive(Some(0.5));
        run(&mut follow, &slow, &mut motion, 8, halt);
        assert!(motion.twist.v.abs() < 1e-9 && motion.pose.x < 0.04);
    }

    #[test]
    fn the_reference_waits_for_a_robot_that_lags_behind() {
        // At the robot's minimum speed: no reserve is left to catch up.
        let mut follow = straight();
        let drive = Drive::new(RobotModel {
            v_max: 0.2,
            ..RobotModel::turtlebot3_burger()
        });
        let mut motion = at(-0.05, 0.0);
        run(&mut follow, &drive, &mut motion, 100, Stops::default());
        assert!(follow.error(&motion.pose) < 2e-3, "{motion:?} {follow:?}");
    }
}
