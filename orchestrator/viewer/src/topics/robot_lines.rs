//! Planned paths and search trees of planners, as lines.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::robot::{PlanPoint, TreeEdge};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Plan, TopicId, Tree};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{header, kind, marker, picture, pose, width};
use super::repetition::Repetition;
use ros_messages::messages::{MarkerArray, Path, Point, PoseStamped};

/// Style of lines.
#[derive(Debug)]
struct Style {
    /// Namespace of the markers.
    name: &'static str,
    kind: i32,
    /// Width as a part of the usual width of lines.
    width: f64,
    /// Opacity, 0 to 1.
    opacity: f32,
    /// Height (m): above map and obstacles; plans above trees.
    height: f64,
}

const PLAN: Style = Style {
    name: "plan",
    kind: kind::LINE_STRIP,
    width: 1.0,
    opacity: 0.8,
    height: 0.07,
};

const TREE: Style = Style {
    name: "tree",
    kind: kind::LINE_LIST,
    width: 0.5,
    opacity: 0.3,
    height: 0.06,
};

/// `/plans` or `/trees`: the newest plan or tree of every robot, drawn with its tick; plans also as `/ROBOT/plan`.
pub(super) struct LinesTopic {
    takes: [TopicId; 1],
    channel: ViewerChannel<MarkerArray>,
    paths: Vec<ViewerChannel<Path>>,
    lines: RobotLines,
}

impl LinesTopic {
    /// Creates the topics of planned paths.
    pub(super) fn plans(picture: &mut Picture) -> Self {
        Self {
            takes: [TopicId::Plan],
            channel: picture.add_latched_channel("/plans"),
            paths: picture.add_robot_channels("plan"),
            lines: RobotLines::new(&PLAN, picture.robots.len()),
        }
    }

    /// Creates the topic of search trees.
    pub(super) fn trees(picture: &mut Picture) -> Self {
        Self {
            takes: [TopicId::Tree],
            channel: picture.add_latched_channel("/trees"),
            paths: Vec::new(),
            lines: RobotLines::new(&TREE, picture.robots.len()),
        }
    }
}

impl Consumer<Picture> for LinesTopic {
    fn topics(&self) -> &[TopicId] {
        &self.takes
    }

    fn message(&mut self, message: &LoggedMessage<'_>, _: &mut Picture) {
        if let Some((header, points)) = message.view::<Plan>() {
            self.lines.set_plan(header.robot as usize, points);
        }
        if let Some((header, edges)) = message.view::<Tree>() {
            self.lines.set_tree(header.robot as usize, edges);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        let (time_ns, line) = (picture.now_ns(), picture.line_width());
        let drawn = self.lines.draw(&picture.states, time_ns, line);
        let Some((lines, paths)) = drawn else { return };
        let bytes = self.channel.write(&mut picture.ready, time_ns, &lines);
        self.lines.repetition.drawn(time_ns, bytes);
        for (robot, path) in paths {
            if let Some(channel) = self.paths.get(robot) {
                channel.write(&mut picture.ready, time_ns, &path);
            }
        }
    }
}

/// Last plan, or last tree, of every robot.
#[derive(Debug)]
struct RobotLines {
    style: &'static Style,
    lines: Vec<Lines>,
    repetition: Repetition,
}

#[derive(Debug, Clone, Default)]
struct Lines {
    points: Vec<Point>,
    /// `true` if the lines begin at the robot: paths without times do not contain its position.
    from_robot: bool,
    /// `true` if viewers show it.
    shown: bool,
    /// `true` if it changed since the last drawing.
    changed: bool,
}

impl RobotLines {
    /// Creates the lines of this many robots.
    fn new(style: &'static Style, robots: usize) -> Self {
        Self {
            style,
            lines: vec![Lines::default(); robots],
            repetition: Repetition::default(),
        }
    }

    /// Replaces the plan of a robot.
    fn set_plan(&mut self, robot: usize, points: impl Iterator<Item = PlanPoint>) {
        let mut is_timed = false;
        let points = points.inspect(|p| is_timed |= p.time_s != 0.0);
        self.set(robot, points.map(|p| [p.x, p.y]));
        if let Some(lines) = self.lines.get_mut(robot) {
            lines.from_robot = !is_timed;
        }
    }

    /// Replaces the tree of a robot: both ends of every edge.
    fn set_tree(&mut self, robot: usize, edges: impl Iterator<Item = TreeEdge>) {
        let ends = edges.flat_map(|e| [[e.from_x, e.from_y], [e.to_x, e.to_y]]);
        self.set(robot, ends.map(|end| end.map(f64::from)));
    }

