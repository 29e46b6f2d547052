//! The recording of a run, whoever delivers the messages.

use std::collections::BTreeSet;

use ipc_types::stamp::Stamp;
use ipc_types::topics::{Shape, Topic};
use zerocopy::FromBytes;

use super::digest::Digest;
use super::error::LogError;
use super::gate::Observer;
use super::intake::Intake;
use super::options::{Order, RecorderOptions};
use super::sequence::Sequences;
use super::sink::Sink;
use super::summary::Summary;
use super::topic_info::{self, Role, TopicInfo};

/// A tick this far beyond the newest world state is not believed: its message would wait for ever.
const FARTHEST_AHEAD: u64 = 1024;

/// Stands for every source that is not a process of the run.
const STRANGER: u32 = u32::MAX;

/// Orders, checks, counts, fingerprints and writes the messages of a run.
///
/// Messages may be pushed in any order that keeps the order of each source; the log, the digest
/// and the summary do not depend on how those of different sources interleave.
pub struct Recording {
    intake: Intake,
    sink: Sink,
    digest: Digest,
    sequences: Vec<Sequences>,
    sources: BTreeSet<u32>,
    tick_period_ns: u64,
    order: Order,
    /// Tick of the newest world state.
    newest: u64,
}

impl Recording {
    /// Creates the log.
    ///
    /// # Errors
    /// [`LogError`] names the file.
    pub fn create(options: &RecorderOptions) -> Result<Self, LogError> {
        let sink = Sink::create(options)?;
        Ok(Self {
            intake: Intake::default(),
            sequences: sink.topics.iter().map(|_| Sequences::default()).collect(),
            sink,
            digest: Digest::default(),
            sources: options.processes.iter().map(|p| p.index).collect(),
            tick_period_ns: options.tick_period_ns,
            order: options.order,
            newest: 0,
        })
    }

    /// Takes a copy of a message. A topic that is not in the list of topics is ignored.
    pub fn push<T: Topic>(&mut self, header: &T::Header, elements: &[T::Element]) {
        self.push_ranked::<T>(topic_info::rank::<T>(), header, elements);
    }

    /// As [`Recording::push`], for callers that know the topic's place.
    pub(super) fn push_ranked<T: Topic>(
        &mut self,
        rank: usize,
        header: &T::Header,
        elements: &[T::Element],
    ) {
        let (Some(topic), Some(sequences)) =
            (self.sink.topics.get_mut(rank), self.sequences.get_mut(rank))
        else {
            return;
        };
        // From here on only the copy counts: a hostile sender could still write to the original.
        let (entry, bytes) = self.intake.push::<T>(rank, header, elements);
        let stamp = &entry.stamp;
        let known = self.sources.contains(&stamp.source);
        let source = if known { stamp.source } else { STRANGER };
        // Obstacle events are announced: all of them come before the first tick.
        let plausible = topic.info.role == Role::Obstacle
            || stamp.tick <= self.newest.saturating_add(FARTHEST_AHEAD);
        let holds = known
            && plausible
            && (!topic.info.simulated || on_time(stamp, self.tick_period_ns))
            && well_formed(&topic.info, elements.len(), bytes);
        if !holds {
            topic.rejected += 1;
            entry.rejected = true;
        }
        if known {
            let missing = sequences.missing(source, stamp.sequence);
            topic.gaps = topic.gaps.saturating_add(missing);
        }
        if topic.info.simulated {
            self.digest
                .update(topic.info.name, source, bytes, topic.info.header_bytes);
        }
        if !plausible {
            entry.tick = self.newest;
        } else if topic.info.role == Role::State && holds {
            self.newest = self.newest.max(entry.tick);
        }
    }

    /// When a tick counts as complete.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Tick of the newest world state.
    pub fn newest_tick(&self) -> u64 {
        self.newest
    }

    /// Bytes of messages whose tick is not complete yet.
    pub fn waiting_bytes(&self) -> usize {
        self.intake.waiting_bytes()
    }

    /// Writes the messages of all ticks up to `completed`, in order.
    ///
    /// # Errors
    /// [`LogError`]; the recording is then at its end.
    pub fn advance(&mut self, completed: u64, observer: &mut dyn Observer) -> Result<(), LogError> {
        let sink = &mut self.sink;
        self.intake.take(Some(completed), |entry, bytes| {
            sink.write(entry, bytes, observer)
        })?;
        sink.end_of_tick()
    }

    /// Hands what was written to the operating system if the last time is long enough ago.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), LogError> {
        self.sink.flush_if_due()
    }

    /// Writes what still waits, ends the log and says what it holds.
    ///
    /// # Errors
    /// [`LogError`]; what was written before stays readable.
    pub fn finish(mut self, observer: &mut dyn Observer) -> Result<Summary, LogError> {
        let sink = &mut self.sink;
        self.intake
            .take(None, |entry, bytes| sink.write(entry, bytes, observer))?;
        sink.end_of_tick()?;
        self.sink.finish(self.digest.finish())
    }
}

impl core::fmt::Debug for Recording {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Recording")
            .field("newest", &self.newest)
            .finish_non_exhaustive()
    }
}

/// Whether the simulated time is that of the tick.
fn on_time(stamp: &Stamp, tick_period_ns: u64) -> bool {
    stamp.tick.checked_mul(tick_period_ns) == Some(stamp.time_ns)
}

/// Whether a message has as many elements as it should, and only numbers that make sense.
fn well_formed(info: &TopicInfo, elements: usize, bytes: &[u8]) -> bool {
    use ipc_types::messages::world::MapHeader;

    if info.shape == Shape::One && elements != 1 {
        return false;
    }
    let header = bytes.get(4..).unwrap_or_default();
    if info.role == Role::Map {
        let fits = MapHeader::read_from_prefix(header)
            .is_ok_and(|(map, _)| u64::from(map.width) * u64::from(map.height) == elements as u64);
        if !fits {
            return false;
        }
    }
    let at = info.elements_at(bytes.len(), elements);
    let header = header.get(..info.header_bytes).unwrap_or_default();
    info.finite.holds(
        header,
        bytes.get(at..).unwrap_or_default(),
        info.element_bytes,
    )
}
