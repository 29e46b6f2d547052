//! Messages of a run in order, and their consumers: the outcome of a run, drawings, reports.
//!
//! A [`Consumer`] takes the messages of its topics. [`Consumers`] is a list of them that passes each
//! message, from the bus or from a log, to those that take its topic.

use zerocopy::FromBytes as _;

use crate::cdr::{self, DecodeError, ENCAPSULATION};
use crate::messages::world::WorldEvent;
use crate::stamp::Stamp;
use crate::topics::{RobotEvents, Topic, TopicId, WorldEvents};

/// A message in its CDR form, with its position in a run.
#[derive(Debug, Clone, Copy)]
pub struct LoggedMessage<'a> {
    /// Topic.
    pub topic: TopicId,
    /// Stamp.
    pub stamp: Stamp,
    /// Simulated log time (ns).
    pub time_ns: u64,
    /// CDR form.
    pub bytes: &'a [u8],
}

impl<'a> LoggedMessage<'a> {
    /// Creates it from the bytes of a message with this log time (ns); `None` if they end within the
    /// stamp.
    pub fn new(topic: TopicId, time_ns: u64, bytes: &'a [u8]) -> Option<Self> {
        let body = bytes.get(ENCAPSULATION.len()..)?;
        let (stamp, _) = Stamp::read_from_prefix(body).ok()?;
        Some(Self {
            topic,
            stamp,
            time_ns,
            bytes,
        })
    }

    /// Log time (s).
    pub fn time_s(&self) -> f64 {
        self.time_ns as f64 / 1e9
    }

    /// Header and elements, read on demand; `None` if it is of another topic or too short.
    pub fn view<T: Topic>(
        &self,
    ) -> Option<(
        T::Header,
        impl ExactSizeIterator<Item = T::Element> + Clone + use<'a, T>,
    )> {
        if self.topic != T::id() {
            return None;
        }
        cdr::view::<T>(self.bytes)
    }

    /// Events of the world and of robots; none of another topic. The topics are [`EVENTS`]. A planner's message has no events
    /// of the world, whatever their codes.
    pub fn events(&self) -> impl Iterator<Item = WorldEvent> + use<'a> {
        let world = self.view::<WorldEvents>().into_iter();
        let robots = self.view::<RobotEvents>().into_iter();
        let robots = robots.flat_map(|(_, events)| events);
        let of_robots = robots.filter(|event| event.kind >= WorldEvent::SIGHTED);
        world.flat_map(|(_, events)| events).chain(of_robots)
    }

    /// Header and elements; `None` if it is of another topic.
    ///
    /// # Errors
    /// [`DecodeError`] if the bytes are not exactly one message of the topic.
    pub fn decode<T: Topic>(&self) -> Result<Option<cdr::DecodedMessage<T>>, DecodeError> {
        if self.topic != T::id() {
            return Ok(None);
        }
        cdr::decode::<T>(self.bytes).map(Some)
    }
}

/// The topics of [`LoggedMessage::events`].
pub const EVENTS: [TopicId; 2] = [TopicId::WorldEvents, TopicId::RobotEvents];

/// Takes the messages of some topics, in the order of the log. `Shared` is the common state or output
/// of the consumers of a list.
pub trait Consumer<Shared: ?Sized = ()> {
    /// The topics of its messages; constant.
    fn topics(&self) -> &[TopicId];

    /// Takes the next message of one of these topics.
    fn message(&mut self, message: &LoggedMessage<'_>, shared: &mut Shared);

    /// Called after all messages of the current tick.
    fn end_of_tick(&mut self, shared: &mut Shared) {
        let _ = shared;
    }
}

/// Takes no messages.
impl<Shared: ?Sized> Consumer<Shared> for () {
    fn topics(&self) -> &[TopicId] {
        &[]
    }

    fn message(&mut self, _: &LoggedMessage<'_>, _: &mut Shared) {}
}

/// A borrowed consumer, owned by the caller.
impl<Shared: ?Sized, C: Consumer<Shared> + ?Sized> Consumer<Shared> for &mut C {
    fn topics(&self) -> &[TopicId] {
        (**self).topics()
    }

