//! A replay, shown live to viewers as a run is.

use std::collections::BTreeMap;

use mcap_log::source::{Logged, Source};
use mcap_log::{ChannelSpec, LogObserver as _};
use platform::eprintln;
use viewer::{BroadcastHandle, LiveError, LiveServer, LiveTotals};

/// Serves what is played: the topics of the log under their schemas, byte for byte.
pub(super) struct LiveReplay {
    server: LiveServer,
    tap: BroadcastHandle,
    /// What viewers know a channel of the log as.
    channels: BTreeMap<u16, usize>,
}

impl LiveReplay {
    /// Listens on this port, and says where on stderr.
    pub(super) fn start(port: u16, source: &Source) -> Result<Self, LiveError> {
        let server = LiveServer::start(port)?;
        let mut live_replay = Self {
            tap: server.tap(),
            server,
            channels: BTreeMap::new(),
        };
        live_replay.announce(source);
        // Shown however quiet the replay is: without it nobody can look.
        eprintln!("live: {}", live_replay.server.url());
        Ok(live_replay)
    }

    /// Tells viewers of the channels that are known by now; those of a log without an index are
    /// found on the way.
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

    /// The replay goes on at another time (ns): what held does not any more.
    pub(super) fn jump(&mut self, time: u64) {
        self.tap.jump(time);
    }

    /// Shows a message.
    pub(super) fn show(&mut self, source: &Source, message: &Logged) {
        if !self.channels.contains_key(&message.channel) {
            self.announce(source);
        }
        if let Some(&channel) = self.channels.get(&message.channel) {
            self.tap.message(channel, message.time, &message.data);
        }
    }

    /// Sends the rest and says good-bye; what viewers got.
    pub(super) fn finish(self) -> LiveTotals {
        self.server.finish()
    }
}
