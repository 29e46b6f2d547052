//! Subscriber of all topics, which feeds the recording.

use std::time::{Duration, Instant};

use ipc_types::bus::{AnySubscriber, AnyTopic, Bus, ReceiveError};
use ipc_types::consumer::Consumer;

use super::error::RecorderError;
use super::recording::Recording;
use super::summary::Summary;
use super::wakeup::Wakeup;

/// Maximum sleep between two drains of the bus. Messages accumulate meanwhile, so that the recorder wakes up
/// per batch and not per tick; a wakeup ends the sleep early if the simulator is about to wait for the
/// recorder.
const MAX_SLEEP: Duration = Duration::from_millis(10);

/// Maximum number of messages taken from one topic before the next topic.
const MAX_BATCH: usize = 16_384;

/// Recorder of every topic of a run.
///
/// The ports of the bus are bound to one thread: open the recorder on the thread that runs it.
pub struct Recorder {
    taps: Vec<Box<dyn AnySubscriber>>,
    /// `true` if sent messages are immutable, as in a run in one thread.
    in_place: bool,
    recording: Recording,
}

impl Recorder {
    /// Subscribes to every topic; the services must exist. (The caller creates the recording, so that it
    /// reports a log that cannot be created before it starts processes.)
    ///
    /// # Errors
    /// [`RecorderError::Subscribe`].
    pub fn open(bus: &Bus, recording: Recording) -> Result<Self, RecorderError> {
        let topics = AnyTopic::all().into_iter();
        Ok(Self {
            taps: topics
                .map(|topic| topic.recorder(bus))
                .collect::<Result<_, _>>()?,
            in_place: bus.is_local(),
            recording,
        })
    }

    /// Connects to all existing publishers (part of the start-up of the run).
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn update_connections(&self) -> Result<(), RecorderError> {
        self.taps
            .iter()
            .try_for_each(|tap| tap.update_connections())
            .map_err(RecorderError::from)
    }

    /// Records until the wakeup reports the end of the run.
    ///
    /// # Errors
    /// [`RecorderError`]; the log stays readable up to the last flush.
    pub fn run(
        mut self,
        wakeup: &dyn Wakeup,
        observer: &mut dyn Consumer,
    ) -> Result<Summary, RecorderError> {
        let mut recorded = None;
        loop {
            // The wakeup is read before the buffers, so that the buffers contain every message that it
            // announces.
            let ended = wakeup.ended();
            let completed = wakeup.completed_tick();
            let calls = wakeup.calls();
            let empty = self.drain()?;
            if empty {
                wakeup.answer(calls);
                if ended {
                    break;
                }
                self.recording
                    .write_ready(completed, Instant::now(), observer)?;
                if completed > recorded
                    && let Some(tick) = completed
                {
                    wakeup.recorded(tick);
                    recorded = completed;
                }
            }
            self.recording.flush_if_due()?;
            if empty {
                wakeup.wait(MAX_SLEEP);
            }
        }
        Ok(self.recording.finish(observer)?)
    }

    /// Takes all sent messages and writes all ticks up to `completed`, for runs in one thread.
    ///
    /// # Errors
    /// As [`Recorder::run`].
    pub fn take(
        &mut self,
        completed: u64,
        observer: &mut dyn Consumer,
    ) -> Result<(), RecorderError> {
        while !self.drain()? {}
        self.recording.advance(completed, observer)?;
        Ok(self.recording.flush_if_due()?)
    }

    /// Ends the recording of a run recorded with [`Recorder::take`].
    ///
    /// # Errors
    /// As [`Recorder::run`].
    pub fn finish(mut self, observer: &mut dyn Consumer) -> Result<Summary, RecorderError> {
        while !self.drain()? {}
        Ok(self.recording.finish(observer)?)
    }

    /// Takes sent messages; returns `false` if there may be more.
    fn drain(&mut self) -> Result<bool, ReceiveError> {
        let mut empty = true;
        for tap in &self.taps {
            empty &= tap.drain(MAX_BATCH, &mut |message| {
                self.recording.receive(message, self.in_place);
            })?;
        }
        Ok(empty)
    }
}

impl core::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Recorder")
            .field("recording", &self.recording)
            .finish_non_exhaustive()
    }
}
