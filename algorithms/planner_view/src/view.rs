//! Input of a planner in one tick.
//!
//! The process that connects a planner to its topics fills a [`View`] from messages. The planner
//! treats every sender as untrusted: look-ups return `Option`, and robots with numbers that are not
//! finite are left out.

use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use robot::team::{Role, Team};

/// One robot, as the world's state reports it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotView {
    /// The robot's index in the scenario.
    pub index: usize,
    /// Team of the robot.
    pub team: Team,
    /// `true` if it still takes part (not caught, not escaped).
    pub active: bool,
    /// `true` if its body is in the world, in play or not.
    pub present: bool,
    /// Pose, world frame.
    pub pose: Pose2,
    /// Twist, own frame.
    pub twist: Twist2,
    /// Radius of its body (m).
    pub radius: f64,
    /// Maximum forward speed (m/s).
    pub v_max: f64,
}

impl RobotView {
    /// Returns `true` if every number a planner computes with is finite and in its physical range.
    #[inline]
    pub fn is_sane(&self) -> bool {
        let Pose2 { x, y, theta } = self.pose;
        let Twist2 { v, omega } = self.twist;
        let (radius, v_max) = (self.radius, self.v_max);
        // Planners ask for each robot many times per tick. Without branches it takes a quarter of the time.
        let numbers = [x, y, theta, v, omega, radius, v_max];
        let are_finite = numbers.iter().fold(true, |all, n| all & n.is_finite());
        are_finite && radius >= 0.0 && v_max >= 0.0
    }
}

/// One hypothesis of an opponent's pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParticleView {
    /// Position along x (m).
    pub x: f32,
    /// Position along y (m).
    pub y: f32,
    /// Heading (rad).
    pub theta: f32,
    /// Weight, ≥ 0; need not be normalised.
    pub weight: f32,
}

impl ParticleView {
    /// The hypothesis as a pose and a weight, if all its numbers are valid (finite, weight > 0).
    pub fn usable(&self) -> Option<(Pose2, f64)> {
        let pose = Pose2::new(f64::from(self.x), f64::from(self.y), f64::from(self.theta));
        let weight = f64::from(self.weight);
        (pose.is_finite() && weight.is_finite() && weight > 0.0).then_some((pose, weight))
    }
}

/// The team's belief about one opponent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeliefView<'a> {
    /// Index of the robot the belief is about.
    pub robot: usize,
    /// The hypotheses.
    pub particles: &'a [ParticleView],
    /// Mean pose of the hypotheses.
    pub mean: Pose2,
    /// Standard deviation of the position around the mean (m).
    pub position_std: f64,
    /// `true` if a robot of the team sees the opponent in this tick.
    pub seen: bool,
}

/// A range scan in the robot's own frame, in the layout of ROS `LaserScan`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanView<'a> {
    /// Direction of the first beam (rad), counter-clockwise from the robot's heading.
    pub angle_min: f64,
    /// Angle from one beam to the next (rad); may be negative.
    pub angle_increment: f64,
    /// Minimum range of the sensor (m).
    pub range_min: f64,
    /// Maximum range of the sensor (m).
    pub range_max: f64,
    /// The ranges (m), beam by beam; +∞ without an echo (REP-117).
    pub ranges: &'a [f32],
}

/// All inputs of a planner in one tick.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Simulated time since the start of the run (s).
    pub time_s: f64,
    /// Time until the next step: a tick, or the `period` of the process (s).
    pub dt: f64,
    /// Index of the planner's own robot.
    pub me: usize,
    /// All robots, in the scenario's order.
    pub robots: &'a [RobotView],
    /// The team's beliefs about its opponents; empty when the team has none.
    pub beliefs: &'a [BeliefView<'a>],
    /// Centres of the exits (m); empty when the arena has none.
    pub exits: &'a [Point2<f64>],
    /// The robot's own range scan of this tick, if it carries a sensor.
    pub scan: Option<ScanView<'a>>,
}

