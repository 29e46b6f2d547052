//! Captures, exits, goals, time limit: the status of robots, and the end of the game.

use core::time::Duration;

use super::{EventKind, GameOver, World};
use crate::robot::RobotStatus;
use crate::spec::MissionEnd;
use robot::team::Role;

impl World {
    /// Applies the rules to the poses at the end of a step of length `dt`.
    pub(super) fn apply_rules(&mut self, dt: Duration) {
        for i in 0..self.robots.len() {
            if self.robots[i].is_active() && self.robots[i].team.role == Role::Evader {
                self.test_capture(i, dt);
            }
        }
        for i in 0..self.robots.len() {
            if self.robots[i].is_active() {
                self.test_arrival(i);
            }
        }
        if self.over.is_none() {
            self.report_standstills();
            self.test_end();
        }
    }

    fn test_capture(&mut self, evader: usize, dt: Duration) {
        let Some(capture) = self.rules.capture else {
            return;
        };
        let (team, position) = (
            self.robots[evader].team,
            self.robots[evader].pose.position(),
        );
        let mut nearest: Option<(usize, f64)> = None;
        for (i, pursuer) in self.robots.iter().enumerate() {
            if pursuer.team.is_hostile_to(team) && pursuer.is_active() {
                let at = pursuer.pose.position();
                let squared = (at - position).norm_squared();
                if squared < capture.radius * capture.radius
                    && nearest.is_none_or(|(_, least)| squared < least)
                    && (capture.through_walls || self.map.line_of_sight(at, position))
                {
                    nearest = Some((i, squared));
                }
            }
        }
        let held = &mut self.extras[evader].held;
        let Some((by, squared)) = nearest else {
            *held = Duration::ZERO;
            return;
        };
        *held = held.saturating_add(dt);
        if capture.dwell == 0.0 || held.as_secs_f64() >= capture.dwell {
            self.finish(evader, RobotStatus::Caught);
            self.robots[evader].caught_by = Some(by);
            self.emit(EventKind::Captured {
                evader,
                by,
                distance: squared.sqrt(),
            });
        }
    }

    fn test_arrival(&mut self, i: usize) {
        let position = self.robots[i].pose.position();
        if self.robots[i].team.role == Role::Evader
            && let Some(exit) = self.exits.iter().position(|exit| exit.contains(position))
        {
            self.finish(i, RobotStatus::Escaped);
            self.emit(EventKind::Escaped { robot: i, exit });
        } else if self.robots[i]
            .goal
            .is_some_and(|goal| goal.contains(position))
        {
            self.finish(i, RobotStatus::Arrived);
            self.emit(EventKind::Arrived { robot: i });
        }
    }

    fn test_end(&mut self) {
        let contends = |i: usize| {
            let robot = &self.robots[i];
            robot.team.role == Role::Evader || robot.goal.is_some()
        };
        let contenders = (0..self.robots.len()).filter(|&i| contends(i)).count();
        let open = (0..self.robots.len())
            .filter(|&i| contends(i) && self.robots[i].is_active())
            .count();
        let reason = if contenders > 0 && open == 0 && self.rules.end == MissionEnd::Decided {
            GameOver::Decided
        } else if self
            .rules
            .time_limit
            .is_some_and(|limit| self.time.as_secs_f64() >= limit)
        {
            for i in 0..self.robots.len() {
                let robot = &self.robots[i];
                if robot.is_active() && (robot.team.role == Role::Evader || robot.goal.is_some()) {
                    self.finish(i, RobotStatus::TimedOut);
                    self.emit(EventKind::TimedOut { robot: i });
                }
            }
            GameOver::TimeLimit
        } else {
            return;
        };
        self.over = Some(reason);
        self.emit(EventKind::GameOver { reason });
    }

    fn finish(&mut self, i: usize, status: RobotStatus) {
        let robot = &mut self.robots[i];
        robot.status = status;
        robot.finished_at = Some(self.time);
        robot.twist = geometry::pose::Twist2::STOP;
    }
}
