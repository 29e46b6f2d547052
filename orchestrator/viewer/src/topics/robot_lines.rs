//! Planned paths and search trees of planners, as lines.

use foxglove::messages::{Color, LinePrimitive, Point3, SceneEntity, SceneUpdate, line_primitive};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::robot::{PlanPoint, TreeEdge};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Plan, TopicId, Tree};
use recorder::RobotInfo;

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{deletion, entity, pose};
use super::repetition::Repetition;

/// Style of lines.
#[derive(Debug)]
struct Style {
    /// First word of entity ids, before the robot's name.
    what: &'static str,
    kind: line_primitive::Type,
    /// Width (pixels).
    pixels: f64,
    /// Opacity, 0 to 1.
    opacity: f64,
    /// Height (m): above map and obstacles; plans above trees.
    height: f64,
}

const PLAN: Style = Style {
    what: "plan",
    kind: line_primitive::Type::LineStrip,
    pixels: 2.0,
    opacity: 0.8,
    height: 0.07,
};

const TREE: Style = Style {
    what: "tree",
    kind: line_primitive::Type::LineList,
    pixels: 1.0,
    opacity: 0.3,
    height: 0.06,
};

/// `/viewer/plan` or `/viewer/tree`: the newest plan or tree of every robot, drawn with its tick.
pub(super) struct LinesTopic {
    takes: [TopicId; 1],
    channel: ViewerChannel<SceneUpdate>,
    lines: RobotLines,
}

impl LinesTopic {
    /// Creates the topic of planned paths.
    pub(super) fn plans(picture: &mut Picture) -> Self {
        Self {
            takes: [TopicId::Plan],
            channel: picture.add_channel("/viewer/plan"),
            lines: RobotLines::plans(picture.robots.len()),
        }
    }

    /// Creates the topic of search trees.
    pub(super) fn trees(picture: &mut Picture) -> Self {
        Self {
            takes: [TopicId::Tree],
            channel: picture.add_channel("/viewer/tree"),
            lines: RobotLines::trees(picture.robots.len()),
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
        let time_ns = picture.now_ns();
        let update = self.lines.draw(&picture.robots, &picture.states, time_ns);
        if let Some(update) = update {
            let bytes = self.channel.write(&mut picture.ready, time_ns, &update);
            self.lines.drawn(time_ns, bytes);
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
    points: Vec<Point3>,
    /// `true` if the lines begin at the robot: paths without times do not contain its position.
    from_robot: bool,
    /// `true` if viewers show it.
    shown: bool,
    /// `true` if it changed since the last drawing.
    changed: bool,
}

impl RobotLines {
    /// Creates plans for this many robots.
    fn plans(robots: usize) -> Self {
        Self::new(&PLAN, robots)
    }

    /// Creates trees for this many robots.
    fn trees(robots: usize) -> Self {
        Self::new(&TREE, robots)
    }

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
            lines.points.extend(points.map(|[x, y]| Point3 { x, y, z }));
            lines.changed = true;
        }
    }

    /// Returns the lines of all active robots, if any changed since the last picture or a repetition is due.
    fn draw(
        &mut self,
        robots: &[RobotInfo],
        states: &[RobotState],
        time_ns: u64,
    ) -> Option<SceneUpdate> {
        let style = self.style;
        let repetition = self.repetition.is_due(time_ns);
        let mut update = SceneUpdate::default();
        let mut changed = false;
        for state in states {
            let robot = state.robot as usize;
            let (Some(info), Some(lines)) = (robots.get(robot), self.lines.get_mut(robot)) else {
                continue;
            };
            let wanted = state.status == 0 && !lines.points.is_empty();
            let id = format!("{} {}", style.what, info.name);
            if wanted {
                let start = Point3 {
                    x: state.x,
                    y: state.y,
                    z: style.height,
                };
                let start = lines.from_robot.then_some(start);
                update.entities.push(SceneEntity {
                    lines: vec![LinePrimitive {
                        r#type: style.kind as i32,
                        pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                        thickness: style.pixels,
                        scale_invariant: true,
                        points: start
                            .into_iter()
                            .chain(lines.points.iter().copied())
                            .collect(),
                        color: Some(Color {
                            a: style.opacity,
                            ..palette::team(state.team, true)
                        }),
                        ..LinePrimitive::default()
                    }],
                    ..entity(id, time_ns)
                });
            } else if lines.shown {
                update.deletions.push(deletion(id, time_ns));
            }
            changed |= lines.changed || wanted != lines.shown || (repetition && wanted);
            lines.shown = wanted;
            lines.changed = false;
        }
        changed.then_some(update)
    }

    /// Records a drawing of this size (bytes).
    fn drawn(&mut self, time_ns: u64, bytes: usize) {
        self.repetition.drawn(time_ns, bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that lines from `set` are drawn with `points` points, repeated, and removed with the robot.
    fn drawn_until_out(
        mut lines: RobotLines,
        set: impl Fn(&mut RobotLines),
        id: &str,
        points: usize,
    ) {
        let robots = [RobotInfo {
            name: "thief".to_owned(),
            radius: 0.1,
            visits_waypoints: false,
            lap_limit_s: None,
        }];
        let mut state = RobotState::default();
        assert!(lines.draw(&robots, &[state], 0).is_none());
        set(&mut lines);
        let update = lines.draw(&robots, &[state], 1).unwrap();
        assert_eq!(update.entities[0].id, id);
        assert_eq!(update.entities[0].lines[0].points.len(), points);
        lines.drawn(1, 100);
        assert!(lines.draw(&robots, &[state], 2).is_none());
        // Repeated later: viewers may have lost it.
        let update = lines.draw(&robots, &[state], 2_000_000_001).unwrap();
        assert_eq!(update.entities[0].lines[0].points.len(), points);
        lines.drawn(2_000_000_001, 100);
        state.status = 1;
        let update = lines.draw(&robots, &[state], 3_000_000_000).unwrap();
        assert_eq!(update.deletions[0].id, id);
        assert!(lines.draw(&robots, &[state], 9_000_000_000).is_none());
    }

    #[test]
    fn a_tree_is_repeated_and_removed_with_its_robot() {
        let edges = || [TreeEdge::default(); 3].into_iter();
        drawn_until_out(
            RobotLines::trees(1),
            |lines| lines.set_tree(0, edges()),
            "tree thief",
            6,
        );
    }

    #[test]
    fn a_plan_is_repeated_and_removed_with_its_robot() {
        // A plan without times is extended by the position of the robot; a plan with times contains it.
        for (time_s, points) in [(0.0, 4), (0.1, 3)] {
            let point = PlanPoint {
                time_s,
                ..PlanPoint::default()
            };
            drawn_until_out(
                RobotLines::plans(1),
                |lines| lines.set_plan(0, [point; 3].into_iter()),
                "plan thief",
                points,
            );
        }
    }
}
