//! Observer of the messages written to a log.

use super::channel::ChannelSpec;

/// Receives channels and messages as they are written to a log, in order. It runs on the thread of the
/// log and must not block.
pub trait LogObserver: Send {
    /// Receives a new channel; channels are numbered from 0.
    fn channel(&mut self, spec: &ChannelSpec<'_>);

    /// Receives a message with its log time (simulated ns).
    fn message(&mut self, channel: usize, log_time: u64, data: &[u8]);
}
