//! The content of a picture of a world that is being simulated.

use sim_backend::robot::RobotStatus;
use sim_backend::world::World;

use super::trace::{Mark, MarkKind, RunTrace};
use super::trail::TrailPoint;
use crate::run_model::StaticObstacle;

impl RunTrace {
    /// Shows a world as it is now. `self` is what the same episode showed before, or
    /// [`RunTrace::before_run`] of its scenario; the trails join the moments shown.
    pub fn show(&mut self, world: &World) {
        self.time_s = world.time().as_secs_f64();
        self.end_s = world.rules().time_limit.unwrap_or(self.time_s).max(1e-9);
        for (index, (shown, robot)) in self.robots.iter_mut().zip(world.robots()).enumerate() {
            let (x, y) = (robot.pose.x, robot.pose.y);
            shown.pose = robot.pose;
            shown.trail.push(TrailPoint {
                x,
                y,
                time_s: self.time_s,
            });
            let was_active = core::mem::replace(&mut shown.active, robot.is_active());
            let kind = match robot.status {
                RobotStatus::Caught => MarkKind::Captured,
                RobotStatus::Escaped => MarkKind::Escaped,
                RobotStatus::Arrived => MarkKind::GoalReached,
                RobotStatus::Active | RobotStatus::TimedOut => continue,
            };
            if was_active {
                self.marks.push(Mark {
                    kind,
                    robot: index,
                    at: [x, y],
                    time_s: self.time_s,
                });
            }
        }
        let scene = &mut self.static_scene;
        let now = world.map().obstacles();
        scene.obstacles.retain(|&id, standing| {
            let mut now = now.iter();
            !standing.came && now.any(|o| o.id.0 == id && o.shape == standing.shape)
        });
        for obstacle in now {
            // Obstacles of a map that is drawn as cells are among these.
            if scene.cells.is_none() || obstacle.id.0 >= scene.own {
                let standing = StaticObstacle {
                    shape: obstacle.shape.clone(),
                    came: true,
                };
                scene.obstacles.entry(obstacle.id.0).or_insert(standing);
            }
        }
    }
}
