//! State of a robot in the world.

use core::time::Duration;

use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use serde::{Deserialize, Serialize};

use robot::spec::{RobotModel, RobotSpec};
use robot::team::Team;

/// Status of a robot in the game.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum RobotStatus {
    /// The robot is in the game.
    Active = 0,
    /// An evader that a pursuer caught.
    Caught = 1,
    /// An evader that reached an exit.
    Escaped = 2,
    /// A robot that reached its goal.
    Arrived = 3,
    /// An evader or a robot with a goal that ran out of time.
    TimedOut = 4,
}

impl RobotStatus {
    /// The code of the status in environments; `world/state` has codes of its own.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The status with this code; `None` for an unknown code.
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

/// Numbers of contacts of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactCounts {
    /// Number of contacts with obstacles (an uninterrupted contact counts once).
    pub wall: u32,
    /// Number of contacts with other robots (an uninterrupted contact counts once).
    pub robot: u32,
    /// Number of ticks in contact with an obstacle.
    pub wall_ticks: u64,
    /// Number of ticks in contact with a robot.
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
    /// Team.
    pub team: Team,
    /// Name of its team.
    pub team_name: String,
    /// Body and limits.
    pub model: RobotModel,
    /// Goal.
    pub goal: Option<Region>,
    /// Pose.
    pub pose: Pose2,
    /// Mean twist over the last step: forward speed along its heading and turning rate. A blocked
    /// robot has the remaining speed.
    pub twist: Twist2,
    /// `true` if it is in the game.
    pub status: RobotStatus,
    /// `true` if an obstacle appeared on top of it without a free place nearby: it cannot move
    /// until the obstacle disappears.
    pub trapped: bool,
    /// Simulated time at which its status changed from active.
    pub finished_at: Option<Duration>,
    /// Index of the robot that caught it.
    pub caught_by: Option<usize>,
    /// Distance driven so far (m).
    pub distance_travelled: f64,
    /// Contacts so far.
    pub contacts: ContactCounts,
    /// `true` if an obstacle blocked it in the last step, or touches it now.
    pub touches_wall: bool,
    /// Number of steps with a command that was not finite.
    pub invalid_commands: u64,
}

impl Robot {
    /// Creates the robot at rest at its specified start.
    pub(crate) fn new(spec: &RobotSpec, team: Team) -> Self {
        Self {
            name: spec.name.clone(),
            team,
            team_name: spec.team.clone(),
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

    /// Returns `true` if it is in the game.
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
