//! Evaluation of conditions on a robot's progress.

use geometry::math;
use geometry::region::Region;
use nalgebra::Point2;

use super::Robot;
use crate::spec::Condition;

impl Robot {
    /// Returns `true` if a condition holds for the robot in its current state, which started at `start` (m).
    /// A robot without a goal makes no progress.
    pub fn meets(&self, condition: &Condition, start: Point2<f64>) -> bool {
        let at = self.pose.position();
        match *condition {
            Condition::Travelled { travelled } => self.distance_travelled >= travelled,
            Condition::Progress { progress } => self
                .goal
                .as_ref()
                .is_some_and(|goal| share(goal, start, at) >= progress),
            Condition::Within { within, of } => {
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
        // The distance is 0.
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::pose::Pose2;
    use robot::spec::RobotSpec;
    use robot::team::Role;

    fn start() -> Pose2 {
        Pose2::new(1.0, 1.0, 0.0)
    }

    /// A robot that must go from (1, 1) to (5, 1).
    fn robot() -> Robot {
        let mut spec = RobotSpec::new("scout", Role::Neutral, start());
        spec.goal = Some(Region::Circle {
            center: [5.0, 1.0],
            radius: 0.3,
        });
        Robot::new(&spec, Role::Neutral.into())
    }

    fn holds(condition: Condition, robot: &Robot) -> bool {
        robot.meets(&condition, start().position())
    }

    #[test]
    fn travelled_counts_the_path_and_not_the_distance_from_the_start() {
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
    fn a_start_at_the_goal_is_full_progress() {
        let mut robot = robot();
        robot.pose = Pose2::new(5.0, 1.0, 0.0);
        let condition = Condition::Progress { progress: 1.0 };
        assert!(robot.meets(&condition, robot.pose.position()));
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
}
