//! How far a robot must have come for something to happen.

use nalgebra::Point2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Region, coordinate, non_negative, positive};
use crate::math;
use crate::params::{ParamsError, require};
use crate::robot::Robot;

/// What must be true of a robot.
///
/// In TOML the keys of one variant: `{ travelled = 1.5 }`, `{ progress = 0.36 }` or
/// `{ within = 0.8, of = [2.0, 3.0] }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub enum Condition {
    /// Its centre has covered a way.
    Travelled {
        /// Length of the way (m), ≥ 0.
        travelled: f64,
    },
    /// It has come nearer to its goal.
    Progress {
        /// Share of the straight distance from its start to the centre of its goal, 0..1.
        progress: f64,
    },
    /// Its centre is near a point.
    Within {
        /// Largest distance (m), > 0.
        within: f64,
        /// The point, x and y (m).
        of: [f64; 2],
    },
}

impl Condition {
    /// Checks every value.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        match *self {
            Self::Travelled { travelled } => non_negative("travelled", travelled, "m"),
            Self::Progress { progress } => require(
                (0.0..=1.0).contains(&progress),
                "progress",
                &progress,
                "a share from 0 to 1",
            ),
            Self::Within { within, of } => {
                positive("within", within, "m")?;
                coordinate("of[0]", of[0])?;
                coordinate("of[1]", of[1])
            }
        }
    }

    /// Whether it is true of a robot, as it is now, that started at `start` (m). A robot without a
    /// goal makes no progress.
    pub fn holds(&self, robot: &Robot, start: Point2<f64>) -> bool {
        let at = robot.pose.position();
        match *self {
            Self::Travelled { travelled } => robot.distance_travelled >= travelled,
            Self::Progress { progress } => robot
                .goal
                .as_ref()
                .is_some_and(|goal| share(goal, start, at) >= progress),
            Self::Within { within, of } => {
                let (dx, dy) = (at.x - of[0], at.y - of[1]);
                dx * dx + dy * dy <= within * within
            }
        }
    }
}

/// Share of the straight distance from `start` to the goal's centre by which `at` is nearer to it:
/// 0 at the start, 1 at the centre, negative farther away than the start.
fn share(goal: &Region, start: Point2<f64>, at: Point2<f64>) -> f64 {
    let center = goal.center();
    let far = |p: Point2<f64>| math::hypot(p.x - center.x, p.y - center.y);
    let whole = far(start);
    if whole > 0.0 {
        1.0 - far(at) / whole
    } else {
        // There is no way to go.
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Pose2;
    use crate::spec::RobotSpec;
    use crate::team::Team;

    fn start() -> Pose2 {
        Pose2::new(1.0, 1.0, 0.0)
    }

    /// A robot that shall go from (1, 1) to (5, 1).
    fn robot() -> Robot {
        let mut spec = RobotSpec::new("scout", Team::Neutral, start());
        spec.goal = Some(Region::Circle {
            center: [5.0, 1.0],
            radius: 0.3,
        });
        Robot::new(&spec)
    }

    fn holds(condition: Condition, robot: &Robot) -> bool {
        condition.holds(robot, start().position())
    }

    #[test]
    fn travelled_counts_the_way_and_not_the_distance_from_the_start() {
        let mut robot = robot();
        let condition = Condition::Travelled { travelled: 1.5 };
        robot.distance_travelled = 1.499;
        assert!(!holds(condition, &robot));
        robot.distance_travelled = 1.5;
        assert!(holds(condition, &robot), "although it stands at its start");
        assert!(holds(Condition::Travelled { travelled: 0.0 }, &robot));
    }

    #[test]
    fn progress_is_the_share_of_the_straight_distance_to_the_goal() {
        let mut robot = robot();
        let condition = Condition::Progress { progress: 0.5 };
        robot.pose.x = 2.99;
        robot.distance_travelled = 100.0;
        assert!(!holds(condition, &robot), "whatever it has travelled");
        robot.pose.x = 3.0;
        assert!(holds(condition, &robot));
        // Beside the goal, as far from its centre.
        robot.pose = Pose2::new(5.0, 3.0, 0.0);
        assert!(holds(condition, &robot));
        robot.pose = Pose2::new(0.0, 1.0, 0.0);
        assert!(!holds(Condition::Progress { progress: 0.0 }, &robot));
        robot.goal = None;
        assert!(!holds(Condition::Progress { progress: 0.0 }, &robot));
    }

    #[test]
    fn who_starts_at_the_goal_has_made_all_progress() {
        let mut robot = robot();
        robot.pose = Pose2::new(5.0, 1.0, 0.0);
        let condition = Condition::Progress { progress: 1.0 };
        assert!(condition.holds(&robot, robot.pose.position()));
    }

    #[test]
    fn within_includes_its_border() {
        let mut robot = robot();
        let condition = Condition::Within {
            within: 0.5,
            of: [2.0, 1.0],
        };
        assert!(!holds(condition, &robot));
        robot.pose.x = 1.5;
        assert!(holds(condition, &robot));
        robot.pose.y = 1.001;
        assert!(!holds(condition, &robot));
    }

    #[test]
    fn values_out_of_range_are_named() {
        let of = [0.0; 2];
        for (condition, named) in [
            (
                Condition::Travelled { travelled: -1.0 },
                "`travelled` is -1",
            ),
            (
                Condition::Travelled {
                    travelled: f64::NAN,
                },
                "`travelled` is NaN",
            ),
            (Condition::Progress { progress: 36.0 }, "`progress` is 36"),
            (Condition::Within { within: 0.0, of }, "`within` is 0"),
            (
                Condition::Within {
                    within: 1.0,
                    of: [0.0, 1e9],
                },
                "`of[1]` is 1000000000",
            ),
        ] {
            let error = condition.validate().unwrap_err().to_string();
            assert!(error.starts_with(named), "{error}");
        }
        assert!(Condition::Progress { progress: 1.0 }.validate().is_ok());
    }
}
