//! The log of a run while it is written.

mod error;
mod log_file;
mod log_writer;
mod mirror;
mod storage;

#[cfg(test)]
mod tests;

pub use error::LogWriteError;
pub use log_writer::{
    ChannelId, ChannelSpec, ChannelTotals, Compression, LogOptions, LogTotals, LogWriter, Manifest,
    ManifestFile,
};
pub use mirror::Mirror;
