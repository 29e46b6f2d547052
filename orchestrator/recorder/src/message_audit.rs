//! What is noted of every message, whoever delivers it: whether it holds, how many there were, the
//! fingerprint of them all.

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

/// A tick this far beyond the newest world state is not believed: its message would wait for ever.
const MAX_TICKS_AHEAD: u64 = 1024;

/// Stands for every source that is not a process of the run.
const UNKNOWN_SOURCE: u32 = u32::MAX;

/// Checks, counts and fingerprints messages.
#[derive(Debug)]
pub(super) struct MessageAudit {
    /// By the rank of their topics.
    accounts: Vec<TopicStats>,
    digest: Digest,
    sources: BTreeSet<u32>,
    tick_period_ns: u64,
    /// Tick of the newest world state; `None` before the first.
    newest: Option<u64>,
}

/// What is known of a topic's messages.
#[derive(Debug, Default)]
struct TopicStats {
    sequences: Sequences,
    count: TopicCount,
}

/// What is to be thought of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Verdict {
    /// It passed all checks.
    pub(super) holds: bool,
    /// Its tick can be believed.
    pub(super) plausible: bool,
}

impl MessageAudit {
    /// For a run of these processes, with this much simulated time between two ticks (ns).
    pub(super) fn new(processes: &[ProcessInfo], tick_period_ns: u64) -> Self {
        Self {
            accounts: TopicId::ALL.iter().map(|_| TopicStats::default()).collect(),
            digest: Digest::default(),
            sources: processes.iter().map(|p| p.index).collect(),
            tick_period_ns,
            newest: None,
        }
    }

    /// Enters a message. One that is known from another run is not looked through again.
    pub(super) fn enter(
        &mut self,
        topic: TopicId,
        stamp: &Stamp,
        message: &Parts<'_>,
        beginning: Option<&DigestPrefix>,
    ) -> Verdict {
        let account = &mut self.accounts[topic.rank()];
        let simulated = topic.facts().simulated;
        let known = self.sources.contains(&stamp.source);
        let source = if known { stamp.source } else { UNKNOWN_SOURCE };
        // Obstacle events are announced: all but those that a robot brings about come before the
        // first tick.
        let farthest = self.newest.unwrap_or(0).saturating_add(MAX_TICKS_AHEAD);
        let plausible = topic == TopicId::ObstacleEvents || stamp.tick <= farthest;
        let holds = known
            && plausible
            && (!simulated || on_time(stamp, self.tick_period_ns))
            && (beginning.is_some() || well_formed(topic, message));
        let count = &mut account.count;
        if is_decodable(topic, message.count) {
            count.messages += 1;
            count.bytes += message.cdr_len() as u64;
        }
        count.rejected += u64::from(!holds);
        if known {
            let missing = account.sequences.missing(source, stamp.sequence);
            count.gaps = count.gaps.saturating_add(missing);
        }
        let is_begun =
            beginning.is_some_and(|known| self.digest.begin(topic, source, &known.hasher));
        if simulated && !is_begun {
            self.digest.update(topic, source, message);
        }
        if topic == TopicId::WorldState && holds {
            self.newest = self.newest.max(Some(stamp.tick));
        }
        Verdict { holds, plausible }
    }

    /// The state of the fingerprint behind the first message of a process, if it has sent nothing
    /// else of the topic.
    pub(super) fn beginning(&mut self, topic: TopicId, source: u32) -> Option<blake3::Hasher> {
        self.digest.beginning(topic, source)
    }

    /// Tick of the newest world state; `None` before the first.
    pub(super) fn newest(&self) -> Option<u64> {
        self.newest
    }

    /// Every topic's name and what came in of it.
    pub(super) fn counts(&self) -> impl Iterator<Item = (&'static str, TopicCount)> + '_ {
        let topics = TopicId::ALL.iter().map(|topic| topic.name());
        topics.zip(self.accounts.iter().map(|account| account.count))
    }

    /// The fingerprint of everything so far, as 64 hexadecimal digits.
    pub(super) fn digest(&mut self) -> String {
        self.digest.finish()
    }
}

/// Whether the simulated time is that of the tick.
fn on_time(stamp: &Stamp, tick_period_ns: u64) -> bool {
    stamp.tick.checked_mul(tick_period_ns) == Some(stamp.time_ns)
}

/// Whether a message has as many elements as it should, and only numbers that make sense.
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
    Finite::of(topic).holds(message.header, message.elements)
}
