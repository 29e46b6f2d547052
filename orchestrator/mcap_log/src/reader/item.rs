//! Items of a log that the reader returns.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use mcap::records::{AttachmentHeader, MessageHeader, Metadata};

/// A schema of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Its name.
    pub name: String,
    /// Encoding of the definition: `ros2msg`, `protobuf`.
    pub encoding: String,
    /// The definition.
    pub data: Vec<u8>,
}

/// A channel of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Id in the log.
    pub id: u16,
    /// Id of its schema; 0 for none.
    pub schema_id: u16,
    /// Its topic.
    pub topic: String,
    /// Encoding of its messages: `cdr`, `protobuf`.
    pub message_encoding: String,
    /// Metadata of the channel, by name.
    pub metadata: BTreeMap<String, String>,
}

/// Item of a log.
#[derive(Debug)]
pub enum Item<'a> {
    /// The file's header.
    Header {
        /// The profile that the file follows.
        profile: String,
        /// The program that wrote the file.
        library: String,
    },
    /// A new schema.
    Schema(u16, Arc<Schema>),
    /// A new channel.
    Channel(Arc<Channel>),
    /// A message of a known channel.
    Message(MessageHeader, &'a [u8]),
    /// An attached file.
    Attachment(AttachmentHeader, &'a [u8]),
    /// A metadata record.
    Metadata(Metadata),
}

/// Location of the bytes of an item.
#[derive(Debug)]
pub enum ItemLocation {
    Header(String, String),
    Schema(u16, Arc<Schema>),
    Channel(Arc<Channel>),
    Message(MessageHeader, Range<usize>),
    Attachment(AttachmentHeader, Range<usize>),
    Metadata(Metadata),
}
