//! A run, read from its log in one pass for pictures and pages.

use std::collections::BTreeMap;
use std::path::Path;

use geometry::map::ObstacleChange;
use ipc_types::cdr::DecodeError;
use ipc_types::consumer::{Consumer, Consumers, LoggedMessage};
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{ObstacleEvents, Topic, TopicId, WorldMap, WorldState};
use mcap_log::MessageHeader;
use mcap_log::known;
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::{Condition, LogReadError, ReadProgress};
use recorder::PatrolMeasurement;

use super::facts::Facts;
use scenario::spec::{MAX_EVENTS, MAX_ROBOTS};

/// Maximum number of notes on unreadable content.
const MAX_NOTES: usize = 50;
/// Maximum coordinate of a world (m); things beyond are not shown.
const MAX_COORDINATE: f64 = 1e6;

/// Purpose of reading a log.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Purpose {
    /// A picture of a moment (ns): uses the newest map; fails if a message cannot be read.
    Picture {
        /// The moment; later messages only determine the end of the run.
        until_ns: u64,
    },
    /// A page of the whole run: uses the first map; notes messages that cannot be read.
    #[default]
    Page,
}

/// State of a run after the part of the log that has been read; all consumers of messages share it.
#[derive(Debug, Clone, Default)]
pub struct LoggedRun {
    purpose: Purpose,
    /// Topics and numbers of messages by channel.
    channels: BTreeMap<u16, (TopicId, u64)>,
    /// `true` if the last message of the reader is still to be taken.
    holds: bool,
    /// Facts from metadata and attachments.
    pub(crate) facts: Facts,
    /// The newest states of the robots.
    pub(crate) states: Vec<RobotState>,
    /// Time of these states (ns); `None` before the first.
    pub(crate) now_ns: Option<u64>,
    /// Simulated time between two ticks (ns); 0 before the first state.
    pub(crate) tick_period_ns: u64,
    /// `true` if the newest state is that of the end of the game.
    pub(crate) over: bool,
    /// Time of the last state in the log (ns).
    pub(crate) end_ns: u64,
    /// Time of the last message in the log (ns).
    pub(crate) last_ns: u64,
    /// Patrols up to the newest state; none before the first.
    pub(crate) patrols: Vec<PatrolMeasurement>,
    /// Changes of the obstacles, with the times at which they were due (ns).
    pub(crate) changes: Vec<(u64, ObstacleChange)>,
    /// Messages by topic.
    pub(crate) counts: BTreeMap<String, u64>,
    /// Notes on unreadable content.
    pub(crate) notes: Vec<String>,
    failure: Option<DecodeError>,
    /// Condition of the log.
    pub(crate) condition: Condition,
}

impl LoggedRun {
    /// Reads a log up to its end or the first damaged record, and passes its messages to consumers.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read or is not a Protean log; or its states (for a
    /// picture, any message that it shows) are damaged or of another version.
    pub(crate) fn read(
        log: &Path,
        purpose: Purpose,
        consumers: Vec<Box<dyn Consumer<Self> + '_>>,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let mut run = Self::new(purpose);
        run.read_on(&mut reader, u64::MAX, consumers)?;
        reader.check_all()?;
        run.end(&reader);
        Ok(run)
    }

    /// Creates the state before the first record.
    pub(crate) fn new(purpose: Purpose) -> Self {
        Self {
            purpose,
            ..Self::default()
        }
    }

