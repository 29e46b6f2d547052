//! Robots: discs with heading arrows and names, trails, frames and odometry.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::RobotState;
use ipc_types::topics::TopicId;
use recorder::{RobotInfo, status_name};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{duration, header, kind, marker, picture, pose, time, transform, width};
use ros_messages::messages::{
    Clock, ColorRGBA, Marker, MarkerArray, Odometry, Point, PoseWithCovariance, TFMessage, Twist,
    TwistWithCovariance, Vector3,
};

/// Status code of an active robot.
const ACTIVE: u8 = 0;

/// Opacity of a robot that is out of the game.
const OUT: f32 = 0.35;

/// Opacity of trails.
const TRAIL: f32 = 0.6;

/// Height of names (m): above obstacles.
const NAME_HEIGHT: f64 = 0.5;

/// Size of names, and their distance from the robot's edge, as multiples of its radius.
const NAME: (f64, f64) = (3.0, 4.0);

/// `/robots`, `/trails`, `/tf`, `/clock`, and `/ROBOT/odom` for every robot.
pub(super) struct RobotsTopic {
    robots: ViewerChannel<MarkerArray>,
    trails: ViewerChannel<MarkerArray>,
    frames: ViewerChannel<TFMessage>,
    clock: ViewerChannel<Clock>,
    odometry: Vec<ViewerChannel<Odometry>>,
    trail: Trail,
    trail_s: f64,
}

impl RobotsTopic {
    /// Creates the topics; `trail_s` is the duration of trails (simulated s).
    pub(super) fn new(trail_s: f64, picture: &mut Picture) -> Self {
        Self {
            robots: picture.add_channel("/robots"),
            trails: picture.add_channel("/trails"),
            frames: picture.add_channel("/tf"),
            clock: picture.add_channel("/clock"),
            odometry: picture.add_robot_channels("odom"),
            trail: Trail::default(),
            trail_s: if trail_s.is_finite() {
                trail_s.max(0.0)
            } else {
                0.0
            },
        }
    }
}

impl Consumer<Picture> for RobotsTopic {
    fn topics(&self) -> &[TopicId] {
        &[]
    }

