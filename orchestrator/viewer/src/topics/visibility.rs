//! Visible areas of the fields of view, as polygons.
//!
//! The recorder computes them from the map and the poses of the robots; processes do not send them, so that
//! the run does not depend on them.

use geometry::grid::{Grid, GridFrame};
use geometry::pose::Pose2;
use geometry::visibility::polygon::{Viewpoint, Walls};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{MapCell, MapHeader, RobotState};
use ipc_types::topics::{TopicId, WorldMap};
use nalgebra::Point2;
use robot::team::Role;

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{add_triangles, picture};
use super::{grid, palette};
use recorder::{FieldOfView, ViewOrigin};
use ros_messages::messages::{MarkerArray, Point};

/// Minimum time between two pictures (simulated ns): polygons are large, and robots slow.
const PERIOD_NS: u64 = 200_000_000;
/// Height of the polygons (m): above the map and trails, below obstacles.
const HEIGHT: f64 = 0.02;
/// Resolution of corners (1/m): a power of two, so that most bits of a coordinate are 0 and compress well.
const PARTS_OF_A_METRE: f64 = 1024.0;

/// `/fields_of_view`.
pub(super) struct VisibilityTopic {
    channel: ViewerChannel<MarkerArray>,
    visibility: Visibility,
}

impl VisibilityTopic {
    pub(super) fn new(fields_of_view: &[FieldOfView], picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/fields_of_view"),
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
        if let Some(areas) = self.visibility.draw(states, time_ns, picture.wanted) {
            self.channel.write(&mut picture.ready, time_ns, &areas);
        }
    }
}

/// Fields of view and their walls.
#[derive(Debug)]
struct Visibility {
    fields: Vec<DrawnField>,
    walls: Option<Walls>,
    due_ns: u64,
    /// `true` if viewers show a polygon.
    shown: bool,
}

#[derive(Debug)]
struct DrawnField {
    field: FieldOfView,
    /// Last viewpoint and visible area, reused for fixed points and waiting robots.
    last: Option<(Viewpoint, Vec<Point2<f64>>)>,
}

impl DrawnField {
    fn new(field: FieldOfView) -> Self {
        Self { field, last: None }
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
            shown: false,
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
    fn draw(&mut self, states: &[RobotState], time_ns: u64, wanted: bool) -> Option<MarkerArray> {
        let walls = self.walls.as_ref()?;
        if time_ns < self.due_ns && !wanted {
            return None;
        }
        if time_ns >= self.due_ns {
            self.due_ns = (time_ns / PERIOD_NS + 1).saturating_mul(PERIOD_NS);
        }
        let mut areas = picture(time_ns);
        for drawn in &mut self.fields {
            let Some((at, team)) = apex(&drawn.field, states) else {
                continue;
            };
            let all_round = drawn.field.limits().is_all_round();
            let points = triangles(at.position(), drawn.seen(at, walls), all_round);
            let color = palette::role(team, palette::SEEN);
            let name = &drawn.field.name;
            add_triangles(&mut areas.markers, name, &color, &points, time_ns);
        }
        let shows = areas.markers.len() > 1;
        let shown = core::mem::replace(&mut self.shown, shows);
        (shows || shown).then_some(areas)
    }
}

/// Returns the apex of a field of view and the team whose colour it has; `None` if its robot is out of the
/// game.
fn apex(field: &FieldOfView, states: &[RobotState]) -> Option<(Pose2, u8)> {
    match field.origin {
        ViewOrigin::Point([x, y]) => Some((Pose2::new(x, y, 0.0), Role::Neutral as u8)),
        ViewOrigin::Robot(robot) => {
            let state = states.iter().find(|state| state.robot == robot)?;
            let looks = state.status == 0 && state.present != 0;
            looks.then(|| (Pose2::new(state.x, state.y, state.theta), state.team))
        }
    }
}

/// Returns the area as a fan of triangles around the apex, three points each; none if fewer than two points are
/// seen.
fn triangles(apex: Point2<f64>, seen: &[Point2<f64>], all_round: bool) -> Vec<Point> {
    let round = |value: f64| (value * PARTS_OF_A_METRE).round() / PARTS_OF_A_METRE;
    let point = |p: &Point2<f64>| Point {
        x: round(p.x),
        y: round(p.y),
        z: HEIGHT,
    };
    let apex = point(&apex);
    let first = seen.first().filter(|_| all_round && seen.len() > 1);
    let corners: Vec<Point> = seen.iter().chain(first).map(point).collect();
    let sides = corners.windows(2);
    sides
        .flat_map(|side| [side[0].clone(), side[1].clone(), apex.clone()])
        .collect()
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

    fn area(triangles: &[Point]) -> f64 {
        let area = triangles.chunks_exact(3).map(|three| {
            let [a, b, c] = [&three[0], &three[1], &three[2]];
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
        let triangles = &update.markers[1].points;
        assert!((area(triangles) - 4.0).abs() < 0.01, "{triangles:?}");
        // Only when due, or at an event.
        assert!(visibility.draw(&[state], 1, false).is_none());
        assert!(visibility.draw(&[state], 2, true).is_some());
        state.status = 1;
        let update = visibility.draw(&[state], PERIOD_NS, false).unwrap();
        assert_eq!(update.markers.len(), 1, "removes the polygon");
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
        let [before, after] = [&before, &after].map(|update| area(&update.markers[1].points));
        assert!(
            (before - 4.0).abs() < 0.01 && after < 2.5,
            "{before} {after}"
        );
    }

    #[test]
    fn a_limited_field_of_view_is_a_sector() {
        let (header, cells) = rooms();
        let mut ahead = field(
            ViewOrigin::Point([1.0, 1.0]),
            Some(core::f64::consts::FRAC_PI_2),
        );
        ahead.range = Some(0.5);
        let mut visibility = Visibility::new(vec![ahead]);
        visibility.map(&header, cells.into_iter());
        let update = visibility.draw(&[], 0, false).unwrap();
        let triangles = &update.markers[1].points;
        let quarter = core::f64::consts::PI * 0.25 / 4.0;
        assert!((area(triangles) - quarter).abs() < 0.01, "{triangles:?}");
    }
}