    fn message(&mut self, message: &LoggedMessage<'_>, shared: &mut Shared) {
        (**self).message(message, shared);
    }

    fn end_of_tick(&mut self, shared: &mut Shared) {
        (**self).end_of_tick(shared);
    }
}

/// Consumers of one type, in the order of delivery.
#[derive(Debug)]
pub struct Consumers<C: ?Sized> {
    list: Vec<Box<C>>,
    /// Indices in the list, by the rank of the topic.
    takers: Vec<Vec<usize>>,
}

impl<C: ?Sized> Consumers<C> {
    /// Creates the list in this order.
    pub fn new<Shared: ?Sized>(list: Vec<Box<C>>) -> Self
    where
        C: Consumer<Shared>,
    {
        let mut takers = vec![Vec::new(); TopicId::count()];
        for (place, consumer) in list.iter().enumerate() {
            for topic in consumer.topics() {
                takers[topic.rank()].push(place);
            }
        }
        Self { list, takers }
    }

    /// Returns `true` if a consumer takes the messages of this topic.
    pub fn take(&self, topic: TopicId) -> bool {
        let takers = self.takers.get(topic.rank());
        takers.is_some_and(|takers| !takers.is_empty())
    }

    /// Delivers a message.
    pub fn message<Shared: ?Sized>(&mut self, message: &LoggedMessage<'_>, shared: &mut Shared)
    where
        C: Consumer<Shared>,
    {
        for &place in self.takers.get(message.topic.rank()).into_iter().flatten() {
            self.list[place].message(message, shared);
        }
    }

    /// Reports the end of a tick.
    pub fn end_of_tick<Shared: ?Sized>(&mut self, shared: &mut Shared)
    where
        C: Consumer<Shared>,
    {
        for consumer in &mut self.list {
            consumer.end_of_tick(shared);
        }
    }

    /// The consumers, after the last message.
    pub fn into_list(self) -> Vec<Box<C>> {
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::robot::Command;
    use crate::stamp::PlainHeader;
    use crate::topics::{Commands, Status};

    /// Records its number and the commanded speeds.
    struct Speeds(f64, &'static [TopicId]);

    impl Consumer<Vec<(f64, f64)>> for Speeds {
        fn topics(&self) -> &[TopicId] {
            self.1
        }

        fn message(&mut self, message: &LoggedMessage<'_>, noted: &mut Vec<(f64, f64)>) {
            assert!(message.view::<Status>().is_none());
            let (_, commands) = message.view::<Commands>().unwrap();
            noted.extend(commands.map(|command| (self.0, command.v)));
        }
    }

    #[test]
    fn a_message_goes_to_the_consumers_of_its_topic_in_the_order_of_the_list() {
        let mut consumers: Consumers<dyn Consumer<Vec<(f64, f64)>>> = Consumers::new(vec![
            Box::new(Speeds(1.0, &[TopicId::Commands])),
            Box::new(Speeds(2.0, &[TopicId::WorldMap])),
            Box::new(Speeds(3.0, &[TopicId::Status, TopicId::Commands])),
        ]);
        assert!(consumers.take(TopicId::Commands) && !consumers.take(TopicId::Scan));
        let mut header = PlainHeader::default();
        header.stamp.tick = 7;
        let command = Command {
            v: 0.5,
            ..Command::default()
        };
        let mut bytes = Vec::new();
        cdr::encode::<Commands>(&header, &[command], &mut bytes);
        let message = LoggedMessage::new(TopicId::Commands, 2_000_000_000, &bytes).unwrap();
        assert_eq!((message.stamp.tick, message.time_s()), (7, 2.0));
        let mut noted = Vec::new();
        consumers.message(&message, &mut noted);
        assert_eq!(noted, [(1.0, 0.5), (3.0, 0.5)]);
        assert_eq!(
            message.decode::<Commands>(),
            Ok(Some((header, vec![command])))
        );
        assert_eq!(message.decode::<Status>(), Ok(None));
        assert!(LoggedMessage::new(TopicId::Commands, 0, &bytes[..60]).is_none());
    }
}
