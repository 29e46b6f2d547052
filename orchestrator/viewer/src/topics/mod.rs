//! The `/viewer/…` topics: a run in the standard schemas of the viewers (Foxglove, Lichtblick, Rerun),
//! beside the lossless topics.
//!
//! The topics draw a tick when it is complete, at most `rate_hz` times per simulated second, and
//! always the first and the last state and every tick at which something happened. Every message is
//! a whole picture of its topic, so that a viewer that jumps in time shows the right thing from the
//! one message before. What seldom changes is drawn again now and then (see `again`).

mod again;
mod channel;
mod dominance;
mod grid;
mod log;
mod map;
mod obstacles;
mod palette;
mod picture;
mod points;
mod primitives;
mod robot_lines;
mod robots;
mod sight;
mod visibility;
mod walls;

use ipc_types::consumer::{Consumer, Consumers, LoggedMessage};
use ipc_types::messages::world::ObstacleEvent;
use ipc_types::topics::TopicId;
use recorder::{DerivedChannel, DerivedMessages, DerivedTopics, RunInfo};

use self::picture::Picture;
use crate::field_of_view::FieldOfView;

/// The viewer topics of a run. Each is a consumer that draws messages when they come, or their tick at
/// its end; adding one is a file and a line here. The order is that of the channels in the log.
fn topics(run: &RunInfo, options: &ViewerOptions, picture: &mut Picture) -> Vec<Box<Topic>> {
    vec![
        Box::new(robots::RobotsTopic::new(options.trail_s, picture)),
        Box::new(map::MapTopic::new(picture)),
        Box::new(walls::WallsTopic::new(picture)),
        Box::new(sight::SightTopic::new(picture)),
        Box::new(visibility::VisibilityTopic::new(
            &options.fields_of_view,
            picture,
        )),
        Box::new(dominance::DominanceTopic::new(picture)),
        Box::new(obstacles::ObstaclesTopic::new(&options.obstacles, picture)),
        Box::new(robot_lines::LinesTopic::plans(picture)),
        Box::new(robot_lines::LinesTopic::trees(picture)),
        Box::new(log::LogTopic::new(&run.processes, picture)),
        Box::new(points::ParticlesTopic::new(picture)),
        Box::new(points::ScansTopic::new(picture)),
    ]
}

type Topic = dyn Consumer<Picture> + Send;

/// What viewers get to see.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewerOptions {
    /// Pictures per simulated second; 0 for no viewer topics at all.
    pub rate_hz: f64,
    /// How long a robot's trail stays visible (simulated s); 0 for none.
    pub trail_s: f64,
    /// Obstacles that stand from the beginning.
    pub obstacles: Vec<ObstacleEvent>,
    /// What is drawn as seen.
    pub fields_of_view: Vec<FieldOfView>,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            trail_s: 5.0,
            obstacles: Vec::new(),
            fields_of_view: Vec::new(),
        }
    }
}

/// The viewer topics of a run before its first tick; `None` if no viewer topics are wanted.
///
/// ```
/// use viewer::{ViewerOptions, viewer_topics};
///
/// let run = recorder::RunInfo::default();
/// let topics = viewer_topics(&run, &ViewerOptions::default()).unwrap();
/// assert_eq!(topics.channels()[0].topic, "/viewer/scene");
///
/// let off = ViewerOptions { rate_hz: 0.0, ..ViewerOptions::default() };
/// assert!(viewer_topics(&run, &off).is_none());
/// ```
pub fn viewer_topics(run: &RunInfo, options: &ViewerOptions) -> Option<Box<dyn DerivedTopics>> {
    let rate_hz = options.rate_hz;
    if rate_hz.is_nan() || rate_hz <= 0.0 {
        return None;
    }
    let mut picture = Picture::new(&run.robots, rate_hz);
    let topics = Consumers::new(topics(run, options, &mut picture));
    let takes = TopicId::ALL.iter().copied();
    Some(Box::new(ViewerTopics {
        takes: takes
            .filter(|topic| Picture::TAKES.contains(topic) || topics.take(*topic))
            .collect(),
        topics,
        picture,
    }))
}

/// All viewer topics of a run, over one picture.
struct ViewerTopics {
    takes: Vec<TopicId>,
    topics: Consumers<Topic>,
    picture: Picture,
}

impl Consumer for ViewerTopics {
    fn topics(&self) -> &[TopicId] {
        &self.takes
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        self.picture.message(message);
        self.topics.message(message, &mut self.picture);
    }

    /// Draws the tick if it is due or wanted.
    fn end_of_tick(&mut self, (): &mut ()) {
        if self.picture.begin_drawing() {
            self.topics.end_of_tick(&mut self.picture);
        }
    }
}

impl DerivedTopics for ViewerTopics {
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
