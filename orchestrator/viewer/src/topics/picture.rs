//! State of the current tick, shared by all viewer topics, and their output.

use ipc_types::consumer::LoggedMessage;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{TopicId, WorldEvents, WorldState};
use recorder::{DerivedChannel, DerivedMessages, RobotInfo};

use super::channel::ViewerChannel;
use ros_messages::RosType;

/// State of the current tick, shared by all viewer topics, and their output.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) robots: Vec<RobotInfo>,
    /// Newest states of the robots.
    pub(super) states: Vec<RobotState>,
    /// Time of these states (simulated ns); `None` before the first.
    time_ns: Option<u64>,
    /// `true` if the tick must be drawn even if no picture is due.
    pub(super) wanted: bool,
    drawn: bool,
    /// Time at which the next picture is due (simulated ns).
    due_ns: u64,
    period_ns: u64,
    pub(super) channels: Vec<DerivedChannel>,
    pub(super) ready: DerivedMessages,
}

impl Picture {
    /// Topics that update the picture.
    pub(super) const TAKES: [TopicId; 2] = [TopicId::WorldState, TopicId::WorldEvents];

    /// Creates the picture before the first tick; `rate_hz` is the rate (Hz, simulated), > 0.
    pub(super) fn new(robots: &[RobotInfo], rate_hz: f64) -> Self {
        Self {
            robots: robots.to_vec(),
            states: Vec::new(),
            time_ns: None,
            wanted: false,
            drawn: false,
            due_ns: 0,
            // At least 1 ns: a rate beyond 1 GHz draws every tick.
            period_ns: ((1e9 / rate_hz) as u64).max(1),
            channels: Vec::new(),
            ready: DerivedMessages::default(),
        }
    }

    /// Updates the picture with the state and the events of a tick.
    pub(super) fn message(&mut self, message: &LoggedMessage<'_>) {
        if let Some((header, robots)) = message.view::<WorldState>() {
            // A new tick begins with this state.
            let is_first = self.time_ns.is_none();
            let is_last = header.phase == WorldHeader::OVER;
            self.states.clear();
            self.states.extend(robots);
            self.time_ns = Some(message.time_ns);
            self.wanted = is_first || is_last;
            self.drawn = false;
        }
        // Ticks with events are drawn.
        let events = message.view::<WorldEvents>();
        self.wanted |= events.is_some_and(|(_, events)| events.len() > 0) && self.time_ns.is_some();
    }

    /// Returns `true` if the current tick will be drawn and its messages need decoding.
    pub(super) fn is_drawing(&self, time_ns: u64) -> bool {
        time_ns >= self.due_ns || self.wanted
    }

    /// Begins drawing at the end of a tick; returns `true` if the topics draw it.
    pub(super) fn begin_drawing(&mut self) -> bool {
        let Some(time_ns) = self.time_ns else {
            return false;
        };
        if self.drawn || !self.is_drawing(time_ns) {
            return false;
        }
        self.drawn = true;
        if time_ns >= self.due_ns {
            // Multiples of the period: pictures of all topics are on the same ticks.
            self.due_ns = (time_ns / self.period_ns + 1).saturating_mul(self.period_ns);
        }
        true
    }

    /// Returns the time of the states (simulated ns).
    pub(super) fn now_ns(&self) -> u64 {
        self.time_ns.unwrap_or(0)
    }

    /// Adds a channel to the log.
    pub(super) fn add_channel<M: RosType>(&mut self, topic: &str) -> ViewerChannel<M> {
        ViewerChannel::add(&mut self.channels, topic, false)
    }

    /// Adds a channel whose last message late joiners get.
    pub(super) fn add_latched_channel<M: RosType>(&mut self, topic: &str) -> ViewerChannel<M> {
        ViewerChannel::add(&mut self.channels, topic, true)
    }

    /// Adds a channel for every robot: `/ROBOT/NAME`.
    pub(super) fn add_robot_channels<M: RosType>(&mut self, name: &str) -> Vec<ViewerChannel<M>> {
        let topics = self
            .robots
            .iter()
            .map(|robot| format!("/{}/{name}", robot.name));
        let topics: Vec<String> = topics.collect();
        topics.iter().map(|topic| self.add_channel(topic)).collect()
    }

    /// Returns the width of lines (m) that suits the size of the robots.
    pub(super) fn line_width(&self) -> f64 {
        let largest = self.robots.iter().map(|robot| robot.radius);
        largest.reduce(f64::max).unwrap_or(0.1) * 0.3
    }
}
