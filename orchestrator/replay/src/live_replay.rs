//! Live server of a replay, which viewers see as a run.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use mcap_log::source::{LogMessage, Source};
use mcap_log::{ChannelSpec, LogObserver as _};
use viewer::{BroadcastHandle, Control, LiveError, LiveOptions, LiveServer, LiveTotals};

/// Server of the replayed messages: the topics of the log with their schemas, byte for byte.
pub(super) struct LiveReplay {
    server: LiveServer,
    tap: BroadcastHandle,
    /// Index of each channel of the log at the live server.
    channels: BTreeMap<u16, usize>,
}

impl LiveReplay {
    /// Starts the server, which prints its addresses to stderr.
    pub(super) fn start(options: LiveOptions, source: &Source) -> Result<Self, LiveError> {
        let server = LiveServer::start(options)?;
        server.show(source.path(), true);
        let mut live_replay = Self {
            tap: server.tap(),
            server,
            channels: BTreeMap::new(),
        };
        live_replay.announce(source);
        Ok(live_replay)
    }

    /// Announces the channels found so far to viewers. In a log without an index, channels are found while it is
    /// read.
    fn announce(&mut self, source: &Source) {
        for (id, channel, schema) in source.channels() {
            let next = self.channels.len();
            if *self.channels.entry(id).or_insert(next) < next {
                continue;
            }
            self.tap.channel(&ChannelSpec {
                topic: &channel.topic,
                schema_name: schema.as_ref().map_or("", |schema| &schema.name),
                schema_encoding: schema.as_ref().map_or("", |schema| &schema.encoding),
                schema: schema.as_ref().map_or(&[], |schema| &schema.data),
                message_encoding: &channel.message_encoding,
                metadata: &channel.metadata,
            });
        }
    }

    /// Returns what pages ask for, if they may.
    pub(super) fn control(&self) -> Option<&Control> {
        self.server.control()
    }

    /// Continues the replay at another time (ns); latched messages become invalid.
    pub(super) fn jump(&mut self, time: u64) {
        self.tap.jump(time);
    }

    /// Sends a message to the viewers.
    pub(super) fn show(&mut self, source: &Source, message: &LogMessage) {
        if !self.channels.contains_key(&message.channel) {
            self.announce(source);
        }
        if let Some(&channel) = self.channels.get(&message.channel) {
            self.tap.message(channel, message.time, &message.data);
        }
    }

    /// Sends the remaining messages, closes all connections once pages need them no more, and returns the totals.
    pub(super) fn finish(self, interrupted: &AtomicBool) -> LiveTotals {
        self.server.finish(interrupted)
    }
}
