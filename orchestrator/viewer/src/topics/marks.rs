//! Elements of topics that declare how they are drawn.

use draw::palette::{BELIEF, NEUTRAL, OBSTACLE, rgb};
use geometry::math::sincos;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::marks::{DrawnFields, Mark};
use ipc_types::topics::TopicId;

use super::channel::ViewerChannel;
use super::palette::color;
use super::picture::Picture;
use super::primitives::{kind, marker, picture, width};
use ros_messages::messages::{MarkerArray, Point, Vector3};

/// Colours of the topics, in turn.
const COLOURS: [&str; 3] = [BELIEF, OBSTACLE, NEUTRAL];
/// Height of the marks (m): above plans.
const HEIGHT: f64 = 0.08;

/// `/marks`: the points, arrows and circles of a tick, by topic.
pub(super) struct MarksTopic {
    takes: Vec<TopicId>,
    topics: Vec<(DrawnFields, Vec<Mark>)>,
    channel: ViewerChannel<MarkerArray>,
}

impl MarksTopic {
    /// Creates it; `None` if no topic declares how it is drawn.
    pub(super) fn new(picture: &mut Picture) -> Option<Self> {
        let drawn = |topic: TopicId| Some((topic, DrawnFields::from_facts(topic.facts()).ok()??));
        let (takes, topics): (Vec<_>, Vec<_>) = TopicId::all()
            .filter_map(drawn)
            .map(|(topic, drawn)| (topic, (drawn, Vec::new())))
            .unzip();
        (!takes.is_empty()).then(|| Self {
            takes,
            topics,
            channel: picture.add_channel("/marks"),
        })
    }
}

impl Consumer<Picture> for MarksTopic {
    fn topics(&self) -> &[TopicId] {
        &self.takes
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        let place = self.takes.iter().position(|topic| *topic == message.topic);
        if picture.is_drawing(message.time_ns)
            && let Some((drawn, marks)) = place.and_then(|place| self.topics.get_mut(place))
        {
            marks.extend(drawn.marks(message.bytes));
        }
    }

    fn end_of_tick(&mut self, picture_of_tick: &mut Picture) {
        let (time_ns, line) = (picture_of_tick.now_ns(), picture_of_tick.line_width());
        let mut all = picture(time_ns);
        let point = |[x, y]: [f64; 2]| Point { x, y, z: HEIGHT };
        for ((topic, (_, marks)), colour) in self
            .takes
            .iter()
            .zip(&mut self.topics)
            .zip(COLOURS.into_iter().cycle())
        {
            let colour = color(rgb(colour), 0.9);
            let marks = core::mem::take(marks);
            let points = marks.iter().filter(|mark| mark.is_point());
            let points: Vec<Point> = points.map(|mark| point(mark.at)).collect();
            let lines = marks.iter().flat_map(|mark| mark.lines(sincos)).flatten();
            let lines: Vec<Point> = lines.map(point).collect();
            let size = 3.0 * line;
            let cube = Vector3 {
                x: size,
                y: size,
                z: size,
            };
            for (id, kind, scale, points) in [
                (0, kind::CUBE_LIST, cube, points),
                (1, kind::LINE_LIST, width(line), lines),
            ] {
                if !points.is_empty() {
                    let mut drawn = marker(topic.name(), id, kind, colour.clone(), time_ns);
                    drawn.scale = scale;
                    drawn.points = points;
                    all.markers.push(drawn);
                }
            }
        }
        self.channel
            .write(&mut picture_of_tick.ready, time_ns, &all);
    }
}
