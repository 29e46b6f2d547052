//! What people see: the run in the standard schemas of the viewers (Foxglove, Lichtblick, Rerun),
//! beside the lossless topics.
//!
//! Everything of one tick is gathered and drawn when the tick is complete, at most
//! `rate_hz` times per simulated second; the first and the last state and every tick at which
//! something happened are always drawn. Every message is a whole picture of its topic, so that a
//! viewer that jumps in time shows the right thing from the one message before. What seldom changes
//! is drawn again now and then (see `again`).

mod again;
mod channel;
mod dominance;
mod grid;
mod palette;
mod points;
mod robot_lines;
mod scene;
mod shapes;
mod sight;
mod visibility;
mod walls;
mod words;

use foxglove::Encode;
use ipc_types::consumer::{Consumer, Consumers, LoggedMessage};
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{TopicId, WorldEvents, WorldState};

use self::channel::ViewerChannel;
use super::derived::{Derived, DerivedChannel, DerivedMessages};
use super::options::{RecorderOptions, RobotInfo};

/// Frame in which everything stands.
const MAP_FRAME: &str = "map";
/// Frame in the middle of the map, for viewers to look at: no robot is called so.
const CENTRE_FRAME: &str = "map/centre";

/// The viewer topics of a run. Each is a consumer that draws messages when they come, or their tick at
/// its end; adding one is a file and a line here. The order is that of the channels in the log.
fn topics(run: &RecorderOptions, picture: &mut Picture) -> Vec<Box<Topic>> {
    vec![
        Box::new(scene::RobotsTopic::new(run, picture)),
        Box::new(grid::MapTopic::new(picture)),
        Box::new(walls::WallsTopic::new(picture)),
        Box::new(sight::SightTopic::new(picture)),
        Box::new(visibility::VisibilityTopic::new(run, picture)),
        Box::new(dominance::DominanceTopic::new(picture)),
        Box::new(shapes::ObstaclesTopic::new(run, picture)),
        Box::new(robot_lines::LinesTopic::plans(picture)),
        Box::new(robot_lines::LinesTopic::trees(picture)),
        Box::new(words::LogTopic::new(run, picture)),
        Box::new(points::ParticlesTopic::new(picture)),
        Box::new(points::ScansTopic::new(picture)),
    ]
}

type Topic = dyn Consumer<Picture> + Send;

/// Draws a run.
pub(super) struct Viewer {
    takes: Vec<TopicId>,
    topics: Consumers<Topic>,
    picture: Picture,
}

/// The present tick as all viewer topics see it, and where they draw.
#[derive(Debug)]
struct Picture {
    robots: Vec<RobotInfo>,
    /// The newest states of the robots.
    states: Vec<RobotState>,
    /// Time of these states (simulated ns); `None` before the first.
    time_ns: Option<u64>,
    /// Whether the tick must be drawn even if no picture is due.
    wanted: bool,
    drawn: bool,
    /// Time from which the next picture is due (simulated ns).
    due_ns: u64,
    period_ns: u64,
    channels: Vec<DerivedChannel>,
    ready: DerivedMessages,
}

impl Viewer {
    /// Of a run before its first tick; `None` if no viewer topics are wanted.
    pub(super) fn new(run: &RecorderOptions) -> Option<Self> {
        let rate_hz = run.viewer.rate_hz;
        if rate_hz.is_nan() || rate_hz <= 0.0 {
            return None;
        }
        let mut picture = Picture {
            robots: run.robots.clone(),
            states: Vec::new(),
            time_ns: None,
            wanted: false,
            drawn: false,
            due_ns: 0,
            // At least 1 ns: a rate beyond 1 GHz draws every tick.
            period_ns: ((1e9 / rate_hz) as u64).max(1),
            channels: Vec::new(),
            ready: DerivedMessages::default(),
        };
        let topics = Consumers::new(topics(run, &mut picture));
        let takes = TopicId::ALL.iter().copied();
        Some(Self {
            takes: takes
                .filter(|topic| Picture::TAKES.contains(topic) || topics.take(*topic))
                .collect(),
            topics,
            picture,
        })
    }
}

impl Consumer for Viewer {
    fn topics(&self) -> &[TopicId] {
        &self.takes
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        self.picture.message(message);
        self.topics.message(message, &mut self.picture);
    }

    /// Draws the tick if it is due or wanted.
    fn end_of_tick(&mut self, (): &mut ()) {
        let Some(time_ns) = self.picture.time_ns else {
            return;
        };
        if self.picture.drawn || !self.picture.is_drawing(time_ns) {
            return;
        }
        self.picture.drawn = true;
        if time_ns >= self.picture.due_ns {
            // On the grid of the rate: pictures of all topics fall on the same ticks.
            let period_ns = self.picture.period_ns;
            self.picture.due_ns = (time_ns / period_ns + 1).saturating_mul(period_ns);
        }
        self.topics.end_of_tick(&mut self.picture);
    }
}

impl Derived for Viewer {
    fn channels(&self) -> &[DerivedChannel] {
        &self.picture.channels
    }

    fn ready(&mut self) -> &mut DerivedMessages {
        &mut self.picture.ready
    }

    /// Draws the last state if it has not been drawn.
    fn finish(&mut self) {
        self.picture.wanted = true;
        self.end_of_tick(&mut ());
    }
}

impl Picture {
    const TAKES: [TopicId; 2] = [TopicId::WorldState, TopicId::WorldEvents];

    fn message(&mut self, message: &LoggedMessage<'_>) {
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
        // A tick at which something happens is drawn.
        let events = message.view::<WorldEvents>();
        self.wanted |= events.is_some_and(|(_, events)| events.len() > 0) && self.time_ns.is_some();
    }

    /// Whether the present tick will be drawn, so that what belongs to it is worth decoding.
    fn is_drawing(&self, time_ns: u64) -> bool {
        time_ns >= self.due_ns || self.wanted
    }

    /// Time of the states (simulated ns).
    fn now_ns(&self) -> u64 {
        self.time_ns.unwrap_or(0)
    }

    fn add_channel<M: Encode>(&mut self, topic: &str) -> ViewerChannel<M> {
        ViewerChannel::add(&mut self.channels, topic)
    }

    /// A channel for every robot: `/viewer/PREFIX/NAME`.
    fn add_channels<M: Encode>(&mut self, prefix: &str) -> Vec<ViewerChannel<M>> {
        let names = self.robots.iter().map(|robot| robot.name.clone());
        let topics: Vec<String> = names
            .map(|name| format!("/viewer/{prefix}/{name}"))
            .collect();
        topics.iter().map(|topic| self.add_channel(topic)).collect()
    }
}

/// Simulated time as viewers want it.
fn timestamp(time_ns: u64) -> foxglove::messages::Timestamp {
    // A run of more than 136 years ends at the largest time.
    let seconds = u32::try_from(time_ns / 1_000_000_000).unwrap_or(u32::MAX);
    foxglove::messages::Timestamp::new(seconds, (time_ns % 1_000_000_000) as u32)
}
