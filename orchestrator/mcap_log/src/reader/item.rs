//! What a log is made of, as it is handed out.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use mcap::records::{AttachmentHeader, MessageHeader, Metadata};

/// A schema of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Its name.
    pub name: String,
    /// How the definition is written: `ros2msg`, `protobuf`.
    pub encoding: String,
    /// The definition.
    pub data: Vec<u8>,
}

/// A channel of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its number in the log.
    pub id: u16,
    /// Number of its schema; 0 for none.
    pub schema_id: u16,
    /// Its topic.
    pub topic: String,
    /// How its messages are written: `cdr`, `protobuf`.
    pub message_encoding: String,
    /// What the log says of it, by name.
    pub metadata: BTreeMap<String, String>,
}

/// What comes next in a log.
#[derive(Debug)]
pub enum Item<'a> {
    /// The file's header.
    Header {
        /// The profile that the file follows.
        profile: String,
        /// The program that wrote the file.
        library: String,
    },
    /// A schema that was not known before.
    Schema(u16, Rc<Schema>),
    /// A channel that was not known before.
    Channel(Rc<Channel>),
    /// A message of a known channel.
    Message(MessageHeader, &'a [u8]),
    /// A file within the file.
    Attachment(AttachmentHeader, &'a [u8]),
    /// Names and values.
    Metadata(Metadata),
}

/// Where the bytes of an item stand.
#[derive(Debug)]
pub(super) enum ItemLocation {
    Header(String, String),
    Schema(u16, Rc<Schema>),
    Channel(Rc<Channel>),
    Message(MessageHeader, Range<usize>),
    Attachment(AttachmentHeader, Range<usize>),
    Metadata(Metadata),
}