impl<'a> View<'a> {
    /// The robot with this index, if it is listed with sane numbers (the first of several).
    pub fn robot(&self, index: usize) -> Option<&'a RobotView> {
        self.robots
            .iter()
            .find(|robot| robot.index == index)
            .filter(|robot| robot.is_sane())
    }

    /// The planner's own robot.
    pub fn own(&self) -> Option<&'a RobotView> {
        self.robot(self.me)
    }

    /// The robots that still take part and have sane numbers, in the listed order.
    fn active(&self) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        self.robots
            .iter()
            .filter(|robot| robot.active && robot.is_sane())
    }

    /// The team of the planner's own robot, if it is listed.
    fn team(&self) -> Option<Team> {
        let own = self.robots.iter().find(|robot| robot.index == self.me);
        own.map(|own| own.team)
    }

    /// The robots of this role that are hostile to the planner's own robot, in play and with sane numbers, in the
    /// listed order: all of the role if its own team does not have the opposite role.
    pub fn opponents(&self, role: Role) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        let own = self.team();
        self.active()
            .filter(move |robot| is_opponent(own, robot.team, role))
    }

    /// Returns `true` if a robot is one of the [opponents](Self::opponents) of this role, whatever its numbers.
    pub fn is_opponent(&self, robot: &RobotView, role: Role) -> bool {
        robot.active && robot.team.role == role && is_opponent(self.team(), robot.team, role)
    }

    /// The robots of all teams that chase or flee and are no [opponents](Self::opponents) of this role, the planner's own
    /// robot included, in play and with sane numbers, in the listed order.
    pub fn non_opponents(&self, role: Role) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        let own = self.team();
        self.active().filter(move |robot| {
            robot.team.role != Role::Neutral && !is_opponent(own, robot.team, role)
        })
    }

    /// The robots of the planner's own team, itself included, in play and with sane numbers, in the listed order: all
    /// of the role if its own team does not have it.
    pub fn teammates(&self, role: Role) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        let own = self.team().filter(|own| own.role == role);
        self.active().filter(move |robot| {
            robot.team.role == role && own.is_none_or(|own| own.is_same(robot.team))
        })
    }

    /// The bodies of robots that no longer take part but still block the path, with sane numbers.
    pub fn wrecks(&self) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        self.robots
            .iter()
            .filter(|robot| !robot.active && robot.present && robot.is_sane())
    }

    /// All robots whose bodies are in the world, in play or not, with sane numbers.
    pub fn bodies(&self) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        self.robots
            .iter()
            .filter(|robot| robot.present && robot.is_sane())
    }

    /// The [bodies](Self::bodies) of all robots except this one.
    pub fn other_bodies(&self, own: &RobotView) -> impl Iterator<Item = &'a RobotView> + use<'a> {
        let own = own.index;
        self.bodies().filter(move |other| other.index != own)
    }

    /// Returns `true` if `own` cannot stand at a point (m), because another body stands there whose robot does not
    /// count: one that is not expected to drive on.
    pub fn is_covered(
        &self,
        point: Point2<f64>,
        own: &RobotView,
        counts: impl Fn(&RobotView) -> bool,
    ) -> bool {
        let reach = |body: &RobotView| body.radius + own.radius;
        self.other_bodies(own).any(|body| {
            let is_there = (body.pose.position() - point).norm() < reach(body);
            is_there && body.twist == Twist2::STOP && !counts(body)
        })
    }

    /// The team's belief about a robot (the first one in the list).
    pub fn belief(&self, robot: usize) -> Option<&'a BeliefView<'a>> {
        self.beliefs.iter().find(|belief| belief.robot == robot)
    }

    /// The exits whose coordinates are finite (m).
    pub fn usable_exits(&self) -> impl Iterator<Item = Point2<f64>> + Clone + use<'a> {
        self.exits
            .iter()
            .copied()
            .filter(|exit| exit.x.is_finite() && exit.y.is_finite())
    }
}

