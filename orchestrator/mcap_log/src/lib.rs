//! Logs as MCAP files: the writer of a run's log ([`LogWriter`]), the reader of any log ([`reader`]), and
//! parts of logs in new files ([`output`]).
//!
//! The reader reads a log from beginning to end, checks every length, keeps at most one chunk in memory, and
//! reads damaged or foreign files as far as possible; the [`Condition`] lists what could not be read.
//!
//! ```
//! use std::collections::BTreeMap;
//!
//! use mcap_log::reader::{Item, Reader};
//! use mcap_log::{ChannelSpec, LogOptions, LogWriter, Manifest};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("run.mcap");
//! let mut log = LogWriter::create(&path, &LogOptions::default(), &Manifest::default())?;
//! let channel = log.add_channel(&ChannelSpec {
//!     topic: "note",
//!     schema_name: "Note",
//!     schema_encoding: "ros2msg",
//!     schema: b"string text",
//!     message_encoding: "cdr",
//!     metadata: &BTreeMap::new(),
//! })?;
//! log.write(channel, 0, 50_000_000, 50_000_000, b"a message")?;
//! log.finish()?;
//!
//! let mut messages = 0;
//! let mut reader = Reader::open(&path, None)?;
//! while let Some(item) = reader.next()? {
//!     messages += usize::from(matches!(item, Item::Message(_, b"a message")));
//! }
//! assert_eq!(messages, 1);
//! assert!(reader.condition().is_whole());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod condition;
pub mod derived;
mod error;
pub mod fields;
pub mod known;
mod origin;
pub mod output;
mod pattern;
mod read_progress;
pub mod reader;
pub mod ros2;
pub mod source;
pub mod states;
mod writer;

pub use condition::{Chunks, Condition, Fault};
pub use derived::DerivedError;
pub use error::LogReadError;
/// MCAP records that the reader returns.
pub use mcap::records::{AttachmentHeader, MessageHeader, Metadata};
pub use origin::Origin;
pub use pattern::Topics;
pub use read_progress::ReadProgress;
pub use writer::{
    ChannelId, ChannelSpec, ChannelTotals, Compression, LogObserver, LogOptions, LogTotals,
    LogWriteError, LogWriter, Manifest, ManifestFile,
};

/// Converts nanoseconds to seconds.
pub fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / 1e9
}
