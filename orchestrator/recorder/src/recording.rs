//! The recording of a run, whoever delivers the messages.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::Received;
use ipc_types::cdr::SequenceHead;
use ipc_types::consumer::{Consumer, Consumers, LoggedMessage};
use ipc_types::stamp::Header as _;
use ipc_types::topics::{Topic, TopicId};
use mcap_log::{LogWriteError, LogWriter};
use zerocopy::IntoBytes as _;

use super::chain::Chain;
use super::checks::is_decodable;
use super::derived::DerivedTopics;
use super::digest_prefixes::DigestPrefixes;
use super::log::Log;
use super::message_audit::MessageAudit;
use super::outcome;
use super::parts::Parts;
use super::reorder_buffer::{Entry, ReorderBuffer};
use super::run_info::RunInfo;
use super::summary::{OutcomePart, Summary, TopicCount};

/// How long a tick that began waits for its messages before what there is of it is written: in real
/// time, where nothing says that a tick is complete, and when the world stands still within one.
const MAX_WAIT: Duration = Duration::from_millis(250);

/// Checks, counts and fingerprints the messages of a run as they come, puts them in order, and hands
/// them to their consumers: the outcome, the observer and, if there is one, the log.
///
/// Messages may be pushed in any order that keeps the order of each source; the log, the digest
/// and the summary do not depend on how those of different sources interleave.
pub struct Recording {
    audit: MessageAudit,
    latencies: Chain,
    reorder_buffer: ReorderBuffer,
    /// Ticks that began, and when that was seen; those of the last [`MAX_WAIT`], in order.
    begun: VecDeque<(Instant, u64)>,
    output: Output,
    /// The first messages of other runs in this process.
    digest_prefixes: Arc<DigestPrefixes>,
}

/// What gets the messages in their order.
struct Output {
    outcome: Consumers<dyn OutcomePart>,
    log: Option<Log>,
    tick_period_ns: u64,
    /// The newest tick that was written, perhaps in part.
    tick: u64,
}

impl Recording {
    /// Comes to the summary alone, without a log. `digest_prefixes` is what other runs in this process know
    /// of their maps.
    pub fn new(run: &RunInfo, digest_prefixes: Arc<DigestPrefixes>) -> Self {
        let (processes, tick_period_ns) = (&run.processes, run.tick_period_ns);
        Self {
            audit: MessageAudit::new(processes, tick_period_ns),
            latencies: Chain::new(processes),
            reorder_buffer: ReorderBuffer::default(),
            begun: VecDeque::new(),
            output: Output {
                outcome: outcome::parts(&run.robots, processes, tick_period_ns),
                log: None,
                tick_period_ns,
                tick: 0,
            },
            digest_prefixes,
        }
    }

    /// Writes everything into an empty log as well, with the channels that are derived from it.
    ///
    /// # Errors
    /// [`LogWriteError`] names the file.
    pub fn with_log(
        mut self,
        log: LogWriter,
        derived: Option<Box<dyn DerivedTopics>>,
    ) -> Result<Self, LogWriteError> {
        self.output.log = Some(Log::new(log, derived)?);
        Ok(self)
    }

    /// Takes a message. `in_place`: nothing can write to the message any more, so that it is copied
    /// only if it is needed later.
    pub(super) fn receive<T: Topic>(&mut self, message: &Received<T>, in_place: bool) {
        let (header, elements) = (message.header(), message.elements());
        if !in_place || self.output.wants(T::ID) {
            self.push::<T>(header, elements);
            return;
        }
        let stamp = header.stamp();
        let head = SequenceHead::of::<T>(elements.len());
        let parts = Parts::new(
            header.as_bytes(),
            &head,
            elements.as_bytes(),
            elements.len(),
        );
        let Some(shared) = message.shared() else {
            self.audit.enter(T::ID, stamp, &parts, None);
            return;
        };
        let known = self.digest_prefixes.find(shared, &parts);
        let verdict = self.audit.enter(T::ID, stamp, &parts, known.as_deref());
        if known.is_none()
            && verdict.holds
            && let Some(hasher) = self.audit.beginning(T::ID, stamp.source)
        {
            self.digest_prefixes.keep(shared, &parts, hasher);
        }
    }

    /// Takes a copy of a message.
    pub fn push<T: Topic>(&mut self, header: &T::Header, elements: &[T::Element]) {
        let (newest, stamp) = (self.audit.newest().unwrap_or(0), *header.stamp());
        // From here on only the copy counts: a hostile sender could still write to the original.
        let bytes = self.reorder_buffer.copy::<T>(header, elements);
        let parts = Parts::of_cdr(T::ID, bytes, elements.len());
        let verdict = self.audit.enter(T::ID, &stamp, &parts, None);
        if verdict.holds && T::ID.facts().timed {
            let message = LoggedMessage {
                topic: T::ID,
                stamp,
                time_ns: stamp.time_ns,
                bytes,
            };
            self.latencies.message(&message, &mut ());
        }
        if is_decodable(T::ID, elements.len()) && self.output.wants(T::ID) {
            // Who speaks outside of simulated history may do so late: about a tick that is written.
            let is_late = !T::ID.facts().simulated && stamp.tick < self.output.tick;
            let tick = if is_late || !verdict.plausible {
                newest
            } else {
                stamp.tick
            };
            self.reorder_buffer.keep(tick, T::ID, stamp, !verdict.holds);
        }
    }

