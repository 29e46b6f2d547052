//! Writer of the log of a run.

mod channel;
mod error;
mod log_file;
mod log_observer;
mod log_writer;
mod storage;

#[cfg(test)]
mod tests;

pub use channel::ChannelSpec;
pub use error::LogWriteError;
pub use log_observer::LogObserver;
pub use log_writer::{
    ChannelId, ChannelTotals, Compression, LogOptions, LogTotals, LogWriter, Manifest, ManifestFile,
};
