//! Robots outside of the simulation: their odometry in, the commands of their planners out.

use core::time::Duration;
use std::time::Instant;

use geometry::pose::Pose2;
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::messages::robot::{Command, MeasuredPose};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Commands, MeasuredPoses};
use ros_messages::messages::{Header, Odometry, TFMessage, Time, Twist, TwistStamped};
use ros_messages::pose2;
use runtime::{Clock, ProcessConfig, ProcessError};

use crate::convert;
use crate::error::BridgeError;
use crate::names::Namespace;
use crate::params::{CommandType, Ros2BridgeParams};
use crate::session::{Kept, RosPublisher, RosSubscription, Session};

/// Pause between two looks at the commands of a tick.
const LOOK: Duration = Duration::from_micros(200);

/// Publisher of the commands of a robot.
enum CommandsOut {
    Plain(RosPublisher<Twist>),
    Stamped(RosPublisher<TwistStamped>),
}

/// A robot outside of the simulation.
struct Source {
    index: u32,
    topic: String,
    odometry: RosSubscription<Odometry>,
    commands: CommandsOut,
    /// The newest odometry, and the moment of its arrival.
    measured: Option<(Odometry, Instant)>,
    /// The newest command of its planner: its tick, and the moment of its arrival.
    command: Option<(u64, Command, Instant)>,
    /// `true` if the run has the newest odometry.
    is_sent: bool,
    /// `true` while it is told to stop.
    is_stopped: bool,
}

/// The robots of a run that are outside of the simulation.
pub struct Sources {
    robots: Vec<Source>,
    transforms: RosSubscription<TFMessage>,
    /// Frames in the map: that of the odometry of a robot that has one.
    in_map: Vec<(String, Pose2)>,
    commands: Subscriber<Commands>,
    poses: Publisher<MeasuredPoses>,
    start_timeout: Duration,
    deadline: Duration,
}

impl Sources {
    /// Subscribes to the odometry of the robots in `source`; `None` without any.
    ///
    /// # Errors
    /// [`BridgeError::Create`]; [`BridgeError::Source`] for an unknown robot; [`BridgeError::LockStep`].
    pub fn open(
        config: &ProcessConfig,
        params: &Ros2BridgeParams,
        bus: &Bus,
        session: &mut Session,
    ) -> Result<Option<Self>, ProcessError> {
        if params.source.is_empty() {
            return Ok(None);
        }
        if config.run.clock == Clock::LockStep {
            return Err(BridgeError::LockStep.into());
        }
        let mut sources = Vec::new();
        for name in &params.source {
            let mut robots = config.run.robots.iter();
            let index = robots.position(|robot| robot.name == *name);
            let index = index.ok_or_else(|| BridgeError::Source { name: name.clone() })?;
            let namespace = Namespace::new(name, &params.root)?;
            let topic = namespace.topic("odom");
            let commands = namespace.topic("cmd_vel");
            sources.push(Source {
                index: index as u32,
                odometry: session.subscription(&topic)?,
                topic,
                commands: match params.commands {
                    CommandType::TwistStamped => {
                        CommandsOut::Stamped(session.publisher(&commands, Kept::Nothing)?)
                    }
                    CommandType::Twist | CommandType::None => {
                        CommandsOut::Plain(session.publisher(&commands, Kept::Nothing)?)
                    }
                },
                measured: None,
                command: None,
                is_sent: false,
                is_stopped: true,
            });
        }
        Ok(Some(Self {
            transforms: session.subscription("/tf")?,
            in_map: Vec::new(),
            commands: bus.subscriber()?,
            poses: bus.publisher(PublisherOptions::new(config.index, sources.len()))?,
            start_timeout: Duration::from_secs_f64(params.start_timeout_s),
            deadline: Duration::from_secs_f64(params.source_deadline_s),
            robots: sources,
        }))
    }