    /// Bytes of messages whose tick has not been written yet.
    pub fn waiting_bytes(&self) -> usize {
        self.reorder_buffer.waiting_bytes()
    }

    /// Writes the messages of all ticks up to `completed`, in order.
    ///
    /// # Errors
    /// [`LogWriteError`]; the recording is then at its end.
    pub fn advance(
        &mut self,
        completed: u64,
        observer: &mut dyn Consumer,
    ) -> Result<(), LogWriteError> {
        self.write(completed, observer)?;
        self.output.end_of_tick()
    }

    /// Writes what is ready, in order: the messages of the ticks up to `completed`, all of which have
    /// been sent, and of those that began `MAX_WAIT` before `now`. What comes of such a tick
    /// later is written at the next look. Before the first world state nothing is ready, so that it
    /// comes first.
    ///
    /// # Errors
    /// [`LogWriteError`]; the recording is then at its end.
    pub fn write_ready(
        &mut self,
        completed: Option<u64>,
        now: Instant,
        observer: &mut dyn Consumer,
    ) -> Result<(), LogWriteError> {
        if let Some(newest) = self.audit.newest()
            && self.begun.back().is_none_or(|&(_, tick)| tick < newest)
        {
            self.begun.push_back((now, newest));
        }
        let waited = |at: Instant| now.saturating_duration_since(at) >= MAX_WAIT;
        let due = self.begun.partition_point(|&(at, _)| waited(at));
        // The last of them stays, so that it is not taken for a new one.
        self.begun.drain(..due.saturating_sub(1));
        let due = self.begun.front().filter(|&&(at, _)| waited(at));
        let Some(last) = completed.max(due.map(|&(_, tick)| tick)) else {
            return Ok(());
        };
        self.write(last, observer)?;
        // The picture of a tick that is not complete waits for the rest of it.
        if completed >= Some(last) {
            self.output.end_of_tick()?;
        }
        Ok(())
    }

    fn write(&mut self, last: u64, observer: &mut dyn Consumer) -> Result<(), LogWriteError> {
        let output = &mut self.output;
        output.tick = output.tick.max(last);
        self.reorder_buffer.take(Some(last), |entry, bytes| {
            output.message(entry, bytes, observer)
        })
    }

    /// Hands what was written to the operating system if the last time is long enough ago.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), LogWriteError> {
        match &mut self.output.log {
            Some(log) => log.flush_if_due(),
            None => Ok(()),
        }
    }

    /// Writes what still waits, ends the log and says what the run amounted to.
    ///
    /// # Errors
    /// [`LogWriteError`]; what was written before stays readable.
    pub fn finish(mut self, observer: &mut dyn Consumer) -> Result<Summary, LogWriteError> {
        let (output, newest) = (&mut self.output, self.audit.newest().unwrap_or(0));
        self.reorder_buffer.take(None, |entry, bytes| {
            // Announced for a time that never came: kept, but neither shown nor at that time.
            let too_late = entry.tick > newest && entry.topic.facts().simulated;
            let mut entry = *entry;
            entry.tick = entry.tick.min(newest);
            entry.rejected |= too_late;
            output.message(&entry, bytes, observer)
        })?;
        let topics = self
            .audit
            .counts()
            .filter(|(_, count)| *count != TopicCount::default())
            .map(|(name, count)| (name.to_owned(), count))
            .collect();
        let Output { outcome, log, .. } = self.output;
        let mut summary = Summary {
            digest: self.audit.digest(),
            topics,
            latency_us: self.latencies.percentiles(),
            ..Summary::default()
        };
        for part in outcome.into_list() {
            part.finish(&mut summary);
        }
        if let Some(log) = log {
            log.finish(&mut summary)?;
        }
        Ok(summary)
    }
}

impl Output {
    /// Whether messages of this topic go to anything but the audit and the latencies.
    fn wants(&self, topic: TopicId) -> bool {
        self.log.is_some() || self.outcome.take(topic)
    }

    fn message(
        &mut self,
        entry: &Entry,
        bytes: &[u8],
        observer: &mut dyn Consumer,
    ) -> Result<(), LogWriteError> {
        let message = LoggedMessage {
            topic: entry.topic,
            stamp: entry.stamp,
            time_ns: entry.tick.saturating_mul(self.tick_period_ns),
            bytes,
        };
        if let Some(log) = &mut self.log {
            log.message(&message, entry.rejected)?;
        }
        if !entry.rejected {
            self.outcome.message(&message, &mut ());
            if observer.topics().contains(&message.topic) {
                observer.message(&message, &mut ());
            }
        }
        Ok(())
    }

    fn end_of_tick(&mut self) -> Result<(), LogWriteError> {
        match &mut self.log {
            Some(log) => log.end_of_tick(),
            None => Ok(()),
        }
    }
}

impl core::fmt::Debug for Recording {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Recording")
            .field("newest", &self.audit.newest())
            .finish_non_exhaustive()
    }
}
