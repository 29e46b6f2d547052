//! Robots of a team that divide a workplace, as one of them sees them.
//!
//! Each robot computes the same from the positions of all: its team needs no messages of its own. A robot out of play, or
//! one that has stood or driven around on one spot as long as a guard that
//! [counts as failed](patrol::team), has no part until it drives on.

use coverage::decomposition::Place;
use geometry::math::angle_difference;
use geometry::pose::Pose2;
use patrol::team::{LINGERED_S, STOOD_S};
use planner_view::view::{RobotView, View};
use runtime::config::RobotInfo;

/// Radius of a spot, in radii of the robot.
const SPOT: f64 = 4.0;

/// Turn that counts as a motion (rad).
const TURN: f64 = 1.0;

/// A robot of the team.
#[derive(Debug, Clone)]
struct Member {
    robot: usize,
    place: Place,
    takes_part: bool,
    /// Last pose from which it has not moved, last one whose spot it has not left, and their times (s); `None` out of play.
    stays: Option<[(Pose2, f64); 2]>,
}

/// The robots of a team.
#[derive(Debug, Clone, Default)]
pub(crate) struct Team {
    members: Vec<Member>,
    /// Number of the planner's own robot.
    own: usize,
}

impl Team {
    /// The robots that divide a workplace with this one, itself included.
    pub fn new(robots: &[RobotInfo], own: u32) -> Self {
        let companions = robots.get(own as usize).map(|robot| &robot.companions);
        let companions = companions.into_iter().flatten();
        let member = |&robot: &u32| {
            let start = robots.get(robot as usize)?.start.position();
            Some(Member {
                robot: robot as usize,
                place: Place { start, here: start },
                takes_part: true,
                stays: None,
            })
        };
        let members: Vec<Member> = companions.filter_map(member).collect();
        let number = members.iter().position(|m| m.robot == own as usize);
        Self {
            own: number.unwrap_or(0),
            members,
        }
    }

    /// Follows the robots in a tick; returns `true` if the own part changes.
    pub fn observe(&mut self, view: &View<'_>) -> bool {
        let mut changed = false;
        for member in &mut self.members {
            let robot = view.robot(member.robot).filter(|robot| robot.active);
            let took_part = core::mem::replace(&mut member.takes_part, false);
            member.takes_part = member.follow(robot, took_part, view.time_s);
            changed |= member.takes_part != took_part;
        }
        changed && self.members.get(self.own).is_some_and(|m| m.takes_part)
    }

    /// The places of the robots that take part and of the own one, and its number among them.
    pub fn places(&self) -> (Vec<Place>, usize) {
        let all = self.members.iter().enumerate();
        let (numbers, places): (Vec<usize>, Vec<Place>) = all
            .filter(|&(number, member)| member.takes_part || number == self.own)
            .map(|(number, member)| (number, member.place))
            .unzip();
        let own = numbers.iter().position(|&number| number == self.own);
        (places, own.unwrap_or(0))
    }
}

impl Member {
    /// Follows the robot, `None` if it is out of play; returns `true` if it takes part.
    fn follow(&mut self, robot: Option<&RobotView>, took_part: bool, time_s: f64) -> bool {
        let Some(&RobotView {
            pose,
            radius,
            v_max,
            ..
        }) = robot
        else {
            self.stays = None;
            return false;
        };
        self.place.here = pose.position();
        let now = (pose, time_s);
        let [rest, stay] = self.stays.get_or_insert([now; 2]);
        let moved = |from: &Pose2| (pose.position() - from.position()).norm();
        if moved(&stay.0) > SPOT * radius {
            (*rest, *stay) = (now, now);
        } else if moved(&rest.0) > radius || angle_difference(pose.theta, rest.0.theta).abs() > TURN
        {
            *rest = now;
        }
        // Slow robots need longer to leave a spot.
        let least_s = 2.0 * SPOT * radius / v_max;
        let is_moving = time_s - rest.1 < STOOD_S.max(least_s);
        stay.1 >= time_s || (took_part && is_moving && time_s - stay.1 < LINGERED_S.max(least_s))
    }
}
