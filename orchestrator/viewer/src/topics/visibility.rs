//! Visible areas of the fields of view, as polygons.
//!
//! The recorder computes them from the map and the poses of the robots; processes do not send them, so that
//! the run does not depend on them.

use foxglove::messages::{
    Color, LinePrimitive, Point3, SceneEntity, SceneUpdate, TriangleListPrimitive, line_primitive,
};
use geometry::grid::{Grid, GridFrame};
use geometry::pose::Pose2;
use geometry::visibility::polygon::{Viewpoint, Walls};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader, RobotState};
use ipc_types::topics::{TopicId, WorldMap};
use nalgebra::Point2;
use sim_backend::team::Team;

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{deletion, entity, pose};
use super::{grid, palette};
use crate::field_of_view::{FieldOfView, ViewOrigin};

/// Minimum time between two pictures (simulated ns): polygons are large, and robots slow.
const PERIOD_NS: u64 = 200_000_000;
/// Height of the polygons (m): above the map and trails, below obstacles.
const HEIGHT: f64 = 0.02;
/// Width of the border (pixels).
const PIXELS: f64 = 1.0;
/// Resolution of corners (1/m): a power of two, so that most bits of a coordinate are 0 and compress well.
const PARTS_OF_A_METRE: f64 = 1024.0;

/// `/viewer/visibility`.
pub(super) struct VisibilityTopic {
    channel: ViewerChannel<SceneUpdate>,
    visibility: Visibility,
}

impl VisibilityTopic {
    pub(super) fn new(fields_of_view: &[FieldOfView], picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/viewer/visibility"),
            visibility: Visibility::new(fields_of_view.to_vec()),
        }
    }
}

impl Consumer<Picture> for VisibilityTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldMap]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, _: &mut Picture) {
        if let Some((header, cells)) = message.view::<WorldMap>()
            && grid::fits(header.width, header.height, cells.len())
        {
            self.visibility.map(&header, cells);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        let (time_ns, states) = (picture.now_ns(), &picture.states);
        if let Some(update) = self.visibility.draw(states, time_ns, picture.wanted) {
            self.channel.write(&mut picture.ready, time_ns, &update);
        }
    }
}

/// Fields of view and their walls.
#[derive(Debug)]
struct Visibility {
    fields: Vec<DrawnField>,
    walls: Option<Walls>,
    due_ns: u64,
}

#[derive(Debug)]
struct DrawnField {
    field: FieldOfView,
    /// `true` if viewers show its polygon.
    shown: bool,
    /// Last viewpoint and visible area, reused for fixed points and waiting robots.
    last: Option<(Viewpoint, Vec<Point2<f64>>)>,
}

impl DrawnField {
    fn new(field: FieldOfView) -> Self {
        Self {
            field,
            shown: false,
            last: None,
        }
    }

    /// Returns the border of the visible area of a pose.
    fn seen(&mut self, at: Pose2, walls: &Walls) -> &[Point2<f64>] {
        let viewpoint = Viewpoint {
            position: at.position(),
            heading: at.theta,
            limits: self.field.limits(),
        };
        let last = self.last.take().filter(|(from, _)| *from == viewpoint);
        let seen = last.map_or_else(|| walls.seen_from(&viewpoint), |(_, seen)| seen);
        &self.last.insert((viewpoint, seen)).1
    }
}

impl Visibility {
    fn new(fields: Vec<FieldOfView>) -> Self {
        Self {
            fields: fields.into_iter().map(DrawnField::new).collect(),
            walls: None,
            due_ns: 0,
        }
    }

    /// Sets the map; the number of cells must be that of the header.
    fn map(&mut self, header: &MapHeader, cells: impl Iterator<Item = MapCell>) {
        if self.fields.is_empty() {
            return;
        }
        let frame = GridFrame {
            width: header.width as usize,
            height: header.height as usize,
            resolution: header.resolution,
            origin: Point2::new(header.origin_x, header.origin_y),
        };
        let cells: Vec<bool> = cells.map(|cell| cell.occupied != 0).collect();
        if cells.len() == frame.len() {
            self.walls = Some(Walls::new(Grid { frame, cells }));
            for field in &mut self.fields {
                field.last = None;
            }
        }
    }

