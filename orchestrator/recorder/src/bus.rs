//! From the bus into the recording.

use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::consumer::Consumer;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};

use super::error::RecorderError;
use super::recording::Recording;
use super::summary::Summary;
use super::wakeup::Wakeup;

/// Longest sleep between two looks at the bus. Messages gather meanwhile, so that the recorder is
/// woken per batch and not per tick; a wakeup wakes it earlier when the simulator is about to be
/// held back.
const NAP: Duration = Duration::from_millis(10);

/// Most messages taken from one topic before the others get their turn.
const TURN: usize = 16_384;

/// Records every topic of a run.
///
/// The ports of the bus belong to one thread: open the recorder on the thread that runs it.
pub struct Recorder {
    taps: Vec<Box<dyn AnySubscriber>>,
    /// Whether messages stay as they are sent: those of one thread.
    in_place: bool,
    recording: Recording,
}

impl Recorder {
    /// Subscribes to every topic; the services must exist. (The recording comes from outside so
    /// that a log that cannot be created is reported before anything is started.)
    ///
    /// # Errors
    /// [`RecorderError::Subscribe`].
    pub fn open(bus: &Bus, recording: Recording) -> Result<Self, RecorderError> {
        struct Open<'a>(&'a Bus, Vec<Box<dyn AnySubscriber>>);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                self.1.push(Box::new(self.0.recorder::<T>()?));
                Ok(())
            }
        }
        let mut open = Open(bus, Vec::new());
        for_each_topic(&mut open)?;
        Ok(Self {
            taps: open.1,
            in_place: bus.is_local(),
            recording,
        })
    }

    /// Connects to all publishers that exist by now (part of the run's handshake).
    ///
    /// # Errors
    /// [`RecorderError::Receive`].
    pub fn update_connections(&self) -> Result<(), RecorderError> {
        self.taps
            .iter()
            .try_for_each(|tap| tap.connect())
            .map_err(RecorderError::from)
    }

    /// Records until the wakeup says that the run has ended.
    ///
    /// # Errors
    /// [`RecorderError`]; what was written before stays readable.
    pub fn run(
        mut self,
        wakeup: &dyn Wakeup,
        observer: &mut dyn Consumer,
    ) -> Result<Summary, RecorderError> {
        let mut recorded = None;
        loop {
            // What the wakeup says must be known before the buffers are looked at: then every
            // message that it speaks of is in them.
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
                wakeup.wait(NAP);
            }
        }
        Ok(self.recording.finish(observer)?)
    }

    /// Takes what is there and writes all ticks up to `completed`: for runs in one thread, which
    /// know themselves when a tick is complete.
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

    /// Ends the log of a run that was recorded with [`Recorder::take`].
    ///
    /// # Errors
    /// As [`Recorder::run`].
    pub fn finish(mut self, observer: &mut dyn Consumer) -> Result<Summary, RecorderError> {
        while !self.drain()? {}
        Ok(self.recording.finish(observer)?)
    }

    /// Takes what is there; `false` if there may be more.
    fn drain(&mut self) -> Result<bool, ReceiveError> {
        let mut empty = true;
        for tap in &self.taps {
            empty &= tap.drain(&mut self.recording, self.in_place)?;
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

/// A subscriber without its type.
trait AnySubscriber {
    fn connect(&self) -> Result<(), ReceiveError>;
    /// Takes messages; `false` if there may be more.
    fn drain(&self, recording: &mut Recording, in_place: bool) -> Result<bool, ReceiveError>;
}

impl<T: Topic> AnySubscriber for Subscriber<T> {
    fn connect(&self) -> Result<(), ReceiveError> {
        self.update_connections()
    }

    fn drain(&self, recording: &mut Recording, in_place: bool) -> Result<bool, ReceiveError> {
        for _ in 0..TURN {
            match self.receive()? {
                Some(message) => recording.receive(&message, in_place),
                None => return Ok(true),
            }
        }
        Ok(false)
    }
}