    fn message(&mut self, _: &LoggedMessage<'_>, _: &mut Picture) {}

    fn end_of_tick(&mut self, picture: &mut Picture) {
        let (time_ns, line) = (picture.now_ns(), picture.line_width());
        let (robots, states, ready) = (&picture.robots, &picture.states, &mut picture.ready);
        let clock = Clock {
            clock: time(time_ns),
        };
        self.clock.write(ready, time_ns, &clock);
        self.robots
            .write(ready, time_ns, &draw(robots, states, time_ns));
        self.frames
            .write(ready, time_ns, &frames(robots, states, time_ns));
        if self.trail_s > 0.0 {
            let trails = self
                .trail
                .extend(robots.len(), states, time_ns, self.trail_s, line);
            if !trails.markers.is_empty() {
                self.trails.write(ready, time_ns, &trails);
            }
        }
        for state in states.iter().filter(|state| state.present != 0) {
            let robot = state.robot as usize;
            if let (Some(info), Some(channel)) = (robots.get(robot), self.odometry.get(robot)) {
                channel.write(ready, time_ns, &odometry(info, state, time_ns));
            }
        }
    }
}

/// Draws the robots of a state.
fn draw(robots: &[RobotInfo], states: &[RobotState], time_ns: u64) -> MarkerArray {
    let mut all = picture(time_ns);
    for state in states {
        if let Some(info) = robots.get(state.robot as usize) {
            all.markers.extend(robot(info, state, time_ns));
        }
    }
    all
}

/// Returns body, heading and name of a robot.
fn robot(info: &RobotInfo, state: &RobotState, time_ns: u64) -> [Marker; 3] {
    let active = state.status == ACTIVE;
    let (diameter, height) = (2.0 * info.radius, info.radius);
    let text = if active {
        info.name.clone()
    } else {
        let status = status_name(state.status).replace('_', " ");
        format!("{} ({status})", info.name)
    };
    let alpha = if active { 1.0 } else { OUT };
    let ink = ColorRGBA {
        a: alpha,
        ..palette::INK
    };
    let new =
        |name: &str, kind: i32, color: ColorRGBA| marker(name, state.robot, kind, color, time_ns);
    let at = |z| pose(state.x, state.y, z, state.theta);
    let above = state.y + NAME.1 * info.radius;
    [
        Marker {
            pose: at(height / 2.0),
            scale: Vector3 {
                x: diameter,
                y: diameter,
                z: height,
            },
            ..new("body", kind::CYLINDER, palette::role(state.team, alpha))
        },
        Marker {
            pose: at(1.2 * height),
            scale: Vector3 {
                x: 1.2 * diameter,
                y: 0.3 * diameter,
                z: 0.3 * diameter,
            },
            ..new("heading", kind::ARROW, ink)
        },
        Marker {
            pose: pose(state.x, above, NAME_HEIGHT, 0.0),
            scale: Vector3 {
                x: 0.0,
                y: 0.0,
                z: NAME.0 * info.radius,
            },
            text,
            ..new("name", kind::TEXT, palette::INK)
        },
    ]
}

/// Positions of the robots in the last picture.
#[derive(Debug, Default)]
struct Trail {
    last: Vec<Option<(f64, f64)>>,
    pictures: u32,
}

impl Trail {
    /// Returns the paths of all robots since the last picture, with a lifetime; `line` is their width (m).
    fn extend(
        &mut self,
        robots: usize,
        states: &[RobotState],
        time_ns: u64,
        trail_s: f64,
        line: f64,
    ) -> MarkerArray {
        self.last.resize(robots, None);
        let mut trails = MarkerArray::default();
        self.pictures = self.pictures.wrapping_add(1);
        for state in states {
            let Some(last) = self.last.get_mut(state.robot as usize) else {
                continue;
            };
            let from = last.replace((state.x, state.y));
            let Some(from) = from.filter(|&from| from != (state.x, state.y)) else {
                continue;
            };
            let piece = [from, (state.x, state.y)].map(|(x, y)| Point { x, y, z: 0.01 });
            let name = format!("team {}", state.team);
            let known = trails.markers.iter_mut().find(|trail| trail.ns == name);
            if let Some(trail) = known {
                trail.points.extend(piece);
                continue;
            }
            let color = palette::role(state.team, TRAIL);
            trails.markers.push(Marker {
                lifetime: duration(trail_s),
                scale: width(line),
                points: piece.to_vec(),
                ..marker(&name, self.pictures, kind::LINE_LIST, color, time_ns)
            });
        }
        trails
    }
}

/// Returns pose and velocity of a robot.
fn odometry(info: &RobotInfo, state: &RobotState, time_ns: u64) -> Odometry {
    Odometry {
        header: header(time_ns),
        child_frame_id: info.name.clone(),
        pose: PoseWithCovariance {
            pose: pose(state.x, state.y, 0.0, state.theta),
            covariance: [[0.0; 6]; 6],
        },
        twist: TwistWithCovariance {
            twist: Twist {
                linear: Vector3 {
                    x: state.v,
                    ..Vector3::default()
                },
                angular: Vector3 {
                    z: state.omega,
                    ..Vector3::default()
                },
            },
            covariance: [[0.0; 6]; 6],
        },
    }
}

/// Returns a frame per robot.
fn frames(robots: &[RobotInfo], states: &[RobotState], time_ns: u64) -> TFMessage {
    let frame = |state: &RobotState| {
        let info = robots.get(state.robot as usize)?;
        Some(transform(
            &info.name,
            [state.x, state.y],
            state.theta,
            time_ns,
        ))
    };
    TFMessage {
        transforms: states.iter().filter_map(frame).collect(),
    }
}
