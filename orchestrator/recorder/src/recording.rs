//! Recording of a run, independent of the source of messages.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::AnyMessage;
use ipc_types::consumer::{Consumer, Consumers, LoggedMessage};
use ipc_types::topics::{Topic, TopicId};
use mcap_log::{LogWriteError, LogWriter};

use super::chain::Chain;
use super::checks::is_decodable;
use super::derived::DerivedTopics;
use super::digest_prefixes::DigestPrefixes;
use super::log::Log;
use super::log_thread::LogThread;
use super::message_audit::MessageAudit;
use super::outcome;
use super::parts::Parts;
use super::reorder_buffer::{Entry, ReorderBuffer};
use super::run_info::{RobotInfo, RunInfo};
use super::summary::{OutcomePart, Summary, TopicCount};

/// Maximum wait for the messages of a tick before the available ones are written: in real time, where no
/// barrier marks a tick as complete, and when the world stops within a tick.
const MAX_WAIT: Duration = Duration::from_millis(250);

/// Checks, counts, hashes and sorts the messages of a run, and passes them to the consumers: the summary, the
/// observer and the optional log.
///
/// Messages may be pushed in any order that keeps the order of each source. Log, digest and summary do not
/// depend on the interleaving of sources.
pub struct Recording {
    audit: MessageAudit,
    latencies: Chain,
    reorder_buffer: ReorderBuffer,
    /// Ticks that began within the last [`MAX_WAIT`], with the time of detection, in order.
    begun: VecDeque<(Instant, u64)>,
    output: Output,
    /// Digest prefixes of other runs in this process.
    digest_prefixes: Arc<DigestPrefixes>,
}

/// Consumers of the ordered messages.
struct Output {
    outcome: Consumers<dyn OutcomePart>,
    log: Option<LogThread>,
    /// The robots, by index.
    robots: Vec<RobotInfo>,
    tick_period_ns: u64,
    /// Newest tick that was written, at least in part.
    tick: u64,
}

impl Recording {
    /// Creates a recording without a log. `digest_prefixes` contains the maps of other runs in this process.
    pub fn new(run: &RunInfo, digest_prefixes: Arc<DigestPrefixes>) -> Self {
        let (processes, tick_period_ns) = (&run.processes, run.tick_period_ns);
        Self {
            audit: MessageAudit::new(processes, tick_period_ns),
            latencies: Chain::new(processes),
            reorder_buffer: ReorderBuffer::default(),
            begun: VecDeque::new(),
            output: Output {
                outcome: outcome::parts(run),
                log: None,
                robots: run.robots.clone(),
                tick_period_ns,
                tick: 0,
            },
            digest_prefixes,
        }
    }

    /// Adds an empty log, with derived channels. It is written on a thread of its own.
    ///
    /// # Errors
    /// [`LogWriteError`].
    pub fn with_log(
        mut self,
        log: LogWriter,
        derived: Option<Box<dyn DerivedTopics>>,
    ) -> Result<Self, LogWriteError> {
        let log = Log::new(log, &self.output.robots, derived)?;
        self.output.log = Some(LogThread::start(log)?);
        Ok(self)
    }

    /// Returns the path of the log, if there is one.
    pub fn log_path(&self) -> Option<&Path> {
        self.output.log.as_ref().map(LogThread::path)
    }

    /// Adds a message. `in_place`: the message is immutable and is copied only if it is needed later.
    pub(super) fn receive(&mut self, message: &AnyMessage<'_>, in_place: bool) {
        let topic = message.topic;
        if !in_place || self.output.wants(topic) {
            self.add(message);
            return;
        }
        let head = message.head();
        let parts = Parts::new(message, &head);
        let Some(shared) = message.shared else {
            self.audit.enter(topic, message.stamp, &parts, None);
            return;
        };
        let known = self.digest_prefixes.find(shared, &parts);
        let verdict = self
            .audit
            .enter(topic, message.stamp, &parts, known.as_deref());
        if known.is_none()
            && verdict.is_valid
            && let Some(hasher) = self.audit.beginning(topic, message.stamp.source)
        {
            self.digest_prefixes.keep(shared, &parts, hasher);
        }
    }

    /// Adds a copy of a message.
    pub fn push<T: Topic>(&mut self, header: &T::Header, elements: &[T::Element]) {
        self.add(&AnyMessage::new::<T>(header, elements));
    }

    fn add(&mut self, message: &AnyMessage<'_>) {
        let topic = message.topic;
        let (newest, stamp) = (self.audit.newest().unwrap_or(0), *message.stamp);
        // From here on only the copy is used: a malicious sender could still write to the original.
        let bytes = self.reorder_buffer.copy(message);
        let parts = Parts::of_cdr(topic, bytes, message.count);
        let verdict = self.audit.enter(topic, &stamp, &parts, None);
        if verdict.is_valid && topic.facts().timed {
            let message = LoggedMessage {
                topic,
                stamp,
                time_ns: stamp.time_ns,
                bytes,
            };
            self.latencies.message(&message, &mut ());
        }
        if is_decodable(topic, message.count) && self.output.wants(topic) {
            // Messages outside the simulated history may be late, for a tick that is already written.
            let is_late = !topic.facts().simulated && stamp.tick < self.output.tick;
            let tick = if is_late || !verdict.plausible {
                newest
            } else {
                stamp.tick
            };
            self.reorder_buffer
                .keep(tick, topic, stamp, !verdict.is_valid);
        }
    }

    /// Returns the size of messages whose tick has not been written yet (bytes).
    pub fn waiting_bytes(&self) -> usize {
        self.reorder_buffer.waiting_bytes()
    }

    /// Writes the messages of all ticks up to `completed`, in order.
    ///
    /// # Errors
    /// [`LogWriteError`]; the recording must not be used afterwards.
    pub fn advance(
        &mut self,
        completed: u64,
        observer: &mut dyn Consumer,
    ) -> Result<(), LogWriteError> {
        self.write(completed, observer)?;
        self.output.end_of_tick()
    }

    /// Writes complete ticks, in order: those up to `completed`, whose messages have all been sent, and those
    /// that began `MAX_WAIT` before `now`. Later messages of such a tick are written at the next call.
    /// Writing begins with the first world state.
    ///
    /// # Errors
    /// [`LogWriteError`]; the recording must not be used afterwards.
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
        // The last of them is kept, so that it is not detected as new.
        self.begun.drain(..due.saturating_sub(1));
        let due = self.begun.front().filter(|&&(at, _)| waited(at));
        let Some(last) = completed.max(due.map(|&(_, tick)| tick)) else {
            return Ok(());
        };
        self.write(last, observer)?;
        // The end of an incomplete tick is not reported yet.
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

    /// Flushes the log if the last flush is long enough ago.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), LogWriteError> {
        match &mut self.output.log {
            Some(log) => log.flush_if_due(),
            None => Ok(()),
        }
    }

    /// Writes pending messages, ends the log and returns the summary.
    ///
    /// # Errors
    /// [`LogWriteError`]; the log stays readable up to the last flush.
    pub fn finish(mut self, observer: &mut dyn Consumer) -> Result<Summary, LogWriteError> {
        let (output, newest) = (&mut self.output, self.audit.newest().unwrap_or(0));
        self.reorder_buffer.take(None, |entry, bytes| {
            // Messages for a time after the end are logged with the time of the end, but not shown.
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
    /// Returns `true` if messages of this topic have consumers beside the audit and the latencies.
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
