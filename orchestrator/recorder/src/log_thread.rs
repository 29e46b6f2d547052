//! The log of a run on its own thread: derived channels, encoding, compression and writing.

use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use ipc_types::consumer::LoggedMessage;
use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;
use mcap_log::LogWriteError;

use super::log::Log;
use super::summary::Summary;

/// Size of the messages at which a batch is passed on (bytes).
const BATCH_BYTES: usize = 64 * 1024;

/// Age at which a batch is passed on with the next end of a tick: viewers see messages not much later.
const MAX_AGE: Duration = Duration::from_millis(10);

/// Maximum number of batches that wait for the thread; with more, the recorder waits.
const MAX_WAITING: usize = 8;

/// A message of a batch.
struct Entry {
    topic: TopicId,
    stamp: Stamp,
    time_ns: u64,
    /// Length (bytes).
    length: usize,
    rejected: bool,
}

/// Messages and ends of ticks, in order.
#[derive(Default)]
struct Batch {
    /// `None` at the end of a tick.
    entries: Vec<Option<Entry>>,
    bytes: Vec<u8>,
    /// `true` if the thread shall flush what is due, and answer.
    flush: bool,
}

/// The thread of a log. Its errors are returned by one of the next calls.
pub(super) struct LogThread {
    batch: Batch,
    batches: Option<SyncSender<Batch>>,
    flushed: Receiver<()>,
    /// Absent after an error.
    thread: Option<JoinHandle<Result<Log, LogWriteError>>>,
    path: PathBuf,
    flush_every: Duration,
    last_flush: Instant,
    last_passed: Instant,
}

impl LogThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// [`LogWriteError::Create`] if the system refuses.
    pub(super) fn start(log: Log) -> Result<Self, LogWriteError> {
        let (path, flush_every) = (log.path().to_owned(), log.flush_every());
        let (batches, waiting) = mpsc::sync_channel(MAX_WAITING);
        let (tell, flushed) = mpsc::sync_channel(1);
        let thread = Builder::new().name("log".into());
        let thread = thread.spawn(move || write(log, &waiting, &tell));
        Ok(Self {
            batch: Batch::default(),
            batches: Some(batches),
            flushed,
            thread: Some(thread.map_err(|source| LogWriteError::Create {
                path: path.clone(),
                source,
            })?),
            path,
            flush_every,
            last_flush: Instant::now(),
            last_passed: Instant::now(),
        })
    }

    /// Returns the path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a message.
    pub(super) fn message(
        &mut self,
        message: &LoggedMessage<'_>,
        rejected: bool,
    ) -> Result<(), LogWriteError> {
        let LoggedMessage {
            topic,
            stamp,
            time_ns,
            bytes,
        } = *message;
        self.batch.bytes.extend_from_slice(bytes);
        self.batch.entries.push(Some(Entry {
            topic,
            stamp,
            time_ns,
            length: bytes.len(),
            rejected,
        }));
        if self.batch.bytes.len() >= BATCH_BYTES {
            return self.pass_on(false);
        }
        Ok(())
    }

    /// Ends the current tick after its last message.
    pub(super) fn end_of_tick(&mut self) -> Result<(), LogWriteError> {
        self.batch.entries.push(None);
        if self.last_passed.elapsed() >= MAX_AGE {
            return self.pass_on(false);
        }
        Ok(())
    }

    /// Waits, twice per period of flushes, until the thread has written everything.
    pub(super) fn flush_if_due(&mut self) -> Result<(), LogWriteError> {
        if self.last_flush.elapsed() * 2 >= self.flush_every {
            self.last_flush = Instant::now();
            return self.pass_on(true);
        }
        Ok(())
    }

    /// Writes the rest and the result of the run, closes the file, and enters its totals into the summary.
    pub(super) fn finish(mut self, summary: &mut Summary) -> Result<(), LogWriteError> {
        self.pass_on(false)?;
        match self.end() {
            Some(log) => log?.finish(summary),
            None => Ok(()),
        }
    }

    fn pass_on(&mut self, flush: bool) -> Result<(), LogWriteError> {
        let mut batch = core::mem::take(&mut self.batch);
        batch.flush = flush;
        self.last_passed = Instant::now();
        let batches = self.batches.as_ref();
        let sent = batches.is_some_and(|batches| batches.send(batch).is_ok());
        if sent && (!flush || self.flushed.recv().is_ok()) {
            return Ok(());
        }
        self.end().map_or(Ok(()), |log| log.map(drop))
    }

    /// Waits for the end of the thread.
    fn end(&mut self) -> Option<Result<Log, LogWriteError>> {
        self.batches = None;
        let ended = self.thread.take()?.join();
        Some(ended.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

/// A recording without an end leaves a complete file.
impl Drop for LogThread {
    fn drop(&mut self) {
        let _ = self.pass_on(false);
        let _ = self.end();
    }
}

fn write(
    mut log: Log,
    batches: &Receiver<Batch>,
    flushed: &SyncSender<()>,
) -> Result<Log, LogWriteError> {
    for batch in batches {
        let mut rest = &batch.bytes[..];
        for entry in batch.entries {
            let Some(entry) = entry else {
                log.end_of_tick()?;
                continue;
            };
            let (bytes, behind) = rest.split_at(entry.length);
            rest = behind;
            let message = LoggedMessage {
                topic: entry.topic,
                stamp: entry.stamp,
                time_ns: entry.time_ns,
                bytes,
            };
            log.message(&message, entry.rejected)?;
        }
        if batch.flush {
            log.flush_if_due()?;
            let _ = flushed.send(());
        }
    }
    Ok(log)
}
