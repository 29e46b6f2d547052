//! What the world knows about a robot.

use core::time::Duration;

use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use serde::{Deserialize, Serialize};

use crate::spec::{RobotModel, RobotSpec};
use crate::team::Team;

/// Whether a robot is in the game.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum RobotStatus {
    /// It drives.
    Active = 0,
    /// An evader that Police caught.
    Caught = 1,
    /// An evader that reached an exit.
    Escaped = 2,
    /// A robot that reached its goal.
    Arrived = 3,
    /// An evader or a robot with a goal that ran out of time.
    TimedOut = 4,
}

impl RobotStatus {
    /// The wire code of the status.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The status with this wire code; `None` for an unknown code.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Active),
            1 => Some(Self::Caught),
            2 => Some(Self::Escaped),
            3 => Some(Self::Arrived),
            4 => Some(Self::TimedOut),
            _ => None,
        }
    }
}

/// How often a robot touched something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactCounts {
    /// Times it came to touch an obstacle (an uninterrupted contact counts once).
    pub wall: u32,
    /// Times it came to touch another robot (an uninterrupted contact counts once).
    pub robot: u32,
    /// Ticks during which it touched an obstacle.
    pub wall_ticks: u64,
    /// Ticks during which it touched a robot.
    pub robot_ticks: u64,
}

impl ContactCounts {
    /// All contacts, each counted once.
    pub const fn episodes(&self) -> u32 {
        self.wall + self.robot
    }
}

/// A robot in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Unique name.
    pub name: String,
    /// The side it plays for.
    pub team: Team,
    /// Body and limits.
    pub model: RobotModel,
    /// Where it shall arrive.
    pub goal: Option<Region>,
    /// Where it is.
    pub pose: Pose2,
    /// How it moved in the last step, averaged over it: forward speed along its heading and
    /// turning rate. A blocked robot has the speed that was left.
    pub twist: Twist2,
    /// Whether it is in the game.
    pub status: RobotStatus,
    /// Whether an obstacle appeared on top of it and no place near was free: it cannot move until
    /// the obstacle goes.
    pub trapped: bool,
    /// Simulated time at which its status changed from active.
    pub finished_at: Option<Duration>,
    /// Index of the robot that caught it.
    pub caught_by: Option<usize>,
    /// Way driven so far (m).
    pub distance_travelled: f64,
    /// Contacts so far.
    pub contacts: ContactCounts,
    /// Whether an obstacle blocked it in the last step, or touches it now.
    pub touches_wall: bool,
    /// Steps in which its command was not a finite number.
    pub invalid_commands: u64,
}

impl Robot {
    /// The robot at rest where its specification puts it.
    pub(crate) fn new(spec: &RobotSpec) -> Self {
        Self {
            name: spec.name.clone(),
            team: spec.team,
            model: spec.model(),
            goal: spec.goal,
            pose: Pose2::new(spec.start.x, spec.start.y, spec.start.theta),
            twist: Twist2::STOP,
            status: RobotStatus::Active,
            trapped: false,
            finished_at: None,
            caught_by: None,
            distance_travelled: 0.0,
            contacts: ContactCounts::default(),
            touches_wall: false,
            invalid_commands: 0,
        }
    }

    /// Whether it is in the game.
    pub fn is_active(&self) -> bool {
        self.status == RobotStatus::Active
    }

    /// Radius of its body (m).
    pub fn radius(&self) -> f64 {
        self.model.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_map_back() {
        for code in 0..=5 {
            let status = RobotStatus::from_code(code);
            assert_eq!(status.is_none(), code == 5);
            assert!(status.is_none_or(|s| s.code() == code));
        }
    }
}
