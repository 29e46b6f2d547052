//! Obstacles that appear and disappear.

use std::collections::BTreeMap;

use foxglove::messages::{
    Color, CubePrimitive, CylinderPrimitive, LinePrimitive, Point3, SceneEntity, SceneUpdate,
    TriangleListPrimitive, Vector3, line_primitive,
};
use geometry::shape::Shape;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::topics::{ObstacleEvents, TopicId};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{deletion, entity, pose};
use super::repetition::Repetition;

/// Codes of `ObstacleEvent::action`.
const DISAPPEAR: u8 = 1;

/// Height of obstacles (m): below plans, so that paths across them are visible.
const HEIGHT: f64 = 0.05;

/// Width of a polygon's outline (pixels).
const OUTLINE_PIXELS: f64 = 3.0;

/// `/viewer/obstacles`, at every change, and repeated.
pub(super) struct ObstaclesTopic {
    channel: ViewerChannel<SceneUpdate>,
    obstacles: Obstacles,
    repetition: Repetition,
}

impl ObstaclesTopic {
    /// Creates the topic; `standing` are the obstacles that exist from the beginning.
    pub(super) fn new(standing: &[ObstacleEvent], picture: &mut Picture) -> Self {
        let mut topic = Self {
            channel: picture.add_channel("/viewer/obstacles"),
            obstacles: Obstacles::default(),
            repetition: Repetition::default(),
        };
        for obstacle in standing {
            topic.obstacles.add_standing(obstacle);
        }
        if !standing.is_empty() {
            topic.draw(0, picture);
        }
        topic
    }

    fn draw(&mut self, time_ns: u64, picture: &mut Picture) {
        let update = self.obstacles.draw(time_ns);
        let bytes = self.channel.write(&mut picture.ready, time_ns, &update);
        self.repetition.drawn(time_ns, bytes);
    }
}

impl Consumer<Picture> for ObstaclesTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::ObstacleEvents]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if let Some((_, events)) = message.view::<ObstacleEvents>() {
            for event in events {
                self.obstacles.apply(&event);
                self.draw(message.time_ns, picture);
            }
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        if self.repetition.is_due(picture.now_ns()) {
            self.draw(picture.now_ns(), picture);
        }
    }
}

/// Current obstacles.
#[derive(Debug, Default)]
struct Obstacles {
    /// Obstacles with their colours, by id.
    standing: BTreeMap<u32, (ObstacleEvent, Color)>,
    gone: Vec<u32>,
}

impl Obstacles {
    /// Adds an obstacle that exists from the beginning.
    fn add_standing(&mut self, obstacle: &ObstacleEvent) {
        let entry = (*obstacle, palette::BUILDING);
        self.standing.insert(obstacle.id, entry);
    }

    /// Applies a change.
    fn apply(&mut self, event: &ObstacleEvent) {
        if event.action == DISAPPEAR {
            self.standing.remove(&event.id);
            self.gone.push(event.id);
        } else {
            self.standing.insert(event.id, (*event, palette::OBSTACLE));
        }
    }

    /// Returns all current obstacles, and deletions of removed ones.
    fn draw(&mut self, time_ns: u64) -> SceneUpdate {
        let id = |id: u32| format!("obstacle {id}");
        let deletions = self
            .gone
            .drain(..)
            .map(|gone| deletion(id(gone), time_ns))
            .collect();
        let entities = self
            .standing
            .iter()
            .map(|(&key, (event, color))| draw(event, *color, entity(id(key), time_ns)))
            .collect();
        SceneUpdate {
            deletions,
            entities,
        }
    }
}

fn draw(event: &ObstacleEvent, color: Color, mut entity: SceneEntity) -> SceneEntity {
    let at = Some(pose(event.x, event.y, HEIGHT / 2.0, event.theta));
    let color = Some(color);
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
            let corners = event.vertices.chunks_exact(2).take(count);
            let vertices: Vec<[f64; 2]> = corners.map(|xy| [xy[0], xy[1]]).collect();
            let points = vertices.iter().map(|&[x, y]| top(x, y)).collect();
            let fill = triangles(vertices);
            if !fill.is_empty() {
                entity.triangles.push(TriangleListPrimitive {
                    pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                    points: fill,
                    color,
                    ..TriangleListPrimitive::default()
                });
            }
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

/// Returns a point at the height of obstacles.
fn top(x: f64, y: f64) -> Point3 {
    Point3 { x, y, z: HEIGHT }
}

/// Triangulates a polygon; returns three points per triangle, none if the polygon is not simple.
fn triangles(vertices: Vec<[f64; 2]>) -> Vec<Point3> {
    let parts = Shape::Polygon { vertices }.parts().unwrap_or_default();
    let mut points = Vec::new();
    for part in parts {
        let corners = part.corners();
        let Some((first, others)) = corners.split_first() else {
            continue;
        };
        // A convex polygon is a fan.
        for pair in others.windows(2) {
            points.extend([first, &pair[0], &pair[1]].map(|p| top(p.x, p.y)));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_filled() {
        // A hook: an L of three unit squares.
        let mut hook = ObstacleEvent {
            shape: 2,
            vertex_count: 6,
            ..ObstacleEvent::default()
        };
        let corners = [0.0, 0.0, 2.0, 0.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, 2.0];
        hook.vertices[..12].copy_from_slice(&corners);
        let mut obstacles = Obstacles::default();
        obstacles.apply(&hook);
        let update = obstacles.draw(0);
        let points = &update.entities[0].triangles[0].points;
        let area: f64 = points
            .chunks_exact(3)
            .map(|t| {
                let (a, b) = (
                    (t[1].x - t[0].x, t[1].y - t[0].y),
                    (t[2].x - t[0].x, t[2].y - t[0].y),
                );
                0.5 * (a.0 * b.1 - a.1 * b.0)
            })
            .sum();
        assert!((area - 3.0).abs() < 1e-9, "{area}");
        assert_eq!(update.entities[0].lines[0].points.len(), 6);
    }

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
            "only existing obstacles"
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