    fn set(&mut self, robot: usize, points: impl Iterator<Item = [f64; 2]>) {
        let z = self.style.height;
        if let Some(lines) = self.lines.get_mut(robot) {
            lines.points.clear();
            lines.points.extend(points.map(|[x, y]| Point { x, y, z }));
            lines.changed = true;
        }
    }

    /// Returns the lines of all active robots, and by robot those that changed, as paths, if any changed since
    /// the last picture or a repetition is due. `line` is the usual width of lines (m).
    fn draw(
        &mut self,
        states: &[RobotState],
        time_ns: u64,
        line: f64,
    ) -> Option<(MarkerArray, Vec<(usize, Path)>)> {
        let style = self.style;
        let repetition = self.repetition.is_due(time_ns);
        let mut all = picture(time_ns);
        let mut paths = Vec::new();
        let mut draws = false;
        for state in states {
            let robot = state.robot as usize;
            let Some(lines) = self.lines.get_mut(robot) else {
                continue;
            };
            let wanted = state.status == 0 && !lines.points.is_empty();
            let changed = lines.changed || wanted != lines.shown;
            draws |= changed || (repetition && wanted);
            lines.shown = wanted;
            lines.changed = false;
            let mut points = Vec::new();
            if wanted {
                let start = Point {
                    x: state.x,
                    y: state.y,
                    z: style.height,
                };
                points.extend(lines.from_robot.then_some(start));
                points.extend_from_slice(&lines.points);
            }
            if changed {
                paths.push((robot, path(&points, time_ns)));
            }
            if wanted {
                let color = palette::role(state.team, style.opacity);
                let mut marker = marker(style.name, state.robot, style.kind, color, time_ns);
                marker.scale = width(line * style.width);
                marker.points = points;
                all.markers.push(marker);
            }
        }
        draws.then_some((all, paths))
    }
}

/// Returns points as a path, without headings: those would be most of the log of a mission with plans.
fn path(points: &[Point], time_ns: u64) -> Path {
    let poses = points.iter().map(|point| PoseStamped {
        header: header(time_ns),
        pose: pose(point.x, point.y, 0.0, 0.0),
    });
    Path {
        poses: poses.collect(),
        header: header(time_ns),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that lines from `set` are drawn with `points` points, repeated, and removed with the robot.
    fn drawn_until_out(style: &'static Style, set: impl Fn(&mut RobotLines), points: usize) {
        let mut lines = RobotLines::new(style, 1);
        let mut state = RobotState::default();
        assert!(lines.draw(&[state], 0, 0.1).is_none());
        set(&mut lines);
        let (drawn, paths) = lines.draw(&[state], 1, 0.1).unwrap();
        assert_eq!(drawn.markers[1].points.len(), points);
        assert_eq!(paths[0].1.poses.len(), points);
        lines.repetition.drawn(1, 100);
        assert!(lines.draw(&[state], 2, 0.1).is_none());
        // Repeated later: viewers may have lost it.
        let (drawn, paths) = lines.draw(&[state], 2_000_000_001, 0.1).unwrap();
        assert_eq!(drawn.markers[1].points.len(), points);
        assert!(paths.is_empty());
        lines.repetition.drawn(2_000_000_001, 100);
        state.status = 1;
        let (drawn, paths) = lines.draw(&[state], 3_000_000_000, 0.1).unwrap();
        assert_eq!(drawn.markers.len(), 1, "removes the lines");
        assert_eq!(paths[0].1.poses.len(), 0);
        assert!(lines.draw(&[state], 9_000_000_000, 0.1).is_none());
    }

    #[test]
    fn a_tree_is_repeated_and_removed_with_its_robot() {
        let edges = || [TreeEdge::default(); 3].into_iter();
        drawn_until_out(&TREE, |lines| lines.set_tree(0, edges()), 6);
    }

    #[test]
    fn a_plan_is_repeated_and_removed_with_its_robot() {
        // A plan without times is extended by the position of the robot; a plan with times contains it.
        for (time_s, points) in [(0.0, 4), (0.1, 3)] {
            let point = PlanPoint {
                time_s,
                ..PlanPoint::default()
            };
            let plan = |lines: &mut RobotLines| lines.set_plan(0, [point; 3].into_iter());
            drawn_until_out(&PLAN, plan, points);
        }
    }
}
