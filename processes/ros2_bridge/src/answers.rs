//! The commands of ROS 2 nodes: one for each robot and state.

use core::time::Duration;
use std::time::Instant;

use crate::error::BridgeError;
use crate::params::CommandType;
use crate::session::{RosSubscription, Session};
use ros_messages::RosType;
use ros_messages::messages::{Time, Twist, TwistStamped};

/// Velocities for a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotCommand {
    /// Forward speed (m/s).
    pub v: f64,
    /// Turning rate (rad/s).
    pub omega: f64,
    /// Time that the node gave it; `None` without one.
    stamp: Option<Time>,
}

impl From<Twist> for RobotCommand {
    fn from(twist: Twist) -> Self {
        Self {
            v: twist.linear.x,
            omega: twist.angular.z,
            stamp: None,
        }
    }
}

impl From<TwistStamped> for RobotCommand {
    fn from(message: TwistStamped) -> Self {
        let stamp = message.header.stamp;
        Self {
            stamp: (stamp != Time::default()).then_some(stamp),
            ..message.twist.into()
        }
    }
}

/// Subscription to the commands of a robot.
enum Commands {
    Plain(RosSubscription<Twist>),
    Stamped(RosSubscription<TwistStamped>),
}

impl Commands {
    fn take(&self) -> Result<Option<RobotCommand>, BridgeError> {
        Ok(match self {
            Self::Plain(topic) => topic.take()?.map(RobotCommand::from),
            Self::Stamped(topic) => topic.take()?.map(RobotCommand::from),
        })
    }

    fn wait(&self, until: Instant) -> Result<Option<RobotCommand>, BridgeError> {
        Ok(match self {
            Self::Plain(topic) => topic.wait(until)?.map(RobotCommand::from),
            Self::Stamped(topic) => topic.wait(until)?.map(RobotCommand::from),
        })
    }

    fn writers(&self, session: &Session) -> usize {
        match self {
            Self::Plain(topic) => topic.writers(session),
            Self::Stamped(topic) => topic.writers(session),
        }
    }

    /// Name of the type, as nodes know it.
    fn type_name(&self) -> String {
        match self {
            Self::Plain(_) => Twist::name(),
            Self::Stamped(_) => TwistStamped::name(),
        }
    }
}

/// The commands of one robot.
pub struct Answers {
    /// The topic, `/ROBOT/cmd_vel`.
    topic: String,
    commands: Commands,
}

impl Answers {
    /// Subscribes to `/ROBOT/cmd_vel`; `None` if nodes give no commands.
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn open(
        session: &mut Session,
        topic: String,
        commands: CommandType,
    ) -> Result<Option<Self>, BridgeError> {
        let commands = match commands {
            CommandType::Twist => Commands::Plain(session.subscription(&topic)?),
            CommandType::TwistStamped => Commands::Stamped(session.subscription(&topic)?),
            CommandType::None => return Ok(None),
        };
        Ok(Some(Self { topic, commands }))
    }

    /// Returns `true` if a node writes the commands.
    ///
    /// # Errors
    /// [`BridgeError::Writers`] if several do; [`BridgeError::ForeignType`].
    pub fn is_written(&self, session: &Session) -> Result<bool, BridgeError> {
        let type_name = self.commands.type_name();
        let types = session.types_of(&self.topic);
        // DDS matches topics by their names alone.
        let expected = format!("{}_", type_name.replace('/', "::msg::dds_::"));
        if let Some(found) = types.into_iter().find(|found| *found != expected) {
            return Err(BridgeError::ForeignType {
                topic: self.topic.clone(),
                found,
                type_name,
            });
        }
        match self.commands.writers(session) {
            0 => Ok(false),
            1 => Ok(true),
            count => Err(BridgeError::Writers {
                topic: self.topic.clone(),
                count,
            }),
        }
    }

    /// The error of a start without a node that reads `odometry`, or that writes the commands if `is_read`.
    pub fn no_node(
        &self,
        session: &Session,
        odometry: String,
        is_read: bool,
        timeout: Duration,
    ) -> BridgeError {
        let lack = if is_read {
            format!("writes {}", self.topic)
        } else {
            format!("reads {odometry}")
        };
        BridgeError::NoNode {
            topic: self.topic.clone(),
            odometry,
            lack,
            domain: session.domain(),
            timeout_s: timeout.as_secs_f64(),
            type_name: self.commands.type_name(),
        }
    }

    /// Checks that no command has arrived since the one of tick `tick`.
    ///
    /// # Errors
    /// [`BridgeError::SecondCommand`]; [`BridgeError::Transfer`].
    pub fn expect_none(&self, tick: u64) -> Result<(), BridgeError> {
        match self.commands.take()? {
            None => Ok(()),
            Some(command) => Err(BridgeError::SecondCommand {
                topic: self.topic.clone(),
                tick,
                v: command.v,
                omega: command.omega,
            }),
        }
    }

    /// Waits for the command of a tick; `stamp` is the time of its state, `before` that of the state before.
    ///
    /// # Errors
    /// [`BridgeError::NoCommand`], [`BridgeError::Stamp`], [`BridgeError::Transfer`].
    pub fn wait(
        &self,
        session: &Session,
        tick: u64,
        [stamp, before]: &[Time; 2],
        timeout: Duration,
    ) -> Result<RobotCommand, BridgeError> {
        let Some(command) = self.commands.wait(Instant::now() + timeout)? else {
            let is_written = self.is_written(session)?;
            return Err(BridgeError::NoCommand {
                topic: self.topic.clone(),
                tick,
                timeout_s: timeout.as_secs_f64(),
                state: if is_written {
                    "its node is there and does not answer"
                } else {
                    "its node has gone"
                },
            });
        };
        // The clock of a node that answers the data of a tick is still that of the tick before.
        match &command.stamp {
            Some(found) if found != stamp && found != before => Err(BridgeError::Stamp {
                topic: self.topic.clone(),
                tick,
                stamp_s: seconds(found),
                expected_s: seconds(stamp),
            }),
            _ => Ok(command),
        }
    }

    /// The newest command that has arrived; `None` if there is none.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`].
    pub fn newest(&self) -> Result<Option<RobotCommand>, BridgeError> {
        let mut newest = None;
        while let Some(command) = self.commands.take()? {
            newest = Some(command);
        }
        Ok(newest)
    }
}

/// A time (s).
fn seconds(time: &Time) -> f64 {
    f64::from(time.sec) + f64::from(time.nanosec) * 1e-9
}
