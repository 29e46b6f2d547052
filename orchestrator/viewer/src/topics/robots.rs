//! Robots: discs with heading arrows and names, trails and frames.

use foxglove::messages::{
    ArrowPrimitive, Color, CylinderPrimitive, Duration, FrameTransform, FrameTransforms,
    KeyValuePair, LinePrimitive, Point3, PosesInFrame, SceneEntity, SceneUpdate, TextPrimitive,
    Vector3, line_primitive,
};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{TopicId, WorldMap};
use recorder::{RobotInfo, status_name};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{MAP_FRAME, entity, pose, timestamp, yaw};
use super::{grid, palette};

/// Frame in the middle of the map, as target of cameras; robot names cannot contain `/`.
const CENTRE_FRAME: &str = "map/centre";

/// Status code of an active robot.
const ACTIVE: u8 = 0;

/// Height of names (m): above obstacles.
const NAME_HEIGHT: f64 = 0.5;

/// Distance of a name from the edge of its robot (m).
const NAME_GAP: f64 = 0.45;

/// Font size of names (pixels).
const FONT_PIXELS: f64 = 14.0;

/// Width of trails (pixels).
const TRAIL_PIXELS: f64 = 2.0;

/// `/viewer/scene`, `/viewer/tf` and `/viewer/poses`.
pub(super) struct RobotsTopic {
    scene: ViewerChannel<SceneUpdate>,
    transforms: ViewerChannel<FrameTransforms>,
    poses: ViewerChannel<PosesInFrame>,
    trail: Trail,
    trail_s: f64,
    /// Middle of the map (m).
    centre: Option<[f64; 2]>,
}

impl RobotsTopic {
    /// Creates the topics; `trail_s` is the duration of trails (simulated s).
    pub(super) fn new(trail_s: f64, picture: &mut Picture) -> Self {
        Self {
            scene: picture.add_channel("/viewer/scene"),
            transforms: picture.add_channel("/viewer/tf"),
            poses: picture.add_channel("/viewer/poses"),
            trail: Trail::default(),
            trail_s: if trail_s.is_finite() {
                trail_s.max(0.0)
            } else {
                0.0
            },
            centre: None,
        }
    }
}

impl Consumer<Picture> for RobotsTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::WorldMap]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, _: &mut Picture) {
        if let Some((header, cells)) = message.view::<WorldMap>()
            && grid::fits(header.width, header.height, cells.len())
        {
            let middle =
                |origin: f64, cells: u32| origin + 0.5 * f64::from(cells) * header.resolution;
            self.centre = Some([
                middle(header.origin_x, header.width),
                middle(header.origin_y, header.height),
            ]);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        let (time_ns, robots, states) = (picture.now_ns(), &picture.robots, &picture.states);
        let update = draw(robots, states, time_ns, &mut self.trail, self.trail_s);
        let transforms = transforms(robots, states, self.centre, time_ns);
        let poses = poses(states, time_ns);
        self.scene.write(&mut picture.ready, time_ns, &update);
        self.transforms
            .write(&mut picture.ready, time_ns, &transforms);
        self.poses.write(&mut picture.ready, time_ns, &poses);
    }
}

/// Positions of the robots in the last picture.
#[derive(Debug, Default)]
struct Trail {
    last: Vec<Option<(f64, f64)>>,
    pictures: u64,
}

/// Draws the robots of a state and the next segment of their trails.
fn draw(
    robots: &[RobotInfo],
    states: &[RobotState],
    time_ns: u64,
    trail: &mut Trail,
    trail_s: f64,
) -> SceneUpdate {
    let mut entities = Vec::with_capacity(states.len() + 1);
    for state in states {
        if let Some(info) = robots.get(state.robot as usize) {
            entities.push(robot(info, state, time_ns));
        }
    }
    if trail_s > 0.0 {
        entities.extend(trail.extend(robots.len(), states, time_ns, trail_s));
    }
    SceneUpdate {
        deletions: Vec::new(),
        entities,
    }
}

