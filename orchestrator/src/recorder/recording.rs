//! The recording of a run, whoever delivers the messages.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use ipc_types::stamp::Header as _;
use ipc_types::topics::Topic;

use super::error::LogError;
use super::gate::Observer;
use super::intake::Intake;
use super::ledger::Ledger;
use super::mirror::Mirror;
use super::options::RecorderOptions;
use super::parts::Parts;
use super::sink::Sink;
use super::summary::Summary;
use super::topic_info;

/// How long a tick that began waits for its messages before what there is of it is written: in real
/// time, where nothing says that a tick is complete, and when the world stands still within one.
const LONGEST_WAIT: Duration = Duration::from_millis(250);

/// Orders, checks, counts, fingerprints and writes the messages of a run.
///
/// Messages may be pushed in any order that keeps the order of each source; the log, the digest
/// and the summary do not depend on how those of different sources interleave.
pub struct Recording {
    intake: Intake,
    sink: Sink,
    ledger: Ledger,
    /// Ticks that began, and when that was seen; those of the last [`LONGEST_WAIT`], in order.
    begun: VecDeque<(Instant, u64)>,
    /// The newest tick that is written, perhaps in part.
    written: u64,
}

impl Recording {
    /// Creates the log.
    ///
    /// # Errors
    /// [`LogError`] names the file.
    pub fn create(options: &RecorderOptions) -> Result<Self, LogError> {
        Self::create_mirrored(options, &mut None)
    }

    /// Creates the log; the mirror, if there is one, is taken once the file is there, and
    /// gets everything that goes into it.
    ///
    /// # Errors
    /// [`LogError`] names the file.
    pub fn create_mirrored(
        options: &RecorderOptions,
        mirror: &mut Option<Box<dyn Mirror>>,
    ) -> Result<Self, LogError> {
        Ok(Self {
            intake: Intake::default(),
            sink: Sink::create(options, mirror)?,
            ledger: Ledger::new(&options.processes, options.tick_period_ns),
            begun: VecDeque::new(),
            written: 0,
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
        let Some(info) = topic_info::all().get(rank) else {
            return;
        };
        let (newest, stamp) = (self.ledger.newest().unwrap_or(0), *header.stamp());
        // From here on only the copy counts: a hostile sender could still write to the original.
        let bytes = self.intake.copy::<T>(header, elements);
        let message = Parts::of_cdr(info, bytes, elements.len());
        let Some(verdict) = self.ledger.enter(rank, &stamp, &message) else {
            return;
        };
        if info.is_decodable(elements.len()) {
            // Who speaks outside of simulated history may do so late: about a tick that is written.
            let is_late = !info.simulated && stamp.tick < self.written;
            let tick = if is_late || !verdict.plausible {
                newest
            } else {
                stamp.tick
            };
            self.intake.keep(tick, rank, stamp, !verdict.holds);
        }
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
        self.write(completed, observer)?;
        self.sink.end_of_tick()
    }

    fn write(&mut self, last: u64, observer: &mut dyn Observer) -> Result<(), LogError> {
        self.written = self.written.max(last);
        let sink = &mut self.sink;
        self.intake.take(Some(last), |entry, bytes| {
            sink.write(entry, bytes, observer)
        })
    }

    /// Writes what is ready, in order: the messages of the ticks up to `completed`, all of which have
    /// been sent, and of those that began [`LONGEST_WAIT`] before `now`. What comes of such a tick
    /// later is written at the next look. Before the first world state nothing is ready, so that it
    /// comes first.
    ///
    /// # Errors
    /// [`LogError`]; the recording is then at its end.
    pub fn write_ready(
        &mut self,
        completed: Option<u64>,
        now: Instant,
        observer: &mut dyn Observer,
    ) -> Result<(), LogError> {
        if let Some(newest) = self.ledger.newest()
            && self.begun.back().is_none_or(|&(_, tick)| tick < newest)
        {
            self.begun.push_back((now, newest));
        }
        let waited = |at: Instant| now.saturating_duration_since(at) >= LONGEST_WAIT;
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
            self.sink.end_of_tick()?;
        }
        Ok(())
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
        let (sink, newest) = (&mut self.sink, self.ledger.newest().unwrap_or(0));
        self.intake.take(None, |entry, bytes| {
            // Announced for a time that never came: kept, but neither shown nor at that time.
            let too_late = entry.tick > newest && is_simulated(entry.rank);
            let mut entry = *entry;
            entry.tick = entry.tick.min(newest);
            entry.rejected |= too_late;
            sink.write(&entry, bytes, observer)
        })?;
        sink.end_of_tick()?;
        self.sink.finish(&mut self.ledger)
    }
}

/// Whether the topic at this place in the list is part of simulated history.
fn is_simulated(rank: usize) -> bool {
    topic_info::all()
        .get(rank)
        .is_none_or(|info| info.simulated)
}

impl core::fmt::Debug for Recording {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Recording")
            .field("newest", &self.ledger.newest())
            .finish_non_exhaustive()
    }
}
