//! Following a trajectory no faster than it is safe.
//!
//! The reference moves along the trajectory at the rate r ∈ [0, 1]: its path is that of the
//! trajectory, its speed may be less. r is below 1 where the robot lags behind and could not catch
//! up with a reference at full speed, where it must brake to stop before an obstacle, and while it
//! gathers speed again.

use geometry::pose::{Pose2, Twist2};
use steering::go_to::coast;

use crate::drive::Drive;
use crate::tracking::{self, K_X};
use crate::trajectory::Trajectory;

/// Halvings with which a rate is found.
const HALVINGS: u32 = 30;
/// Speeds below this (m/s) are none.
pub const STANDING: f64 = 1e-6;
/// How far before a place where it must stop the robot stops (m).
const BEFORE: f64 = 1e-3;
/// Distance (m) from a standing reference below which it is left at that.
const THERE: f64 = 2e-3;

/// A trajectory that is being followed.
#[derive(Debug, Clone)]
pub struct Follow {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// How far the reference is on it (s).
    pub tau: f64,
    /// Distance that the robot's centre must keep from obstacles on it (m).
    pub clearance: f64,
    /// How far along it (m) the robot can go before something is in the way.
    pub blocked: Option<f64>,
    /// Whether there is no room for tracking errors: ticks then end where speeds step, so that no
    /// command is the mean of a turn on the spot and a straight way.
    pub careful: bool,
}

/// What of a robot changes while it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Where it is.
    pub pose: Pose2,
    /// What it does.
    pub twist: Twist2,
}

/// What limits the way in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stops {
    /// Whether the robot shall stop as soon as it can.
    pub halt: bool,
    /// How far along the path (m) it may go because of other robots.
    pub traffic: Option<f64>,
}

/// A tick's command, and how far the reference moves.
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

    /// Distance of the robot from where it should be (m).
    pub fn error(&self, pose: &Pose2) -> f64 {
        (self.reference().position() - pose.position()).norm()
    }

    /// What the robot does during the next `dt` (s).
    pub fn pace(&self, drive: &Drive, motion: &Motion, stops: &Stops, dt: f64) -> Pace {
        let rate = self.rate(drive, motion, stops, dt);
        let (from, to) = (self.tau, self.tau + rate * dt);
        let (a, b) = (self.trajectory.at(from).0, self.trajectory.at(to).0);
        let way = self.trajectory.along(to) - self.trajectory.along(from);
        // Exact for the tick: the command holds for all of it.
        let reference = Twist2::new(way / dt, (b.theta - a.theta) / dt);
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

    /// The motion after a tick at this pace, and the reference moved along.
    pub fn advance(&mut self, drive: &Drive, motion: &mut Motion, pace: &Pace, dt: f64) {
        let twist = drive.execute(motion.twist, pace.command, dt);
        motion.pose = coast(&motion.pose, twist, dt);
        motion.twist = twist;
        self.tau += pace.rate * dt;
    }

    /// What is left to a reference that stands, at the end or because it waits.
    fn settle(&self, pose: &Pose2) -> Twist2 {
        let error = tracking::error(pose, &self.reference());
        let v = if error.x.abs() > THERE {
            K_X * error.x
        } else {
            0.0
        };
        Twist2::new(v, 0.0)
    }

    /// How far (m) along the path the reference may still go; `None` if to the end.
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
        let now = motion.twist;
        let mut high = 1.0f64;
        // It cannot be faster than its drive makes it.
        if let Some(a) = model.acceleration {
            high = high.min(largest(|r| speed(r) <= now.v + a * dt * (1.0 + 1e-9)));
        }
        if let Some(a) = model.angular_acceleration {
            let most = now.omega.abs() + a * dt * (1.0 + 1e-9);
            high = high.min(largest(|r| turn(r) <= most));
        }
        // The reference waits for a robot that lags behind: it leaves it the speed to catch up.
        let lag = tracking::error(&motion.pose, &self.reference()).x;
        if lag > 0.0 {
            let left = (drive.top_speed() - K_X * lag).max(0.0);
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
        // Nor slower than its drive can brake.
        if let Some(a) = model.acceleration {
            let least = now.v - a * dt;
            if least > 0.0 {
                high = high.max(1.0 - largest(|s| speed(1.0 - s) >= least));
            }
        }
        high
    }
}

/// The largest rate in [0, 1] up to which something holds that holds up to some rate; 0 if it never
/// does.
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

/// The motion after a tick of stopping.
pub fn stop(drive: &Drive, motion: &mut Motion, dt: f64) {
    let twist = drive.execute(motion.twist, Twist2::STOP, dt);
    motion.pose = coast(&motion.pose, twist, dt);
    motion.twist = twist;
}

#[cfg(test)]
mod tests {
    use sim_backend::spec::RobotModel;

    use super::*;
    use crate::trajectory::Sample;

    const DT: f64 = 0.05;

    fn drive(acceleration: Option<f64>) -> Drive {
        Drive::new(RobotModel {
            acceleration,
            ..RobotModel::turtlebot3_burger()
        })
    }

    /// 2 m straight ahead in 14 s, the last 8 s of them ever slower.
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
    fn it_stops_before_what_is_in_the_way_at_any_deceleration_and_goes_on_after() {
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
    fn the_reference_waits_for_who_lags_behind() {
        // As slow as the robot gets: no speed is left to catch up with.
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