    /// Connects to the topics of the run.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ProcessError> {
        self.commands.update_connections()?;
        self.poses.update_connections()?;
        Ok(())
    }

    /// Waits for the first odometry of each robot.
    ///
    /// # Errors
    /// [`BridgeError::NoOdometry`]; [`BridgeError::Transfer`].
    pub fn wait(&mut self) -> Result<(), BridgeError> {
        let until = Instant::now() + self.start_timeout;
        for source in &mut self.robots {
            let first = source.odometry.wait(until)?;
            let first = first.ok_or_else(|| BridgeError::NoOdometry {
                topic: source.topic.clone(),
                timeout_s: self.start_timeout.as_secs_f64(),
            })?;
            source.measured = Some((first, Instant::now()));
        }
        Ok(())
    }

    /// Takes the odometry that has arrived, and sends the newest as the poses of the robots.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`]; [`ProcessError`] if the transport fails.
    pub fn measure(&mut self, stamp: Stamp) -> Result<(), ProcessError> {
        while let Some(message) = self.transforms.take()? {
            for found in message.transforms {
                if found.header.frame_id == convert::MAP {
                    self.in_map
                        .retain(|(frame, _)| *frame != found.child_frame_id);
                    let place = found.transform;
                    let place = pose2(place.translation.x, place.translation.y, &place.rotation);
                    self.in_map.push((found.child_frame_id, place));
                }
            }
        }
        let mut poses = Vec::new();
        for source in &mut self.robots {
            while let Some(odometry) = source.odometry.take()? {
                source.measured = Some((odometry, Instant::now()));
                source.is_sent = false;
            }
            if let Some((odometry, _)) = &source.measured
                && !source.is_sent
            {
                poses.push(measured(source.index, odometry, &self.in_map));
                source.is_sent = true;
            }
        }
        if !poses.is_empty() {
            self.poses.send(PlainHeader { stamp }, &poses)?;
        }
        Ok(())
    }

    /// Waits until each planner has commanded its robot in a tick, but not beyond `until`; then sends every robot its newest
    /// command, or the command to stop if that, or its odometry, is too old.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`]; [`ProcessError`] if the transport fails.
    pub fn steer(&mut self, tick: u64, stamp: &Time, until: Instant) -> Result<(), ProcessError> {
        loop {
            while let Some(message) = self.commands.receive()? {
                for command in message.elements() {
                    let mut sources = self.robots.iter_mut();
                    if let Some(source) = sources.find(|source| source.index == command.robot) {
                        let tick = message.header().stamp.tick;
                        source.command = Some((tick, *command, Instant::now()));
                    }
                }
            }
            let is_new = |source: &Source| source.command.is_some_and(|(of, ..)| of >= tick);
            if self.robots.iter().all(is_new) || Instant::now() >= until {
                break;
            }
            std::thread::sleep(LOOK);
        }
        for source in &mut self.robots {
            source.send(self.deadline, stamp)?;
        }
        Ok(())
    }
}

impl Source {
    /// Sends the newest command, or the command to stop.
    fn send(&mut self, deadline: Duration, stamp: &Time) -> Result<(), BridgeError> {
        let is_fresh = |since: Instant| since.elapsed() <= deadline;
        let is_seen = self.measured.as_ref().is_some_and(|(_, at)| is_fresh(*at));
        let command = self.command.filter(|(.., at)| is_seen && is_fresh(*at));
        let (v, omega) = command.map_or((0.0, 0.0), |(_, command, _)| (command.v, command.omega));
        let is_stopped = command.is_none();
        if is_stopped != self.is_stopped {
            self.is_stopped = is_stopped;
            let topic = &self.topic;
            let lack = if is_seen { "commands" } else { "odometry" };
            if is_stopped {
                tracing::warn!("the robot of {topic} is told to stop: no {lack} for {deadline:?}");
            } else {
                tracing::info!("the robot of {topic} is steered");
            }
        }
        let twist = convert::twist(v, omega);
        match &self.commands {
            CommandsOut::Plain(out) => out.send(twist),
            CommandsOut::Stamped(out) => out.send(TwistStamped {
                header: Header {
                    stamp: stamp.clone(),
                    ..Header::default()
                },
                twist,
            }),
        }
    }
}

/// The pose in the map by odometry in a frame, which is the map if it has no place in it.
fn measured(robot: u32, odometry: &Odometry, in_map: &[(String, Pose2)]) -> MeasuredPose {
    let frame = &odometry.header.frame_id;
    let place = in_map.iter().find(|(known, _)| known == frame);
    let place = place.map_or(Pose2::default(), |(_, place)| *place);
    let pose = &odometry.pose.pose;
    let pose = place.placed(&pose2(pose.position.x, pose.position.y, &pose.orientation));
    let twist = &odometry.twist.twist;
    MeasuredPose {
        x: pose.x,
        y: pose.y,
        theta: pose.theta,
        v: twist.linear.x,
        omega: twist.angular.z,
        robot,
        reserved: 0,
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use ros_messages::messages::PoseWithCovariance;

    use super::*;

    #[test]
    fn odometry_is_placed_in_the_map_by_its_frame() {
        let odometry = Odometry {
            header: Header {
                frame_id: "odom".to_owned(),
                ..Header::default()
            },
            pose: PoseWithCovariance {
                pose: ros_messages::pose(2.0, 0.0, 0.0, FRAC_PI_2),
                ..PoseWithCovariance::default()
            },
            ..Odometry::default()
        };
        let alone = measured(3, &odometry, &[]);
        assert_eq!((alone.robot, alone.x, alone.y), (3, 2.0, 0.0));
        assert!((alone.theta - FRAC_PI_2).abs() < 1e-12);
        let place = pose2(10.0, 20.0, &ros_messages::yaw(FRAC_PI_2));
        let placed = [("odom".to_owned(), place)];
        let placed = measured(3, &odometry, &placed);
        assert!((placed.x - 10.0).abs() < 1e-12 && (placed.y - 22.0).abs() < 1e-12);
        assert!((placed.theta.abs() - core::f64::consts::PI).abs() < 1e-9);
    }
}