/// Returns `true` if a team of this role is hostile to the own team, or the own team does not have the opposite role.
fn is_opponent(own: Option<Team>, other: Team, role: Role) -> bool {
    let own = own.filter(|own| own.role.opposite() == Some(role));
    other.role == role && own.is_none_or(|own| own.is_hostile_to(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(index: usize, team: impl Into<Team>, active: bool, x: f64) -> RobotView {
        RobotView {
            index,
            team: team.into(),
            active,
            present: true,
            pose: Pose2 {
                x,
                y: 0.0,
                theta: 0.0,
            },
            twist: Twist2::STOP,
            radius: 0.1,
            v_max: 0.3,
        }
    }

    #[test]
    fn robots_are_found_by_their_index_not_their_place() {
        let robots = [
            robot(7, Role::Pursuer, true, 1.0),
            robot(2, Role::Evader, true, 2.0),
        ];
        let view = View {
            time_s: 0.0,
            dt: 0.05,
            me: 2,
            robots: &robots,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        assert_eq!(view.own().unwrap().pose.x, 2.0);
        assert!(view.robot(0).is_none());
        assert!(view.belief(2).is_none());
    }

    #[test]
    fn invalid_and_retired_robots_are_left_out() {
        let robots = [
            robot(0, Role::Evader, true, f64::NAN),
            robot(1, Role::Evader, false, 1.0),
            robot(2, Role::Evader, true, 2.0),
            robot(3, Role::Pursuer, true, 3.0),
        ];
        let exits = [Point2::new(f64::INFINITY, 0.0), Point2::new(9.0, 0.0)];
        let view = View {
            time_s: 0.0,
            dt: 0.05,
            me: 1,
            robots: &robots,
            beliefs: &[],
            exits: &exits,
            scan: None,
        };
        assert!(view.robot(0).is_none());
        let indices = |robots: Vec<&RobotView>| robots.iter().map(|r| r.index).collect::<Vec<_>>();
        assert_eq!(indices(view.teammates(Role::Evader).collect()), [2]);
        assert_eq!(indices(view.opponents(Role::Pursuer).collect()), [3]);
        assert_eq!(
            view.usable_exits().collect::<Vec<_>>(),
            [Point2::new(9.0, 0.0)]
        );
    }

    #[test]
    fn opponents_are_the_robots_of_hostile_teams() {
        // Two teams of pursuers, of which one is hostile to the evaders; a neutral robot.
        let roles = [
            Role::Pursuer,
            Role::Pursuer,
            Role::Evader,
            Role::Evader,
            Role::Neutral,
        ];
        let teams = Team::of_robots(
            roles.len(),
            |i| roles[i],
            |i, j| i == j || (i.min(j), i.max(j)) == (2, 3),
            |i, j| matches!((i.min(j), i.max(j)), (0, 2 | 3)),
        );
        let robots: Vec<RobotView> = (0..roles.len())
            .map(|i| robot(i, teams[i], true, i as f64))
            .collect();
        for (me, role, opponents, mates, non_opponents) in [
            (0, Role::Pursuer, &[2, 3][..], &[0][..], &[0, 1][..]),
            (1, Role::Pursuer, &[], &[1], &[0, 1, 2, 3]),
            (2, Role::Evader, &[0], &[2, 3], &[1, 2, 3]),
            // In the place of an evader: robots of another role, and one that is not listed.
            (4, Role::Evader, &[0, 1], &[2, 3], &[2, 3]),
            (7, Role::Evader, &[0, 1], &[2, 3], &[2, 3]),
        ] {
            let view = View {
                time_s: 0.0,
                dt: 0.05,
                me,
                robots: &robots,
                beliefs: &[],
                exits: &[],
                scan: None,
            };
            let indices =
                |robots: Vec<&RobotView>| robots.iter().map(|r| r.index).collect::<Vec<_>>();
            let others = role.opposite().unwrap();
            assert_eq!(indices(view.opponents(others).collect()), opponents);
            assert_eq!(indices(view.teammates(role).collect()), mates);
            assert_eq!(indices(view.non_opponents(others).collect()), non_opponents);
            for robot in &robots {
                let is_opponent = opponents.contains(&robot.index);
                assert_eq!(view.is_opponent(robot, others), is_opponent);
            }
        }
    }

    #[test]
    fn a_particle_without_weight_or_with_nan_is_not_usable() {
        let good = ParticleView {
            x: 1.0,
            y: 2.0,
            theta: 0.5,
            weight: 0.1,
        };
        assert!(good.usable().is_some());
        assert!(
            ParticleView {
                weight: 0.0,
                ..good
            }
            .usable()
            .is_none()
        );
        assert!(
            ParticleView {
                theta: f32::NAN,
                ..good
            }
            .usable()
            .is_none()
        );
        assert!(
            ParticleView {
                weight: f32::INFINITY,
                ..good
            }
            .usable()
            .is_none()
        );
    }
}
