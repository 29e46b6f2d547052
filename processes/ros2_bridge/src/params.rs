//! Parameters of the bridge.

use parameters::{Parameters, above, between};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Type of the messages in `cmd_vel`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CommandType {
    /// `geometry_msgs/Twist`.
    #[default]
    Twist,
    /// `geometry_msgs/TwistStamped`; its time is that of the state that the command answers, or 0.
    TwistStamped,
    /// None: nodes only watch, and the process has neither `team` nor `robots`.
    None,
}

/// Order of the messages of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// All data of a tick, then `/clock`: a timer of a node computes from the data of its tick.
    #[default]
    DataFirst,
    /// `/clock`, then the data, as most simulators do: a timer may compute from the data of an earlier tick, in each run
    /// of another one.
    ClockFirst,
}

/// Parameters of a `ros2_bridge`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Ros2BridgeParams {
    /// Domain of ROS 2 (`ROS_DOMAIN_ID`).
    #[schemars(transform = between(0, 101))]
    pub domain: u16,
    /// Type of the messages in `cmd_vel`.
    pub commands: CommandType,
    /// Speak to nodes of this machine only, over its loopback interface.
    pub loopback: bool,
    /// Time for which the process waits for its nodes at the start.
    #[schemars(transform = above(0).unit("s"))]
    pub start_timeout_s: f64,
    /// Time for which a tick waits for the command of a robot, in lock-step; less than `run.hang_timeout_s`.
    #[schemars(transform = above(0).unit("s"))]
    pub answer_timeout_s: f64,
    /// Order of the messages of a tick.
    pub order: Order,
    /// Robot whose topics and frames have no namespace (`/odom`, `base_link`), as those of the one robot of Nav2.
    pub root: String,
    /// Robots outside of the simulation, in real time: each is where its `/ROBOT/odom` says, and `/ROBOT/cmd_vel` has the
    /// commands of its planner.
    pub source: Vec<String>,
    /// Age of the odometry of such a robot, and of the commands of its planner, from which on it is told to stop.
    #[schemars(transform = above(0).unit("s"))]
    pub source_deadline_s: f64,
    /// Topics of the run that are published as they are in its log: `world/event` as `/world/event`, of type
    /// `protean/WorldEvent`.
    pub topics: Vec<String>,
}

impl Default for Ros2BridgeParams {
    fn default() -> Self {
        Self {
            domain: 0,
            commands: CommandType::Twist,
            loopback: true,
            start_timeout_s: 30.0,
            answer_timeout_s: 5.0,
            order: Order::DataFirst,
            root: String::new(),
            source: Vec::new(),
            source_deadline_s: 0.5,
            topics: Vec::new(),
        }
    }
}

impl Parameters for Ros2BridgeParams {}
