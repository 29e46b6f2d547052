//! The recording of a run, whoever delivers the messages.

use std::ops::Range;

use ipc_types::topics::{Topic, WorldState};

use super::error::LogError;
use super::gate::Observer;
use super::intake::{Entry, Intake};
use super::ledger::Ledger;
use super::mirror::Mirror;
use super::options::{Order, RecorderOptions};
use super::parts::Parts;
use super::sink::Sink;
use super::summary::Summary;
use super::topic_info;

/// Orders, checks, counts, fingerprints and writes the messages of a run.
///
/// Messages may be pushed in any order that keeps the order of each source; the log, the digest
/// and the summary do not depend on how those of different sources interleave.
pub struct Recording {
    intake: Intake,
    sink: Sink,
    ledger: Ledger,
    order: Order,
    /// The newest tick that is written.
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
            order: options.order,
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
        let newest = self.ledger.newest();
        // From here on only the copy counts: a hostile sender could still write to the original.
        let (entry, bytes) = self.intake.push::<T>(rank, header, elements);
        let message = Parts::of_cdr(info, bytes, elements.len());
        if let Some(verdict) = self.ledger.enter(rank, &entry.stamp, &message) {
            entry.rejected = !verdict.holds;
            // Who speaks outside of simulated history may do so late: about a tick that is written.
            if !verdict.plausible || (!info.simulated && entry.tick < self.written) {
                entry.tick = newest;
            }
        }
    }

    /// When a tick counts as complete.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Tick of the newest world state.
    pub fn newest_tick(&self) -> u64 {
        self.ledger.newest()
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
        self.written = self.written.max(completed);
        let sink = &mut self.sink;
        self.intake.take(Some(completed), |entry, bytes| {
            sink.write(entry, bytes, observer)
        })?;
        sink.end_of_tick()
    }

    /// Puts what is known of ticks that are not complete where only a log that ends there is
    /// read: for a world that stands still within a tick, so that a kill costs nothing that was
    /// said long before. Order and digest stay what they are.
    ///
    /// # Errors
    /// [`LogError`]; the recording is then at its end.
    pub fn put_by(&mut self, observer: &mut dyn Observer) -> Result<(), LogError> {
        let (sink, newest) = (&mut self.sink, self.ledger.newest());
        // The first state comes first whatever else is said in its tick, and with it there is a
        // log.
        let state = topic_info::rank::<WorldState>();
        self.intake.take_while(
            |entry| entry.tick == 0 && entry.rank == state,
            |entry, bytes| sink.write(entry, bytes, observer),
        )?;
        let begun = |entry: &Entry| entry.tick <= newest;
        sink.put_by(self.intake.waiting().filter(|(entry, _)| begun(entry)))
    }

    /// Whether one of these messages, counted from the first that was pushed, waits although its
    /// tick has begun.
    pub fn has_waiting(&self, pushed: Range<u64>) -> bool {
        let newest = self.ledger.newest();
        self.intake.has_waiting(newest, pushed)
    }

    /// Messages that have ever been pushed.
    pub fn arrivals(&self) -> u64 {
        self.intake.arrivals()
    }

    /// Hands what was written to the operating system if the last time is long enough ago.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), LogError> {
        self.sink.flush_if_due()
    }

    /// Writes what still waits, ends the log and says what it holds. A log that was to replace an
    /// older file and holds no world state is given up: the older file stays.
    ///
    /// # Errors
    /// [`LogError`]; what was written before stays readable.
    pub fn finish(mut self, observer: &mut dyn Observer) -> Result<Summary, LogError> {
        let (sink, newest) = (&mut self.sink, self.ledger.newest());
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