fn robot(info: &RobotInfo, state: &RobotState, time_ns: u64) -> SceneEntity {
    let active = state.status == ACTIVE;
    let color = palette::team(state.team, active);
    let diameter = 2.0 * info.radius;
    let height = info.radius;
    let text = if active {
        info.name.clone()
    } else {
        format!(
            "{} ({})",
            info.name,
            status_name(state.status).replace('_', " ")
        )
    };
    let at = |z| Some(pose(state.x, state.y, z, state.theta));
    SceneEntity {
        metadata: vec![KeyValuePair {
            key: "status".to_owned(),
            value: status_name(state.status).to_owned(),
        }],
        cylinders: vec![CylinderPrimitive {
            pose: at(height / 2.0),
            size: Some(Vector3 {
                x: diameter,
                y: diameter,
                z: height,
            }),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: Some(color),
        }],
        arrows: vec![ArrowPrimitive {
            pose: at(1.2 * height),
            shaft_length: 0.8 * diameter,
            shaft_diameter: 0.2 * diameter,
            head_length: 0.4 * diameter,
            head_diameter: 0.45 * diameter,
            color: Some(Color {
                a: color.a,
                ..palette::INK
            }),
        }],
        texts: vec![TextPrimitive {
            pose: Some(pose(
                state.x,
                state.y + info.radius + NAME_GAP,
                NAME_HEIGHT,
                0.0,
            )),
            billboard: true,
            font_size: FONT_PIXELS,
            scale_invariant: true,
            color: Some(palette::INK),
            text,
        }],
        ..entity(info.name.clone(), time_ns)
    }
}

impl Trail {
    /// Returns the paths of all robots since the last picture, as one entity with a lifetime.
    fn extend(
        &mut self,
        robots: usize,
        states: &[RobotState],
        time_ns: u64,
        trail_s: f64,
    ) -> Option<SceneEntity> {
        self.last.resize(robots, None);
        // One list of lines per colour.
        let mut lines: Vec<(u8, Vec<Point3>)> = Vec::new();
        for state in states {
            let Some(last) = self.last.get_mut(state.robot as usize) else {
                continue;
            };
            let from = last.replace((state.x, state.y));
            let Some(from) = from.filter(|&from| from != (state.x, state.y)) else {
                continue;
            };
            let piece = [from, (state.x, state.y)].map(|(x, y)| Point3 { x, y, z: 0.01 });
            match lines.iter_mut().find(|(team, _)| *team == state.team) {
                Some((_, points)) => points.extend(piece),
                None => lines.push((state.team, piece.to_vec())),
            }
        }
        if lines.is_empty() {
            return None;
        }
        self.pictures += 1;
        let lines = lines
            .into_iter()
            .map(|(team, points)| LinePrimitive {
                r#type: line_primitive::Type::LineList as i32,
                pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                thickness: TRAIL_PIXELS,
                scale_invariant: true,
                points,
                color: Some(Color {
                    a: 0.6,
                    ..palette::team(team, true)
                }),
                ..LinePrimitive::default()
            })
            .collect();
        Some(SceneEntity {
            lifetime: Some(Duration::saturating_from_secs_f64(trail_s)),
            lines,
            ..entity(format!("trail {}", self.pictures), time_ns)
        })
    }
}

/// Returns the poses of the robots, for viewers that do not draw scenes.
fn poses(states: &[RobotState], time_ns: u64) -> PosesInFrame {
    let present = states.iter().filter(|state| state.present != 0);
    PosesInFrame {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP_FRAME.to_owned(),
        poses: present
            .map(|state| pose(state.x, state.y, 0.0, state.theta))
            .collect(),
    }
}

/// Returns a frame per robot and one in the middle of the map.
fn transforms(
    robots: &[RobotInfo],
    states: &[RobotState],
    centre: Option<[f64; 2]>,
    time_ns: u64,
) -> FrameTransforms {
    let frame = |name: &str, [x, y]: [f64; 2], theta: f64| FrameTransform {
        timestamp: Some(timestamp(time_ns)),
        parent_frame_id: MAP_FRAME.to_owned(),
        child_frame_id: name.to_owned(),
        translation: Some(Vector3 { x, y, z: 0.0 }),
        rotation: Some(yaw(theta)),
    };
    let of_robots = states.iter().filter_map(|state| {
        let info = robots.get(state.robot as usize)?;
        Some(frame(&info.name, [state.x, state.y], state.theta))
    });
    let of_map = centre.map(|centre| frame(CENTRE_FRAME, centre, 0.0));
    FrameTransforms {
        transforms: of_robots.chain(of_map).collect(),
    }
}
