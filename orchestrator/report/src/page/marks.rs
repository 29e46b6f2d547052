//! Layer of the topics that declare how their elements are drawn.

use std::path::Path;

use geometry::math::sincos;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::marks::DrawnFields;
use ipc_types::topics::TopicId;
use mcap_log::known;
use mcap_log::reader::{Item, Reader};

use super::pack::{Lists, Raster, pack_time};
use super::thinning::ThinnedSeries;
use crate::run_model::LoggedRun;

/// Minimum time between two messages of a topic and a sender (ns).
const INTERVAL: u64 = 100_000_000;
/// Maximum number of lines of a message, and of all messages.
const LINES: usize = 2000;
const ALL_LINES: usize = 200_000;
/// Factor of a topic in the keys of its senders.
const SENDERS: u32 = 1 << 16;

/// Lines of the marks of each topic, by topic and sender; a point is a line without length.
#[derive(Debug, Clone)]
pub struct Marks {
    takes: Vec<TopicId>,
    drawn: Vec<DrawnFields>,
    lines: ThinnedSeries<Vec<[[f64; 2]; 2]>>,
}

impl Marks {
    /// Returns the empty layer of the topics in a log, whose channels precede the first message, and `true` if the log
    /// has a message.
    pub(super) fn from_log(log: &Path) -> (Self, bool) {
        let mut marks = Self {
            takes: Vec::new(),
            drawn: Vec::new(),
            lines: ThinnedSeries::new(INTERVAL, ALL_LINES, |lines| lines.len() + 2),
        };
        // A log that cannot be read is reported where all of it is read.
        let Ok(mut reader) = Reader::open(log, None) else {
            return (marks, false);
        };
        while let Ok(Some(item)) = reader.next() {
            match item {
                Item::Channel(channel) => {
                    if let Some(topic) = known::topic_of(&channel)
                        && let Ok(Some(drawn)) = DrawnFields::from_facts(topic.facts())
                        && !marks.takes.contains(&topic)
                    {
                        marks.takes.push(topic);
                        marks.drawn.push(drawn);
                    }
                }
                Item::Message(..) => return (marks, true),
                _ => {}
            }
        }
        (marks, false)
    }

    /// Returns the names of the topics.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.takes.iter().map(|topic| topic.name()).collect()
    }

    /// Packs times, topics, numbers of lines and their ends; moves the lines out.
    pub(super) fn pack(&mut self, raster: Raster, lists: &mut Lists) {
        let lines = core::mem::replace(&mut self.lines, ThinnedSeries::new(0, 0, Vec::len));
        let all = lines.finish();
        let times = all.iter().map(|sample| pack_time(sample.time_ns));
        lists.u32("marks.time", times.collect(), 1);
        let topics = all.iter().map(|sample| (sample.key / SENDERS) as u8);
        lists.u8("marks.topic", topics.collect(), 0);
        let senders = all.iter().map(|sample| (sample.key % SENDERS) as u16);
        lists.u16("marks.sender", senders.collect(), 0);
        let counts = all.iter().map(|sample| sample.item.len() as u32);
        lists.u32("marks.count", counts.collect(), 1);
        let ends = all.iter().flat_map(|sample| sample.item.iter().flatten());
        let (x, y) = ends
            .map(|&end| raster.pack(end))
            .map(|[x, y]| (x, y))
            .unzip();
        lists.u16("marks.x", x, 1);
        lists.u16("marks.y", y, 1);
    }
}

impl Consumer<LoggedRun> for Marks {
    fn topics(&self) -> &[TopicId] {
        &self.takes
    }

    fn message(&mut self, message: &LoggedMessage<'_>, _: &mut LoggedRun) {
        let Some(place) = self.takes.iter().position(|topic| *topic == message.topic) else {
            return;
        };
        let mut lines = Vec::new();
        for mark in self.drawn[place].marks(message.bytes) {
            if mark.is_point() {
                lines.push([mark.at; 2]);
            }
            lines.extend(mark.lines(sincos));
        }
        lines.truncate(LINES);
        let key = (place as u32).min(255) * SENDERS + message.stamp.source % SENDERS;
        self.lines.push(message.time_ns, key, lines);
    }
}
