//! Robots of a team that divide a workplace, as one of them sees them.
//!
//! Each robot computes the same from the positions of all: its team needs no messages of its own. A robot out of play, or
//! one that [does not get on](planner_view::stay), has no part until it drives on.

use coverage::decomposition::Place;
use planner_view::stay::{LINGERED_S, STOOD_S, Stay};
use planner_view::view::{RobotView, View};
use runtime::config::RobotInfo;

/// Radius of a spot, in radii of the robot.
const SPOT: f64 = 4.0;

/// A robot of the team.
#[derive(Debug, Clone)]
struct Member {
    robot: usize,
    place: Place,
    takes_part: bool,
    stay: Stay,
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
                stay: Stay::default(),
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
            member.takes_part = member.follow(robot, view.time_s);
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
    fn follow(&mut self, robot: Option<&RobotView>, time_s: f64) -> bool {
        let Some(robot) = robot else {
            self.stay = Stay::default();
            return false;
        };
        self.place.here = robot.pose.position();
        // Slow robots need not get as far in the same time.
        let reach = [(1.0, STOOD_S), (SPOT, LINGERED_S)]
            .map(|(radii, stay_s)| (radii * robot.radius).min(0.5 * robot.v_max * stay_s));
        !self.stay.is_lost(self.place.here, time_s, reach, false)
    }
}

#[cfg(test)]
mod tests {
    use geometry::pose::{Pose2, Twist2};
    use robot::team::Role;

    use super::*;

    /// A robot that is seen at a place, at a speed limit of 0.5 m/s.
    fn seen(x: f64, theta: f64) -> RobotView {
        RobotView {
            index: 0,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose: Pose2::new(x, 0.0, theta),
            twist: Twist2::STOP,
            radius: 0.1,
            v_max: 0.5,
        }
    }

    /// The times (s) at which a robot that is at `pose(time)` begins to take part and ceases to.
    fn changes(pose: impl Fn(f64) -> Option<RobotView>) -> Vec<(f64, bool)> {
        let start = nalgebra::Point2::origin();
        let mut member = Member {
            robot: 0,
            place: Place { start, here: start },
            takes_part: true,
            stay: Stay::default(),
        };
        let mut found = Vec::new();
        for step in 0..200 {
            let time_s = 0.5 * f64::from(step);
            let took_part = member.takes_part;
            member.takes_part = member.follow(pose(time_s).as_ref(), time_s);
            if member.takes_part != took_part {
                found.push((time_s, member.takes_part));
            }
        }
        found
    }

    #[test]
    fn a_robot_that_stands_or_stays_on_one_spot_has_no_part_until_it_drives_on() {
        let drives = |t: f64| Some(seen(0.2 * t, 0.0));
        assert_eq!(changes(drives), []);
        let stands = |t: f64| Some(seen(0.2 * t.min(20.0) + 0.2 * (t - 50.0).max(0.0), 0.0));
        let [(lost_s, false), (back_s, true)] = changes(stands)[..] else {
            panic!("{:?}", changes(stands));
        };
        assert!((lost_s - 20.0 - STOOD_S).abs() < 1.0, "{lost_s} s");
        assert!((50.0..53.0).contains(&back_s), "{back_s} s");
        let spins = |t: f64| Some(seen(0.0, t));
        assert_eq!(changes(spins), [(STOOD_S, false)]);
        let circles = |t: f64| Some(seen(0.15 * geometry::math::sincos(t).0, 0.0));
        assert_eq!(changes(circles).len(), 1);
        let leaves = |t: f64| Some(seen(0.2 * t, 0.0)).filter(|_| !(10.0..20.0).contains(&t));
        assert_eq!(changes(leaves), [(10.0, false), (20.0, true)]);
    }

    #[test]
    fn slow_robots_have_time_to_leave_a_spot() {
        let slow = |t: f64| {
            Some(RobotView {
                v_max: 0.01,
                ..seen(0.006 * t, 0.0)
            })
        };
        assert_eq!(changes(slow), []);
    }
}
