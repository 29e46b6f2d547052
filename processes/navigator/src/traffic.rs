//! Collision avoidance between robots, without messages.
//!
//! All robots decide at the same moment, from the same earlier state. A robot therefore drives only
//! where it could still stop before any place that another can reach meanwhile. If both do so, they
//! do not collide. The robot with the higher index keeps more distance: it stops first and leaves
//! the other the room to pass.

use nalgebra::Point2;
use passing::Spacing;
use planner_view::view::View;
use robot::spec::RobotModel;

use crate::drive::Drive;
use crate::follow::STANDING;
use crate::trajectory::Trajectory;

/// Additional distance at which a robot stops for one with a lower index (m).
const YIELD_DISTANCE: f64 = 0.1;
/// Distance kept beyond the range that the others can reach (m).
const GAP: f64 = 0.01;
/// Further approach allowed to a robot that is too near already (m): the tracking error.
const SLACK: f64 = 3e-3;
/// Further approach that counts as none (m): the rounding of plans along the border of a robot's disc.
const ROUNDING: f64 = 2e-4;
/// Additional clearance to other robots in plans (m), so that the plan can be driven.
const EASE: f64 = 0.01;
/// Distance of two places where robots stand, in distances of robots that pass each other: a robot on the way from one
/// corner of an equilateral triangle to another passes the third.
const TRIANGLE: f64 = 1.16;
/// Standstill after which a robot counts as an obstacle (s).
const PARKED_S: f64 = 1.0;

/// Another robot, as of this tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Other {
    /// Its index.
    pub index: usize,
    /// Its position (m).
    pub at: Point2<f64>,
    /// Its radius (m).
    pub radius: f64,
    /// Required distance between the two centres (m).
    required: f64,
    /// Required distance if they are too near already (m).
    least: f64,
    /// `true` if it will not move soon.
    pub parked: bool,
}

impl Other {
    /// Returns the radius (m) of the disc that represents it in a plan of a robot with this
    /// `clearance` (m), start and goal.
    pub fn planned_radius(&self, clearance: f64, start: Point2<f64>, goal: Point2<f64>) -> f64 {
        let wanted = (self.required + EASE - clearance).max(self.radius);
        // Both ends of the path must be possible.
        let room = |p: Point2<f64>| (p - self.at).norm() - clearance - 1e-6;
        wanted.min(room(start)).min(room(goal))
    }
}

/// Returns the distances that robots of these models keep when they pass each other at rest.
pub fn spacing<'a>(models: impl Iterator<Item = &'a RobotModel>, margin: f64, dt: f64) -> Spacing {
    let (radius, reach) = models.fold((0.0f64, 0.0f64), |(radius, reach), model| {
        let at_rest = Drive::new(*model).reach(0.0, dt);
        (radius.max(model.radius), reach.max(at_rest))
    });
    let apart = 2.0 * radius + reach + GAP + EASE;
    Spacing {
        clearance: radius + margin,
        apart,
        places: TRIANGLE * apart,
    }
}

/// The other robots, and the start of the standstill of each robot.
#[derive(Debug, Clone, Default)]
pub struct Traffic {
    others: Vec<Other>,
    /// Start of the standstill of each robot, by index (s).
    standing: Vec<Option<f64>>,
}

impl Traffic {
    /// Updates the distances to the other robots.
    pub fn update(&mut self, view: &View<'_>, own: &RobotModel, models: &[RobotModel]) {
        self.others.clear();
        self.standing.resize(view.robots.len(), None);
        for other in view.bodies() {
            let speed = other.twist.v.abs();
            let stands = !other.active || speed < STANDING && other.twist.omega == 0.0;
            let Some(since) = self.standing.get_mut(other.index) else {
                continue;
            };
            *since = stands.then(|| since.unwrap_or(view.time_s));
            if other.index == view.me {
                continue;
            }
            let parked =
                !other.active || since.is_some_and(|since| view.time_s - since >= PARKED_S);
            let reach = match models.get(other.index) {
                Some(model) if other.active => Drive::new(*model).reach(speed, view.dt),
                _ => 0.0,
            };
            let touch = own.radius + other.radius;
            // A robot that is parked leaves the room on purpose, or does not go on.
            let yields = if !parked && other.index < view.me {
                YIELD_DISTANCE
            } else {
                0.0
            };
            self.others.push(Other {
                index: other.index,
                at: other.pose.position(),
                radius: other.radius,
                required: touch + reach + GAP + yields,
                least: touch + reach + 0.5 * GAP,
                parked,
            });
        }
    }

    /// The other robots.
    pub fn others(&self) -> &[Other] {
        &self.others
    }

    /// Returns the time for which a robot has stood (s).
    pub fn stood(&self, index: usize, time_s: f64) -> f64 {
        let since = self.standing.get(index).copied().flatten();
        since.map_or(0.0, |since| time_s - since)
    }

