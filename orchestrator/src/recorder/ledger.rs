//! What is noted of every message, whoever delivers it: whether it holds, how many there were, the
//! fingerprint of them all.

use std::collections::BTreeSet;

use ipc_types::stamp::Stamp;
use zerocopy::FromBytes;

use super::beginnings::Beginning;
use super::digest::Digest;
use super::options::ProcessInfo;
use super::parts::Parts;
use super::sequence::Sequences;
use super::summary::TopicCount;
use super::topic_info::{self, Role, TopicInfo};

/// A tick this far beyond the newest world state is not believed: its message would wait for ever.
const FARTHEST_AHEAD: u64 = 1024;

/// Stands for every source that is not a process of the run.
const STRANGER: u32 = u32::MAX;

/// Checks, counts and fingerprints messages.
#[derive(Debug)]
pub(super) struct Ledger {
    accounts: Vec<Account>,
    digest: Digest,
    sources: BTreeSet<u32>,
    tick_period_ns: u64,
    /// Tick of the newest world state; `None` before the first.
    newest: Option<u64>,
}

/// What is known of a topic's messages.
#[derive(Debug)]
struct Account {
    info: &'static TopicInfo,
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

impl Ledger {
    /// For a run of these processes, with this much simulated time between two ticks [ns].
    pub(super) fn new(processes: &[ProcessInfo], tick_period_ns: u64) -> Self {
        Self {
            accounts: topic_info::all()
                .iter()
                .map(|info| Account {
                    info,
                    sequences: Sequences::default(),
                    count: TopicCount::default(),
                })
                .collect(),
            digest: Digest::default(),
            sources: processes.iter().map(|p| p.index).collect(),
            tick_period_ns,
            newest: None,
        }
    }

    /// Enters a message of the topic at this place in the list of topics; `None` if there is no
    /// such topic. A message that is known from another run is not looked through again.
    pub(super) fn enter(
        &mut self,
        rank: usize,
        stamp: &Stamp,
        message: &Parts<'_>,
        beginning: Option<&Beginning>,
    ) -> Option<Verdict> {
        let account = self.accounts.get_mut(rank)?;
        let info = account.info;
        let known = self.sources.contains(&stamp.source);
        let source = if known { stamp.source } else { STRANGER };
        // Obstacle events are announced: all but those that a robot brings about come before the
        // first tick.
        let farthest = self.newest.unwrap_or(0).saturating_add(FARTHEST_AHEAD);
        let plausible = info.role == Role::Obstacle || stamp.tick <= farthest;
        let holds = known
            && plausible
            && (!info.simulated || on_time(stamp, self.tick_period_ns))
            && (beginning.is_some() || well_formed(info, message));
        let count = &mut account.count;
        if info.is_decodable(message.count) {
            count.messages += 1;
            count.bytes += message.cdr_len() as u64;
        }
        count.rejected += u64::from(!holds);
        if known {
            let missing = account.sequences.missing(source, stamp.sequence);
            count.gaps = count.gaps.saturating_add(missing);
        }
        let is_begun =
            beginning.is_some_and(|known| self.digest.begin(info.name, source, &known.hasher));
        if info.simulated && !is_begun {
            self.digest.update(info.name, source, message);
        }
        if info.role == Role::State && holds {
            self.newest = self.newest.max(Some(stamp.tick));
        }
        Some(Verdict { holds, plausible })
    }

    /// The state of the fingerprint behind the first message of a process, if it has sent nothing
    /// else of the topic.
    pub(super) fn beginning(&mut self, rank: usize, source: u32) -> Option<blake3::Hasher> {
        let info = self.accounts.get(rank)?.info;
        self.digest.beginning(info.name, source)
    }

    /// Tick of the newest world state; `None` before the first.
    pub(super) fn newest(&self) -> Option<u64> {
        self.newest
    }

    /// Every topic's name and what came in of it.
    pub(super) fn counts(&self) -> impl Iterator<Item = (&'static str, TopicCount)> + '_ {
        self.accounts.iter().map(|a| (a.info.name, a.count))
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
fn well_formed(info: &TopicInfo, message: &Parts<'_>) -> bool {
    use ipc_types::messages::world::MapHeader;

    if !info.is_decodable(message.count) {
        return false;
    }
    if info.role == Role::Map {
        let fits = MapHeader::read_from_prefix(message.header).is_ok_and(|(map, _)| {
            u64::from(map.width) * u64::from(map.height) == message.count as u64
        });
        if !fits {
            return false;
        }
    }
    info.finite
        .holds(message.header, message.elements, info.element_bytes)
}