    /// Draws the visible areas if a picture is due or `wanted`; returns `None` if there are no polygons to
    /// show or remove.
    fn draw(&mut self, states: &[RobotState], time_ns: u64, wanted: bool) -> Option<SceneUpdate> {
        let walls = self.walls.as_ref()?;
        if time_ns < self.due_ns && !wanted {
            return None;
        }
        if time_ns >= self.due_ns {
            self.due_ns = (time_ns / PERIOD_NS + 1).saturating_mul(PERIOD_NS);
        }
        let mut update = SceneUpdate::default();
        for drawn in &mut self.fields {
            let all_round = drawn.field.limits().is_all_round();
            let seen = apex(&drawn.field, states).and_then(|(at, team)| {
                let seen = drawn.seen(at, walls);
                (seen.len() > 1).then(|| polygon(at.position(), seen, all_round, team))
            });
            let name = &drawn.field.name;
            if let Some((triangles, lines)) = seen {
                update.entities.push(SceneEntity {
                    triangles: vec![triangles],
                    lines: vec![lines],
                    ..entity(name.clone(), time_ns)
                });
                drawn.shown = true;
            } else if core::mem::take(&mut drawn.shown) {
                update.deletions.push(deletion(name.clone(), time_ns));
            }
        }
        (!update.entities.is_empty() || !update.deletions.is_empty()).then_some(update)
    }
}

/// Returns the apex of a field of view and the team whose colour it has; `None` if its robot is out of the
/// game.
fn apex(field: &FieldOfView, states: &[RobotState]) -> Option<(Pose2, u8)> {
    match field.origin {
        ViewOrigin::Point([x, y]) => Some((Pose2::new(x, y, 0.0), Team::Neutral as u8)),
        ViewOrigin::Robot(robot) => {
            let state = states.iter().find(|state| state.robot == robot)?;
            let looks = state.status == 0 && state.present != 0;
            looks.then(|| (Pose2::new(state.x, state.y, state.theta), state.team))
        }
    }
}

