//! Audit of all messages: checks, counts and digest.

use std::collections::BTreeSet;

use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;
use zerocopy::FromBytes;

use super::checks::{Finite, is_decodable};
use super::digest::Digest;
use super::digest_prefixes::DigestPrefix;
use super::parts::Parts;
use super::run_info::ProcessInfo;
use super::sequence::Sequences;
use super::summary::TopicCount;

/// Maximum distance of a tick from the newest world state; a message for a later tick would never be written.
const MAX_TICKS_AHEAD: u64 = 1024;

/// Source of messages that come from no process of the run.
const UNKNOWN_SOURCE: u32 = u32::MAX;

/// Checks, counts and hashes messages.
#[derive(Debug)]
pub(super) struct MessageAudit {
    /// Statistics by rank of the topic.
    accounts: Vec<TopicStats>,
    digest: Digest,
    sources: BTreeSet<u32>,
    tick_period_ns: u64,
    /// Tick of the newest world state; `None` before the first.
    newest: Option<u64>,
}

/// Statistics of a topic.
#[derive(Debug, Default)]
struct TopicStats {
    sequences: Sequences,
    count: TopicCount,
}

/// Result of the checks of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Verdict {
    /// `true` if it passed all checks.
    pub(super) is_valid: bool,
    /// `true` if its tick is plausible.
    pub(super) plausible: bool,
}

impl MessageAudit {
    /// Creates the audit of a run with these processes and this simulated time between two ticks (ns).
    pub(super) fn new(processes: &[ProcessInfo], tick_period_ns: u64) -> Self {
        Self {
            accounts: TopicId::all().map(|_| TopicStats::default()).collect(),
            digest: Digest::default(),
            sources: processes.iter().map(|p| p.index).collect(),
            tick_period_ns,
            newest: None,
        }
    }

    /// Adds a message. A message known from another run is not checked again.
    pub(super) fn enter(
        &mut self,
        topic: TopicId,
        stamp: &Stamp,
        message: &Parts<'_>,
        beginning: Option<&DigestPrefix>,
    ) -> Verdict {
        if self.accounts.len() <= topic.rank() {
            self.accounts
                .resize_with(topic.rank() + 1, TopicStats::default);
        }
        let account = &mut self.accounts[topic.rank()];
        let simulated = topic.facts().simulated;
        let known = self.sources.contains(&stamp.source);
        let source = if known { stamp.source } else { UNKNOWN_SOURCE };
        // Obstacle events are sent in advance: all except those that a robot triggers arrive before the first
        // tick.
        let farthest = self.newest.unwrap_or(0).saturating_add(MAX_TICKS_AHEAD);
        let plausible = topic == TopicId::ObstacleEvents || stamp.tick <= farthest;
        let is_valid = known
            && plausible
            && (!simulated || on_time(stamp, self.tick_period_ns))
            && (beginning.is_some() || well_formed(topic, message));
        let count = &mut account.count;
        if is_decodable(topic, message.count) {
            count.messages += 1;
            count.bytes += message.cdr_len() as u64;
        }
        count.rejected += u64::from(!is_valid);
        if known {
            let missing = account.sequences.missing(source, stamp.sequence);
            count.gaps = count.gaps.saturating_add(missing);
        }
        let is_begun =
            beginning.is_some_and(|known| self.digest.begin(topic, source, &known.hasher));
        if simulated && !is_begun {
            self.digest.update(topic, source, message);
        }
        if topic == TopicId::WorldState && is_valid {
            self.newest = self.newest.max(Some(stamp.tick));
        }
        Verdict {
            is_valid,
            plausible,
        }
    }

    /// Returns the hash state after the first message of a process, if it has sent no other message of the
    /// topic.
    pub(super) fn beginning(&mut self, topic: TopicId, source: u32) -> Option<blake3::Hasher> {
        self.digest.beginning(topic, source)
    }

    /// Tick of the newest world state; `None` before the first.
    pub(super) fn newest(&self) -> Option<u64> {
        self.newest
    }

    /// Returns the name and the counts of every topic.
    pub(super) fn counts(&self) -> impl Iterator<Item = (&'static str, TopicCount)> + '_ {
        let topics = TopicId::all().map(TopicId::name);
        topics.zip(self.accounts.iter().map(|account| account.count))
    }

    /// Returns the digest of all messages so far, as 64 hexadecimal digits.
    pub(super) fn digest(&mut self) -> String {
        self.digest.finish()
    }
}

/// Returns `true` if the simulated time is that of the tick.
fn on_time(stamp: &Stamp, tick_period_ns: u64) -> bool {
    stamp.tick.checked_mul(tick_period_ns) == Some(stamp.time_ns)
}

/// Returns `true` if a message has a valid number of elements and only valid numbers.
fn well_formed(topic: TopicId, message: &Parts<'_>) -> bool {
    use ipc_types::messages::world::MapHeader;

    if !is_decodable(topic, message.count) {
        return false;
    }
    if topic == TopicId::WorldMap {
        let fits = MapHeader::read_from_prefix(message.header).is_ok_and(|(map, _)| {
            u64::from(map.width) * u64::from(map.height) == message.count as u64
        });
        if !fits {
            return false;
        }
    }
    Finite::for_topic(topic).is_valid(message.header, message.elements)
}
