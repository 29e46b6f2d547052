//! Layouts of the project's topics.

use std::ops::Range;
use std::path::Path;

use ipc_types::layout::TopicLayout;
use ipc_types::schema;
use ipc_types::stamp::Stamp;
use ipc_types::topics::{PerTopic, TopicId};
use zerocopy::FromBytes as _;

use super::reader::Channel;
use super::ros2::Schema;
use crate::LogReadError;

/// Size of the CDR encapsulation header before the first field of a message (bytes).
pub const ENCAPSULATION: usize = 4;
/// Bytes of the stamp's clocks in a message; they do not belong to the simulated history.
pub const CLOCKS: Range<usize> =
    ENCAPSULATION + Stamp::SIMULATED_BYTES..ENCAPSULATION + size_of::<Stamp>();

/// The layout of a topic's messages in this version.
#[derive(Debug)]
pub struct Layout {
    /// Layout hash.
    pub(crate) hash: String,
    /// Fields of its messages.
    pub schema: Option<Schema>,
}

/// Returns the layout of a topic.
pub fn layout(topic: TopicId) -> &'static Layout {
    static ALL: PerTopic<Layout> = PerTopic::new(|topic| Layout {
        hash: schema::hash_of(topic),
        schema: Schema::parse(
            &schema::message_name(topic),
            schema::ros2msg(topic).as_bytes(),
        )
        .ok(),
    });
    ALL.get(topic)
}

/// Returns the topic of a channel whose messages have the layout of this version; they begin with a
/// [`Stamp`]. A topic that is not built in becomes known by the layout in the log.
pub fn topic_of(channel: &Channel) -> Option<TopicId> {
    let hash = channel.metadata.get("schema_hash")?;
    if TopicId::from_name(&channel.topic).is_none()
        && let Some(layout) = TopicLayout::from_entries(&channel.topic, &channel.metadata)
    {
        // A refused layout leaves the topic unknown.
        let _ = layout.register();
    }
    TopicId::from_name(&channel.topic).filter(|topic| layout(*topic).hash == *hash)
}

/// Checks that the messages of a channel of a project topic have the layout of this version. `version` is the
/// version in the log, or empty.
///
/// # Errors
/// [`LogReadError::Layout`] if the log has another layout hash, [`LogReadError::Foreign`] if it has none.
pub fn check_layout(log: &Path, channel: &Channel, version: &str) -> Result<(), LogReadError> {
    if topic_of(channel).is_some() {
        return Ok(());
    }
    let Some(found) = channel.metadata.get("schema_hash") else {
        return Err(LogReadError::Foreign {
            path: log.to_owned(),
            missing: "schema_hash on its channels",
        });
    };
    Err(other_layout(log, &channel.topic, found, version))
}

/// Returns the error of a topic that has another layout in this version: `found` in the log. `version` is the
/// version in the log, or empty.
pub(crate) fn other_layout(log: &Path, topic: &str, found: &str, version: &str) -> LogReadError {
    let expected = TopicId::from_name(topic).map_or("no such topic", |known| &layout(known).hash);
    LogReadError::Layout {
        path: log.to_owned(),
        version: version.to_owned(),
        topic: topic.to_owned(),
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}

/// Returns the stamp of a message of such a channel.
pub fn stamp(data: &[u8]) -> Option<Stamp> {
    let (stamp, _) = Stamp::read_from_prefix(data.get(ENCAPSULATION..)?).ok()?;
    Some(stamp)
}
