//! Obstacles that appear and disappear.

use std::collections::BTreeMap;

use geometry::shape::Shape;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::topics::{ObstacleEvents, TopicId};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{add_triangles, kind, marker, picture, pose, width};
use super::repetition::Repetition;
use ros_messages::messages::{ColorRGBA, Marker, MarkerArray, Point, Vector3};

/// Codes of `ObstacleEvent::action`.
const DISAPPEAR: u8 = 1;

/// Height of obstacles (m): below plans, so that paths across them are visible.
const HEIGHT: f64 = 0.05;

/// `/obstacles`, at every change, and repeated.
pub(super) struct ObstaclesTopic {
    channel: ViewerChannel<MarkerArray>,
    obstacles: Obstacles,
    repetition: Repetition,
}

impl ObstaclesTopic {
    /// Creates the topic; `standing` are the obstacles that exist from the beginning.
    pub(super) fn new(standing: &[ObstacleEvent], picture: &mut Picture) -> Self {
        let mut topic = Self {
            channel: picture.add_latched_channel("/obstacles"),
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
        let obstacles = self.obstacles.draw(time_ns, picture.line_width());
        let bytes = self.channel.write(&mut picture.ready, time_ns, &obstacles);
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
    standing: BTreeMap<u32, (ObstacleEvent, ColorRGBA)>,
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
        } else {
            self.standing.insert(event.id, (*event, palette::OBSTACLE));
        }
    }

    /// Returns all current obstacles; `line` is the width of outlines (m).
    fn draw(&self, time_ns: u64, line: f64) -> MarkerArray {
        let mut obstacles = picture(time_ns);
        for (event, color) in self.standing.values() {
            draw(event, color, line, time_ns, &mut obstacles.markers);
        }
        obstacles
    }
}

/// Adds the markers of an obstacle.
fn draw(
    event: &ObstacleEvent,
    color: &ColorRGBA,
    line: f64,
    time_ns: u64,
    markers: &mut Vec<Marker>,
) {
    let new = |kind: i32| marker("obstacle", event.id, kind, color.clone(), time_ns);
    let solid = |kind: i32, x: f64, y: f64| Marker {
        pose: pose(event.x, event.y, HEIGHT / 2.0, event.theta),
        scale: Vector3 { x, y, z: HEIGHT },
        ..new(kind)
    };
    match event.shape {
        0 => markers.push(solid(
            kind::CYLINDER,
            2.0 * event.radius,
            2.0 * event.radius,
        )),
        1 => markers.push(solid(kind::CUBE, 2.0 * event.half_x, 2.0 * event.half_y)),
        _ => {
            let count = (event.vertex_count as usize).min(event.vertices.len() / 2);
            let corners = event.vertices.chunks_exact(2).take(count);
            let vertices: Vec<[f64; 2]> = corners.map(|xy| [xy[0], xy[1]]).collect();
            let mut outline: Vec<Point> = vertices.iter().map(|&[x, y]| top(x, y)).collect();
            outline.extend(outline.first().cloned());
            add_triangles(markers, "fill", color, &triangles(vertices), time_ns);
            markers.push(Marker {
                ns: "outline".to_owned(),
                scale: width(line),
                points: outline,
                ..new(kind::LINE_STRIP)
            });
        }
    }
}

/// Returns a point at the height of obstacles.
fn top(x: f64, y: f64) -> Point {
    Point { x, y, z: HEIGHT }
}

/// Triangulates a polygon; returns three points per triangle, none if the polygon is not simple.
fn triangles(vertices: Vec<[f64; 2]>) -> Vec<Point> {
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
        let drawn = obstacles.draw(0, 0.1);
        let points = &drawn.markers[1].points;
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
        assert_eq!(drawn.markers[2].points.len(), 7, "closed");
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
        let drawn = obstacles.draw(0, 0.1);
        assert_eq!(
            drawn.markers.len(),
            3,
            "a marker that removes all others, and two obstacles"
        );
        assert_eq!(drawn.markers[1].scale.x, 1.0);
        assert_eq!(drawn.markers[2].points.len(), 17, "only existing obstacles");
        obstacles.apply(&ObstacleEvent {
            action: DISAPPEAR,
            ..circle
        });
        let drawn = obstacles.draw(1, 0.1);
        let ids: Vec<i32> = drawn.markers.iter().skip(1).map(|m| m.id).collect();
        assert_eq!(ids, [9]);
    }
}
