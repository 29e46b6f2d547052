//! What a log is made of, as it is handed out.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use mcap::records::{AttachmentHeader, MessageHeader, Metadata};

/// A schema of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Schema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) data: Vec<u8>,
}

/// A channel of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) id: u16,
    /// 0 for none.
    pub(crate) schema_id: u16,
    pub(crate) topic: String,
    pub(crate) message_encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
}

/// What comes next in a log.
#[derive(Debug)]
pub(crate) enum Item<'a> {
    /// The file's header.
    Header { profile: String, library: String },
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
pub(super) enum Found {
    Header(String, String),
    Schema(u16, Rc<Schema>),
    Channel(Rc<Channel>),
    Message(MessageHeader, Range<usize>),
    Attachment(AttachmentHeader, Range<usize>),
    Metadata(Metadata),
}
