//! Errors of the bridge.

use thiserror::Error;

/// Reasons for which a run with ROS 2 nodes cannot begin or go on.
#[derive(Debug, Error)]
pub enum BridgeError {
    /// The participant, or one of its topics, cannot be created.
    #[error("ROS 2 domain {domain}: {what} cannot be created: {reason}")]
    Create {
        /// The domain.
        domain: u16,
        /// Name of the part.
        what: String,
        /// Cause of the library.
        reason: String,
    },
    /// The name of a robot is not a name of ROS 2.
    #[error(
        "robot name {name} is not a namespace of ROS 2: expected letters, digits and underscores, no digit first"
    )]
    Name {
        /// Name of the robot.
        name: String,
    },
    /// A robot outside of the simulation is not of the run.
    #[error("source = {name}: expected names of robots of the scenario")]
    Source {
        /// The name.
        name: String,
    },
    /// The run is in lock-step, but a robot is outside of the simulation.
    #[error(
        "robots in `source` are outside of the simulation, which cannot wait for them: expected a run with --real-time"
    )]
    LockStep,
    /// A robot outside of the simulation sends no odometry at the start.
    #[error("no message in {topic} within {timeout_s} s: expected nav_msgs/Odometry of the robot")]
    NoOdometry {
        /// The topic.
        topic: String,
        /// Time waited (s).
        timeout_s: f64,
    },
    /// Nodes are missing at the start.
    #[error(
        "no node {lack} in ROS 2 domain {domain} within {timeout_s} s: expected a node that reads {odometry} and \
         writes {topic} of type {type_name}"
    )]
    NoNode {
        /// The topic without a node.
        topic: String,
        /// Topic of the odometry of the robot.
        odometry: String,
        /// Role that no node has, in words.
        lack: String,
        /// The domain.
        domain: u16,
        /// Time waited (s).
        timeout_s: f64,
        /// Type of the commands.
        type_name: String,
    },
    /// A node writes commands of another type.
    #[error("a node writes {topic} as {found}: expected {type_name}; see `commands`")]
    ForeignType {
        /// The topic.
        topic: String,
        /// Type of the node, in the form of DDS.
        found: String,
        /// Type of the commands.
        type_name: String,
    },
    /// Another node writes the time.
    #[error(
        "another node writes /clock in ROS 2 domain {domain}: expected one bridge for all robots of a run \
         (`grouping = \"together\"`), and a domain for each run"
    )]
    SecondClock {
        /// The domain.
        domain: u16,
    },
    /// Several nodes write the commands of a robot.
    #[error("{count} nodes write {topic}: expected 1")]
    Writers {
        /// The topic.
        topic: String,
        /// Number of writers.
        count: usize,
    },
    /// A tick has no command of a robot.
    #[error(
        "tick {tick}: no command in {topic} within {timeout_s} s: {state}; \
         expected one command for each state"
    )]
    NoCommand {
        /// The topic.
        topic: String,
        /// The tick.
        tick: u64,
        /// Time waited (s).
        timeout_s: f64,
        /// State of the node, in words.
        state: &'static str,
    },
    /// A tick has more than one command of a robot.
    #[error(
        "tick {tick}: a second command in {topic}, v = {v}, omega = {omega}: expected one command for each state"
    )]
    SecondCommand {
        /// The topic.
        topic: String,
        /// The tick that it follows.
        tick: u64,
        /// Forward speed of the command (m/s).
        v: f64,
        /// Turning rate of the command (rad/s).
        omega: f64,
    },
    /// A command has the time of another tick.
    #[error(
        "tick {tick}: the command in {topic} has the time {stamp_s} s: expected {expected_s} s, or 0"
    )]
    Stamp {
        /// The topic.
        topic: String,
        /// The tick.
        tick: u64,
        /// Time of the command (s).
        stamp_s: f64,
        /// Time of the state (s).
        expected_s: f64,
    },
    /// A message cannot be sent or read.
    #[error("ROS 2 topic {topic}: cannot be {attempt}: {reason}")]
    Transfer {
        /// The topic.
        topic: String,
        /// `read` or `written`.
        attempt: &'static str,
        /// Cause of the library.
        reason: String,
    },
}
