//! What is known of our own topics.

use std::convert::Infallible;
use std::path::Path;
use std::sync::LazyLock;

use ipc_types::schema;
use ipc_types::stamp::Stamp;
use ipc_types::topics::{RunSize, Topic, TopicVisitor, for_each_topic};
use zerocopy::FromBytes as _;

use super::error::LogsError;
use super::reader::Channel;
use super::ros2::Schema;

/// Bytes in front of a message's first field: the encapsulation of CDR.
pub(crate) const ENCAPSULATION: usize = 4;

/// One of our topics.
#[derive(Debug)]
pub(crate) struct Known {
    pub(crate) name: &'static str,
    /// Whether it is part of the simulated history.
    pub(crate) simulated: bool,
    /// Whether whoever comes late gets the last message: it describes a state that lasts.
    pub(crate) latched: bool,
    /// Whether only one process ever sends it.
    pub(crate) one_sender: bool,
    pub(crate) hash: String,
    /// The fields of its messages.
    pub(super) schema: Option<Schema>,
}

/// All our topics.
fn all() -> &'static [Known] {
    static ALL: LazyLock<Vec<Known>> = LazyLock::new(collect);
    &ALL
}

/// Our topic with this name.
pub(crate) fn find(name: &str) -> Option<&'static Known> {
    all().iter().find(|known| known.name == name)
}

/// Our topic at this place of [`ipc_types::topics::NAMES`].
pub(super) fn of_rank(rank: usize) -> Option<&'static Known> {
    all().get(rank)
}

/// The names of the topics that are part of the simulated history.
pub(crate) fn simulated() -> impl Iterator<Item = &'static str> {
    all()
        .iter()
        .filter(|known| known.simulated)
        .map(|known| known.name)
}

fn collect() -> Vec<Known> {
    struct Collect(Vec<Known>);
    impl TopicVisitor for Collect {
        type Error = Infallible;
        fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
            let size = RunSize {
                robots: 1,
                processes: 2,
                events: 1,
            };
            self.0.push(Known {
                name: T::NAME,
                simulated: T::SIMULATED,
                latched: T::qos(&size).history > 0,
                one_sender: T::qos(&size).publishers == 1,
                hash: schema::hash::<T>(),
                schema: Schema::parse(schema::ros2msg::<T>().as_bytes()).ok(),
            });
            Ok(())
        }
    }
    let mut collect = Collect(Vec::new());
    let Ok(()) = for_each_topic(&mut collect);
    collect.0
}

/// Whether a channel's messages begin with a [`Stamp`] as this version knows it.
pub(crate) fn is_stamped(channel: &Channel) -> bool {
    let hash = channel.metadata.get("schema_hash");
    find(&channel.topic).is_some_and(|known| hash == Some(&known.hash))
}

/// Checks that the messages of a channel, of one of our topics, have the layout of this version.
/// `version` is the one that the log names, or empty.
///
/// # Errors
/// [`LogsError::Layout`] if the log names another layout, [`LogsError::Foreign`] if it names none.
pub(crate) fn check_layout(log: &Path, channel: &Channel, version: &str) -> Result<(), LogsError> {
    if is_stamped(channel) {
        return Ok(());
    }
    let Some(found) = channel.metadata.get("schema_hash") else {
        return Err(LogsError::Foreign {
            path: log.to_owned(),
            missing: "schema_hash on its channels",
        });
    };
    Err(other_layout(log, &channel.topic, found, version))
}

/// The error of a topic that looks different in this version: its layout in the log is `found`. `version`
/// is the one that the log names, or empty.
pub(crate) fn other_layout(log: &Path, topic: &str, found: &str, version: &str) -> LogsError {
    let expected = find(topic).map_or("no such topic", |known| &known.hash);
    LogsError::Layout {
        path: log.to_owned(),
        version: version.to_owned(),
        topic: topic.to_owned(),
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}

/// The stamp of a message of such a channel.
pub(crate) fn stamp(data: &[u8]) -> Option<Stamp> {
    let (stamp, _) = Stamp::read_from_prefix(data.get(ENCAPSULATION..)?).ok()?;
    Some(stamp)
}