/// Returns the area as a fan of triangles around the apex, and its border.
fn polygon(
    apex: Point2<f64>,
    seen: &[Point2<f64>],
    all_round: bool,
    team: u8,
) -> (TriangleListPrimitive, LinePrimitive) {
    let round = |value: f64| (value * PARTS_OF_A_METRE).round() / PARTS_OF_A_METRE;
    let point = |p: &Point2<f64>| Point3 {
        x: round(p.x),
        y: round(p.y),
        z: HEIGHT,
    };
    // Border first, then the apex: the border is written twice with the same bytes, which compress well.
    let mut points: Vec<Point3> = seen.iter().map(point).collect();
    let apex_at = points.len() as u32;
    points.push(point(&apex));
    let mut border = points.clone();
    if all_round {
        border.pop();
    }
    let last = if all_round { apex_at } else { apex_at - 1 };
    let indices = (0..last)
        .flat_map(|corner| [apex_at, corner, (corner + 1) % apex_at])
        .collect();
    let color = |opacity| {
        Some(Color {
            a: opacity,
            ..palette::team(team, true)
        })
    };
    let (inside, outline) = palette::SEEN;
    let at = Some(pose(0.0, 0.0, 0.0, 0.0));
    let triangles = TriangleListPrimitive {
        pose: at,
        points,
        color: color(inside),
        indices,
        ..TriangleListPrimitive::default()
    };
    let lines = LinePrimitive {
        r#type: line_primitive::Type::LineLoop as i32,
        pose: at,
        thickness: PIXELS,
        scale_invariant: true,
        points: border,
        color: color(outline),
        ..LinePrimitive::default()
    };
    (triangles, lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns two rooms of 2 m by 2 m, separated by a wall of one cell.
    fn rooms() -> (MapHeader, Vec<MapCell>) {
        let header = MapHeader {
            width: 9,
            height: 4,
            resolution: 0.5,
            ..MapHeader::default()
        };
        let cell = |index: usize| MapCell {
            occupied: u8::from(index % 9 == 4),
            ..MapCell::default()
        };
        (header, (0..36).map(cell).collect())
    }

    fn field(origin: ViewOrigin, angle: Option<f64>) -> FieldOfView {
        FieldOfView {
            name: "field".to_owned(),
            origin,
            range: None,
            angle,
        }
    }

    fn area(triangles: &TriangleListPrimitive) -> f64 {
        let corner = |index: &u32| &triangles.points[*index as usize];
        let area = triangles.indices.chunks_exact(3).map(|three| {
            let [a, b, c] = [corner(&three[0]), corner(&three[1]), corner(&three[2])];
            0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))
        });
        area.sum()
    }

    #[test]
    fn only_the_own_room_is_visible_until_the_robot_is_out() {
        let (header, cells) = rooms();
        let mut visibility = Visibility::new(vec![field(ViewOrigin::Robot(3), None)]);
        let mut state = RobotState {
            robot: 3,
            x: 0.7,
            y: 1.3,
            present: 1,
            ..RobotState::default()
        };
        assert!(visibility.draw(&[state], 0, true).is_none(), "no map yet");
        visibility.map(&header, cells.iter().copied());
        let update = visibility.draw(&[state], 0, false).unwrap();
        let triangles = &update.entities[0].triangles[0];
        assert!((area(triangles) - 4.0).abs() < 0.01, "{triangles:?}");
        // The corners, and the first one again.
        assert_eq!(update.entities[0].lines[0].points.len(), 5);
        // Only when due, or at an event.
        assert!(visibility.draw(&[state], 1, false).is_none());
        assert!(visibility.draw(&[state], 2, true).is_some());
        state.status = 1;
        let update = visibility.draw(&[state], PERIOD_NS, false).unwrap();
        assert_eq!(update.deletions[0].id, "field");
        assert!(visibility.draw(&[state], 2 * PERIOD_NS, false).is_none());
    }

    #[test]
    fn a_new_obstacle_hides_the_area_behind_it() {
        let (header, mut cells) = rooms();
        let origin = ViewOrigin::Point([0.25, 0.25]);
        let mut visibility = Visibility::new(vec![field(origin, None)]);
        visibility.map(&header, cells.iter().copied());
        let before = visibility.draw(&[], 0, true).unwrap();
        cells[9 + 1].occupied = 1;
        visibility.map(&header, cells.into_iter());
        let after = visibility.draw(&[], 1, true).unwrap();
        let [before, after] =
            [&before, &after].map(|update| area(&update.entities[0].triangles[0]));
        assert!(
            (before - 4.0).abs() < 0.01 && after < 2.5,
            "{before} {after}"
        );
    }

    #[test]
    fn the_border_of_a_field_of_view_includes_its_apex() {
        let (header, cells) = rooms();
        let mut ahead = field(
            ViewOrigin::Point([1.0, 1.0]),
            Some(core::f64::consts::FRAC_PI_2),
        );
        ahead.range = Some(0.5);
        let mut visibility = Visibility::new(vec![ahead]);
        visibility.map(&header, cells.into_iter());
        let update = visibility.draw(&[], 0, false).unwrap();
        let triangles = &update.entities[0].triangles[0];
        let quarter = core::f64::consts::PI * 0.25 / 4.0;
        assert!((area(triangles) - quarter).abs() < 0.01, "{triangles:?}");
        let border = &update.entities[0].lines[0].points;
        let last = border.last().unwrap();
        assert_eq!((last.x, last.y), (1.0, 1.0));
    }
}
