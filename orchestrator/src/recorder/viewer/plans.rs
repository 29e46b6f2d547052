//! Where the robots mean to go.

use foxglove::messages::{
    Color, LinePrimitive, Point3, SceneEntity, SceneEntityDeletion, SceneUpdate, line_primitive,
    scene_entity_deletion,
};
use ipc_types::messages::robot::PlanPoint;
use ipc_types::messages::world::RobotState;

use super::super::options::RobotInfo;
use super::scene::{entity, pose};
use super::{palette, timestamp};

/// Width of plans [pixels].
const PIXELS: f64 = 2.0;

/// The last plan of every robot.
#[derive(Debug)]
pub(super) struct Plans {
    plans: Vec<Plan>,
}

#[derive(Debug, Clone, Default)]
struct Plan {
    points: Vec<Point3>,
    /// Whether viewers show it.
    shown: bool,
    /// Whether it changed since it was drawn.
    changed: bool,
}

impl Plans {
    pub(super) fn new(robots: usize) -> Self {
        Self {
            plans: vec![Plan::default(); robots],
        }
    }

    /// Replaces the plan of a robot.
    pub(super) fn set(&mut self, robot: usize, points: impl Iterator<Item = PlanPoint>) {
        if let Some(plan) = self.plans.get_mut(robot) {
            plan.points.clear();
            plan.points.extend(points.map(|p| Point3 {
                x: p.x,
                y: p.y,
                z: 0.02,
            }));
            plan.changed = true;
        }
    }

    /// All plans of robots that still play, if any changed since the last picture.
    pub(super) fn draw(
        &mut self,
        robots: &[RobotInfo],
        states: &[RobotState],
        time_ns: u64,
    ) -> Option<SceneUpdate> {
        let mut update = SceneUpdate::default();
        let mut changed = false;
        for state in states {
            let robot = state.robot as usize;
            let (Some(info), Some(plan)) = (robots.get(robot), self.plans.get_mut(robot)) else {
                continue;
            };
            let wanted = state.status == 0 && !plan.points.is_empty();
            let id = format!("plan {}", info.name);
            if wanted {
                update.entities.push(SceneEntity {
                    lines: vec![LinePrimitive {
                        r#type: line_primitive::Type::LineStrip as i32,
                        pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                        thickness: PIXELS,
                        scale_invariant: true,
                        points: plan.points.clone(),
                        color: Some(Color {
                            a: 0.8,
                            ..palette::team(state.team, true)
                        }),
                        ..LinePrimitive::default()
                    }],
                    ..entity(id, time_ns)
                });
            } else if plan.shown {
                update.deletions.push(SceneEntityDeletion {
                    timestamp: Some(timestamp(time_ns)),
                    r#type: scene_entity_deletion::Type::MatchingId as i32,
                    id,
                });
            }
            changed |= plan.changed || wanted != plan.shown;
            plan.shown = wanted;
            plan.changed = false;
        }
        changed.then_some(update)
    }
}
