//! Description of a channel of a log.

use std::collections::BTreeMap;

/// Description of a channel.
#[derive(Debug, Clone, Copy)]
pub struct ChannelSpec<'a> {
    /// Name of the topic.
    pub topic: &'a str,
    /// Name of the schema.
    pub schema_name: &'a str,
    /// Encoding of the schema: `ros2msg`, …
    pub schema_encoding: &'a str,
    /// Definition of the schema.
    pub schema: &'a [u8],
    /// Encoding of the messages: `cdr`, …
    pub message_encoding: &'a str,
    /// Additional metadata.
    pub metadata: &'a BTreeMap<String, String>,
}
