//! Somebody who gets what goes into a log.

use super::channel::ChannelSpec;

/// Gets what goes into a log, as it goes in and in its order. Runs on the recorder's thread: be
/// quick.
pub trait LogObserver: Send {
    /// A channel was added; the first is channel 0, the next channel 1, and so on.
    fn channel(&mut self, spec: &ChannelSpec<'_>);

    /// A message was written, at this time of the log (simulated ns).
    fn message(&mut self, channel: usize, log_time: u64, data: &[u8]);
}
