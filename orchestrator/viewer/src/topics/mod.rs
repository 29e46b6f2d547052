//! The viewer topics: a run in the messages that ROS 2 tools and viewers draw, beside the lossless topics. Their names
//! begin with `/`; those of the lossless topics do not.
//!
//! The topics draw complete ticks, at most `rate_hz` times per simulated second, and always the first and the
//! last state and every tick with an event. Every message is a complete picture of its topic, so that after a
//! seek one message is sufficient. Pictures that seldom change are repeated (see `repetition`).

mod channel;
mod dominance;
mod grid;
mod log;
mod map;
mod marks;
mod obstacles;
mod palette;
mod picture;
mod points;
mod primitives;
mod repetition;
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

/// Creates the viewer topics of a run, in the order of the channels in the log. Each one is a consumer that
/// draws messages on arrival or at the end of their tick; a new topic takes a file and a line here.
fn topics(run: &RunInfo, options: &ViewerOptions, picture: &mut Picture) -> Vec<Box<Topic>> {
    let mut topics: Vec<Box<Topic>> = vec![
        Box::new(robots::RobotsTopic::new(options.trail_s, picture)),
        Box::new(map::MapTopic::new(picture)),
        Box::new(walls::WallsTopic::new(picture)),
        Box::new(sight::SightTopic::new(picture)),
        Box::new(visibility::VisibilityTopic::new(
            &run.fields_of_view,
            picture,
        )),
        Box::new(dominance::DominanceTopic::new(picture)),
        Box::new(obstacles::ObstaclesTopic::new(&options.obstacles, picture)),
        Box::new(robot_lines::LinesTopic::plans(picture)),
        Box::new(robot_lines::LinesTopic::trees(picture)),
        Box::new(log::LogTopic::new(run, picture)),
        Box::new(points::BeliefsTopic::new(picture)),
        Box::new(points::ScansTopic::new(picture)),
    ];
    if let Some(marks) = marks::MarksTopic::new(picture) {
        topics.push(Box::new(marks));
    }
    topics
}

type Topic = dyn Consumer<Picture> + Send;

/// Options of the viewer topics.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewerOptions {
    /// Pictures per simulated second; 0 for no viewer topics at all.
    pub rate_hz: f64,
    /// Duration of a robot's trail (simulated s); 0 for none.
    pub trail_s: f64,
    /// Obstacles that exist from the beginning.
    pub obstacles: Vec<ObstacleEvent>,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            trail_s: 5.0,
            obstacles: Vec::new(),
        }
    }
}

/// Creates the viewer topics of a run; returns `None` if the rate is 0.
///
/// ```
/// use viewer::{ViewerOptions, viewer_topics};
///
/// let run = recorder::RunInfo::default();
/// let topics = viewer_topics(&run, &ViewerOptions::default()).unwrap();
/// assert_eq!(topics.channels()[0].topic, "/robots");
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
    Some(Box::new(ViewerTopics {
        takes: TopicId::all()
            .filter(|topic| Picture::TAKES.contains(topic) || topics.take(*topic))
            .collect(),
        topics,
        picture,
    }))
}

/// All viewer topics of a run, with their shared picture.
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

    /// Draws the tick if it is due or required.
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