    /// Returns the distance (m) along a path that a robot may drive from the time `from` (s) on,
    /// and the blocking robot; searches the next `ahead` (m).
    pub fn stop(&self, path: &Trajectory, from: f64, ahead: f64) -> Option<(f64, usize)> {
        let start = path.along(from);
        let here = path.at(from).0.position();
        let near: Vec<(&Other, f64)> = self
            .others
            .iter()
            .map(|other| (other, (other.at - here).norm()))
            .filter(|(other, distance)| *distance <= other.required + ahead)
            .collect();
        if near.is_empty() {
            return None;
        }
        let mut allowed = start;
        for (t, place) in path.pieces(from).skip(1) {
            let along = path.along(t);
            for (other, before) in &near {
                let distance = (place - other.at).norm();
                let drawing_near = distance < before - SLACK;
                let too_near = distance < other.required && drawing_near;
                let far_too_near = distance < other.least && distance < before - ROUNDING;
                if too_near || far_too_near {
                    return Some((allowed, other.index));
                }
            }
            allowed = along;
            if along > start + ahead {
                break;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use geometry::pose::{Pose2, Twist2};
    use planner_view::view::RobotView;
    use robot::team::Role;

    use super::*;
    use crate::trajectory::Sample;

    fn robot(index: usize, x: f64, v: f64) -> RobotView {
        RobotView {
            index,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose: Pose2::new(x, 0.0, 0.0),
            twist: Twist2::new(v, 0.0),
            radius: 0.1,
            v_max: 0.2,
        }
    }

    fn looks(me: usize, robots: &[RobotView], time_s: f64, traffic: &mut Traffic) {
        let model = RobotModel {
            radius: 0.1,
            v_max: 0.2,
            v_reverse_max: 0.2,
            ..RobotModel::turtlebot3_burger()
        };
        let view = View {
            time_s,
            dt: 0.05,
            me,
            robots,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        traffic.update(&view, &model, &[model; 3]);
    }

    /// Straight along x at 0.2 m/s.
    fn along_x() -> Trajectory {
        let sample = |t: f64| Sample {
            t,
            pose: Pose2::new(0.2 * t, 0.0, 0.0),
            twist: Twist2::new(0.2, 0.0),
        };
        Trajectory::new(vec![sample(0.0), sample(20.0)]).unwrap()
    }

    #[test]
    fn it_stops_before_what_the_other_can_reach_and_the_higher_index_first() {
        let robots = [robot(0, 0.0, 0.2), robot(1, 1.0, 0.0)];
        let path = along_x();
        let mut traffic = Traffic::default();
        looks(0, &robots, 0.0, &mut traffic);
        assert_eq!(traffic.stop(&path, 0.0, 0.1), None);
        // 1 m − two radii − 1 cm of reach − 1 cm.
        let (stop, who) = traffic.stop(&path, 0.0, 2.0).unwrap();
        assert!((stop - 0.78).abs() < 0.011 && who == 1, "{stop}");
        let swapped = [robot(0, 1.0, 0.0), robot(1, 0.0, 0.2)];
        looks(1, &swapped, 0.0, &mut traffic);
        let (stop, _) = traffic.stop(&path, 0.0, 2.0).unwrap();
        assert!((stop - 0.68).abs() < 0.011, "{stop}");
    }

    #[test]
    fn it_may_drive_away_from_a_robot_that_is_too_near() {
        let mut traffic = Traffic::default();
        looks(
            1,
            &[robot(0, -0.21, 0.0), robot(1, 0.0, 0.0)],
            0.0,
            &mut traffic,
        );
        assert_eq!(traffic.stop(&along_x(), 0.0, 2.0), None);
        looks(
            1,
            &[robot(0, 0.21, 0.0), robot(1, 0.0, 0.0)],
            0.0,
            &mut traffic,
        );
        assert_eq!(traffic.stop(&along_x(), 0.0, 2.0), Some((0.0, 0)));
    }

    #[test]
    fn a_path_along_the_border_of_a_robot_that_is_too_near_may_be_driven() {
        let mut traffic = Traffic::default();
        let mut robots = [robot(0, 0.006, 0.0), robot(1, 0.0, 0.0)];
        robots[0].pose.y = 0.21;
        looks(1, &robots, 0.0, &mut traffic);
        // The path leads 0.05 mm nearer before it leads away.
        assert_eq!(traffic.stop(&along_x(), 0.0, 2.0), None);
    }

    #[test]
    fn a_robot_that_stands_for_a_while_is_parked() {
        let mut traffic = Traffic::default();
        let mut parked = |time_s: f64, v: f64| {
            looks(
                0,
                &[robot(0, 0.0, 0.0), robot(1, 1.0, v)],
                time_s,
                &mut traffic,
            );
            traffic.others()[0].parked
        };
        assert!(!parked(0.0, 0.0));
        assert!(!parked(0.9, 0.0));
        assert!(parked(1.0, 0.0));
        assert!(!parked(1.1, 0.1));
        assert!(!parked(2.0, 0.0));
    }
}
