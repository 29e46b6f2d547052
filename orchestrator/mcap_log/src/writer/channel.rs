//! The description of a channel of a log.

use std::collections::BTreeMap;

/// How a channel is described in the file.
#[derive(Debug, Clone, Copy)]
pub struct ChannelSpec<'a> {
    /// Name of the topic.
    pub topic: &'a str,
    /// Name of the schema.
    pub schema_name: &'a str,
    /// `ros2msg`, `protobuf`, …
    pub schema_encoding: &'a str,
    /// The schema itself.
    pub schema: &'a [u8],
    /// `cdr`, `protobuf`, …
    pub message_encoding: &'a str,
    /// Anything else that readers should know.
    pub metadata: &'a BTreeMap<String, String>,
}
