//! Obstacles that come and go.

use std::collections::BTreeMap;

use foxglove::messages::{
    CubePrimitive, CylinderPrimitive, LinePrimitive, Point3, SceneEntity, SceneEntityDeletion,
    SceneUpdate, Vector3, line_primitive, scene_entity_deletion,
};
use ipc_types::messages::world::ObstacleEvent;

use super::scene::{entity, pose};
use super::{palette, timestamp};

/// Codes of `ObstacleEvent::action`.
const DISAPPEAR: u8 = 1;

/// How high obstacles are drawn [m].
const HEIGHT: f64 = 0.3;

/// Width of a polygon's outline [pixels].
const OUTLINE_PIXELS: f64 = 3.0;

/// The obstacles that stand now.
#[derive(Debug, Default)]
pub(super) struct Obstacles {
    standing: BTreeMap<u32, ObstacleEvent>,
    gone: Vec<u32>,
}

impl Obstacles {
    /// Takes up a change.
    pub(super) fn apply(&mut self, event: &ObstacleEvent) {
        if event.action == DISAPPEAR {
            self.standing.remove(&event.id);
            self.gone.push(event.id);
        } else {
            self.standing.insert(event.id, *event);
        }
    }

    /// All obstacles that stand, and the deletion of those that have gone.
    pub(super) fn draw(&mut self, time_ns: u64) -> SceneUpdate {
        let id = |id: u32| format!("obstacle {id}");
        let deletions = self
            .gone
            .drain(..)
            .map(|gone| SceneEntityDeletion {
                timestamp: Some(timestamp(time_ns)),
                r#type: scene_entity_deletion::Type::MatchingId as i32,
                id: id(gone),
            })
            .collect();
        let entities = self
            .standing
            .iter()
            .map(|(&key, event)| draw(event, entity(id(key), time_ns)))
            .collect();
        SceneUpdate {
            deletions,
            entities,
        }
    }
}

fn draw(event: &ObstacleEvent, mut entity: SceneEntity) -> SceneEntity {
    let at = Some(pose(event.x, event.y, HEIGHT / 2.0, event.theta));
    let color = Some(palette::OBSTACLE);
    match event.shape {
        0 => entity.cylinders.push(CylinderPrimitive {
            pose: at,
            size: Some(Vector3 {
                x: 2.0 * event.radius,
                y: 2.0 * event.radius,
                z: HEIGHT,
            }),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color,
        }),
        1 => entity.cubes.push(CubePrimitive {
            pose: at,
            size: Some(Vector3 {
                x: 2.0 * event.half_x,
                y: 2.0 * event.half_y,
                z: HEIGHT,
            }),
            color,
        }),
        _ => {
            let count = (event.vertex_count as usize).min(event.vertices.len() / 2);
            let points = event
                .vertices
                .chunks_exact(2)
                .take(count)
                .map(|xy| Point3 {
                    x: xy[0],
                    y: xy[1],
                    z: HEIGHT,
                })
                .collect();
            entity.lines.push(LinePrimitive {
                r#type: line_primitive::Type::LineLoop as i32,
                pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                thickness: OUTLINE_PIXELS,
                scale_invariant: true,
                points,
                color,
                ..LinePrimitive::default()
            });
        }
    }
    entity
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstacles_are_drawn_until_they_disappear() {
        let mut obstacles = Obstacles::default();
        let circle = ObstacleEvent {
            id: 4,
            radius: 0.5,
            ..ObstacleEvent::default()
        };
        let polygon = ObstacleEvent {
            id: 9,
            shape: 2,
            vertex_count: 99,
            ..ObstacleEvent::default()
        };
        obstacles.apply(&circle);
        obstacles.apply(&polygon);
        let update = obstacles.draw(0);
        assert_eq!(update.entities.len(), 2);
        assert_eq!(update.entities[0].cylinders[0].size.unwrap().x, 1.0);
        assert_eq!(
            update.entities[1].lines[0].points.len(),
            16,
            "no more than there are"
        );
        obstacles.apply(&ObstacleEvent {
            action: DISAPPEAR,
            ..circle
        });
        let update = obstacles.draw(1);
        assert_eq!(update.deletions[0].id, "obstacle 4");
        assert_eq!(update.entities.len(), 1);
        assert!(obstacles.draw(2).deletions.is_empty());
    }
}