    /// Reads on to the first message after a time (ns), or to the end.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn read_on(
        &mut self,
        reader: &mut Reader<'_>,
        until_ns: u64,
        consumers: Vec<Box<dyn Consumer<Self> + '_>>,
    ) -> Result<(), LogReadError> {
        let log = reader.path().to_owned();
        let mut consumers = Consumers::new(consumers);
        loop {
            let item = if core::mem::take(&mut self.holds) {
                let last = reader.last_message();
                last.map(|(header, data)| Item::Message(header, data))
            } else {
                reader.next()?
            };
            match item {
                None => return Ok(()),
                Some(Item::Channel(channel)) => {
                    self.check_layout(&log, &channel, &consumers)?;
                    if let Some(topic) = known::topic_of(&channel) {
                        self.channels.entry(channel.id).or_insert((topic, 0));
                    }
                }
                Some(Item::Message(header, _)) if header.log_time > until_ns => {
                    self.holds = true;
                    return Ok(());
                }
                Some(Item::Message(header, data)) => {
                    if let Some((topic, count)) = self.channels.get_mut(&header.channel_id) {
                        *count += 1;
                        let topic = *topic;
                        self.message(topic, &header, data, &mut consumers);
                        self.check_failure(&log)?;
                    }
                }
                Some(other) => self.facts.add(&log, &other)?,
            }
        }
    }

    /// Completes the state after the last message.
    pub(crate) fn end(&mut self, reader: &Reader<'_>) {
        self.condition = reader.condition().clone();
        for (topic, count) in self.channels.values() {
            *self.counts.entry(topic.name().to_owned()).or_insert(0) += count;
        }
        // Changes that were due after the end of the run did not happen.
        let shown_ns = self.now_ns.filter(|now| *now > 0).unwrap_or(self.last_ns);
        self.changes.retain(|(time_ns, _)| *time_ns <= shown_ns);
        self.changes.sort_by_key(|(time_ns, _)| *time_ns);
    }

    /// Decodes header and elements of a message; `None`, with a note, if it is damaged.
    pub(crate) fn decode<T: Topic>(
        &mut self,
        message: &LoggedMessage<'_>,
    ) -> Option<(T::Header, Vec<T::Element>)> {
        match message.decode::<T>() {
            Ok(found) => found,
            Err(error) => {
                self.damaged(error);
                None
            }
        }
    }

    fn damaged(&mut self, error: DecodeError) {
        self.note(format!("a message is damaged and left out: {error}"));
        self.failure.get_or_insert(error);
    }

    /// Adds a note on unreadable content.
    pub(crate) fn note(&mut self, note: String) {
        if self.notes.len() < MAX_NOTES && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    fn check_layout(
        &mut self,
        log: &Path,
        channel: &Channel,
        consumers: &Consumers<dyn Consumer<Self> + '_>,
    ) -> Result<(), LogReadError> {
        let Some(topic) = TopicId::from_name(&channel.topic) else {
            return Ok(());
        };
        let is_shown = matches!(
            topic,
            TopicId::WorldState | TopicId::WorldMap | TopicId::ObstacleEvents
        );
        if !is_shown && !consumers.take(topic) {
            return Ok(());
        }
        match known::check_layout(log, channel, self.facts.origin.version()) {
            Err(_) if self.purpose == Purpose::Page && topic != TopicId::WorldState => {
                self.note(format!(
                    "{}: its messages are of another version and are left out",
                    channel.topic
                ));
                Ok(())
            }
            result => result,
        }
    }

    fn check_failure(&mut self, log: &Path) -> Result<(), LogReadError> {
        match self.failure.take() {
            Some(error) if self.purpose != Purpose::Page => Err(LogReadError::NotRepeatable {
                path: log.to_owned(),
                reason: format!("a message is damaged: {error}"),
            }),
            _ => Ok(()),
        }
    }

    fn message(
        &mut self,
        topic: TopicId,
        header: &MessageHeader,
        data: &[u8],
        consumers: &mut Consumers<dyn Consumer<Self> + '_>,
    ) {
        let time_ns = header.log_time;
        self.last_ns = self.last_ns.max(time_ns);
        if let Purpose::Picture { until_ns } = self.purpose
            && time_ns > until_ns
        {
            if topic == TopicId::WorldState {
                self.end_ns = self.end_ns.max(time_ns);
            }
            return;
        }
        let Some(message) = LoggedMessage::new(topic, time_ns, data) else {
            self.damaged(DecodeError::Length {
                topic: topic.name(),
                elements: 0,
                expected: known::ENCAPSULATION + topic.facts().header.size,
                found: data.len(),
            });
            return;
        };
        match topic {
            TopicId::WorldState => {
                let Some((header, states)) = self.decode::<WorldState>(&message) else {
                    return;
                };
                self.state(time_ns, &header, states);
            }
            TopicId::WorldMap => self.map(&message),
            TopicId::ObstacleEvents => self.obstacle(&message),
            _ => {}
        }
        consumers.message(&message, self);
    }

    fn state(&mut self, time_ns: u64, header: &WorldHeader, mut states: Vec<RobotState>) {
        states.retain(|s| {
            (s.robot as usize) < MAX_ROBOTS && is_near([s.x, s.y]) && s.theta.is_finite()
        });
        self.states = states;
        if self.now_ns.is_none()
            && let Some(run) = &self.facts.run
        {
            self.patrols = PatrolMeasurement::of_all(&run.patrols, &run.robots);
        }
        if self.now_ns <= Some(time_ns) {
            for patrol in &mut self.patrols {
                patrol.add(time_ns as f64 / 1e9, self.states.iter().copied());
            }
        }
        self.now_ns = Some(time_ns);
        self.end_ns = self.end_ns.max(time_ns);
        self.tick_period_ns = header.tick_period_ns;
        self.over = header.phase == WorldHeader::OVER;
    }

    fn map(&mut self, message: &LoggedMessage<'_>) {
        let is_wanted = self.purpose != Purpose::Page || !self.facts.has_map();
        if is_wanted && let Some((header, cells)) = self.decode::<WorldMap>(message) {
            self.facts.map(&header, &cells);
        }
    }

    fn obstacle(&mut self, message: &LoggedMessage<'_>) {
        let Some((header, events)) = self.decode::<ObstacleEvents>(message) else {
            return;
        };
        // The world also rejects a message that makes no change.
        let changes = events
            .iter()
            .filter_map(|event| runtime::obstacle::from_message(event).ok());
        for change in changes {
            if self.changes.len() < MAX_EVENTS {
                self.changes.push((header.stamp.time_ns, change));
            }
        }
    }
}

/// Returns `true` if a position (m) can be in a world of Protean.
pub fn is_near(place: [f64; 2]) -> bool {
    place.iter().all(|c| c.abs() <= MAX_COORDINATE)
}
