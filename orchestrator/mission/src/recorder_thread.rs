//! The recorder of a run in its own thread, which sleeps at the tick barrier until there are messages to record.

use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use runtime::config::Clock;
use runtime::lockstep::BarrierMonitor;

use super::error::MissionError;
use super::progress::EventPrinter;
use super::resources::RunResources;
use recorder::{Recorder, RecorderError, Recording, Summary, Wakeup};

/// Requests to the recorder to receive all messages immediately. The recorder sleeps for many ticks. The messages
/// of a dead process are lost when its resources are freed, unless the recorder has connected to it before.
#[derive(Debug, Default)]
pub(super) struct DrainRequests {
    asked: AtomicU64,
    answered: AtomicU64,
    /// `true` while the recorder receives messages.
    open: AtomicBool,
}

impl DrainRequests {
    /// Maximum wait for the recorder, which may be writing to a slow disk.
    const MAX_WAIT: Duration = Duration::from_secs(5);
    /// Interval between two checks for its answer.
    const POLL_INTERVAL: Duration = Duration::from_micros(200);

    /// Returns when the recorder has received all messages sent before, or when it does not run.
    pub(super) fn drain(&self) {
        let call = self.asked.fetch_add(1, Ordering::SeqCst) + 1;
        let deadline = Instant::now() + Self::MAX_WAIT;
        while self.answered.load(Ordering::SeqCst) < call && self.open.load(Ordering::SeqCst) {
            if Instant::now() >= deadline {
                tracing::warn!(
                    "the recorder does not answer: the last messages of a process may be lost"
                );
                return;
            }
            std::thread::park_timeout(Self::POLL_INTERVAL);
        }
    }

    /// Marks the start or the end of the time in which the recorder receives messages.
    fn open(&self, open: bool) {
        self.open.store(open, Ordering::SeqCst);
    }
}

/// Wakeup of the recorder when there are messages to record; also makes the simulator wait for it.
#[derive(Debug, Clone)]
struct BarrierWakeup {
    monitor: BarrierMonitor,
    clock: Clock,
    ended: Arc<AtomicBool>,
    requests: Arc<DrainRequests>,
}

impl BarrierWakeup {
    /// Creates a wakeup over the barrier; `ended` is set once no process of the run sends messages.
    fn new(
        monitor: BarrierMonitor,
        clock: Clock,
        ended: Arc<AtomicBool>,
        requests: Arc<DrainRequests>,
    ) -> Self {
        Self {
            monitor,
            clock,
            ended,
            requests,
        }
    }
}

impl Wakeup for BarrierWakeup {
    fn wait(&self, timeout: Duration) {
        if self.ended() {
            return;
        }
        if self.clock != Clock::LockStep
            && let Some(tick) = self.monitor.completed_tick()
        {
            // In real-time mode no process waits for the log: the recorder wakes for messages that it has not received,
            // not for messages that are not written.
            self.monitor.recorded(tick);
        }
        self.monitor.wait_for_records(timeout);
    }

    fn completed_tick(&self) -> Option<u64> {
        if self.clock != Clock::LockStep {
            return None;
        }
        self.monitor.completed_tick()
    }

    fn recorded(&self, tick: u64) {
        self.monitor.recorded(tick);
    }

    fn calls(&self) -> u64 {
        self.requests.asked.load(Ordering::SeqCst)
    }

    fn answer(&self, calls: u64) {
        self.requests.answered.store(calls, Ordering::SeqCst);
    }

    fn ended(&self) -> bool {
        self.ended.load(Ordering::SeqCst)
    }
}

/// The recorder and its thread.
pub(super) struct RecorderThread {
    thread: JoinHandle<Result<Summary, RecorderError>>,
    connect: mpsc::Sender<()>,
    connected: mpsc::Receiver<()>,
    /// Set once no process sends messages.
    ended: Arc<AtomicBool>,
    /// Descriptor that is readable when the thread has ended.
    pub(super) wake: OwnedFd,
}

impl RecorderThread {
    /// Starts the thread, which answers `requests`; returns once its subscriptions exist.
    ///
    /// # Errors
    /// [`MissionError`] if the system refuses.
    pub(super) fn start(
        resources: &RunResources,
        requests: Arc<DrainRequests>,
        recording: Recording,
        mut printer: EventPrinter,
    ) -> Result<Self, MissionError> {
        let run = &resources.plan.run;
        let system = |what: &str| {
            let what = what.to_owned();
            move |source: std::io::Error| MissionError::System { what, source }
        };
        let (wake, ended_end) = rustix::pipe::pipe_with(rustix::pipe::PipeFlags::CLOEXEC)
            .map_err(|e| system("cannot make a pipe")(e.into()))?;
        let (connect, do_connect) = mpsc::channel();
        let (tell, connected) = mpsc::channel();
        let ended = Arc::new(AtomicBool::new(false));
        let wakeup = BarrierWakeup::new(
            BarrierMonitor::new(Arc::clone(&resources.barrier)),
            run.clock,
            Arc::clone(&ended),
            Arc::clone(&requests),
        );
        let (space, bus_options) = (run.space()?, run.bus_options());
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                // The end of the thread for any reason closes it, which wakes the supervisor.
                let _wake = ended_end;
                // Ports of the bus belong to the thread that opens them.
                let bus =
                    Bus::join(&space, bus_options, "recorder").map_err(RecorderError::Subscribe)?;
                let recorder = Recorder::open(&bus, recording)?;
                let _ = tell.send(());
                // Both channels close if the run ends before its first tick.
                if do_connect.recv().is_ok() {
                    recorder.update_connections()?;
                }
                let _ = tell.send(());
                requests.open(true);
                let recorded = recorder.run(&wakeup, &mut printer);
                requests.open(false);
                recorded
            })
            .map_err(system("cannot start the recorder's thread"))?;
        let recorder = Self {
            thread,
            connect,
            connected,
            ended,
            wake,
        };
        // Its subscriptions must exist before the first message is sent.
        let _ = recorder.connected.recv();
        Ok(recorder)
    }

    /// Returns `true` if the thread has ended; its result contains the cause.
    pub(super) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Connects to all publishers, which must exist.
    pub(super) fn connect(&self) {
        let _ = self.connect.send(());
        let _ = self.connected.recv();
    }

    /// Marks the end of all messages and waits for the summary.
    ///
    /// # Errors
    /// The error of the recorder.
    pub(super) fn finish(self) -> Result<Summary, MissionError> {
        self.ended.store(true, Ordering::SeqCst);
        drop(self.connect);
        match self.thread.join() {
            Ok(result) => Ok(result?),
            Err(_) => Err(MissionError::RecorderLost),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_waits_for_a_drain_that_began_after_it() {
        let requests = DrainRequests::default();
        requests.drain();
        requests.open(true);
        let (seen, called) = (AtomicU64::new(0), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while requests.open.load(Ordering::SeqCst) {
                    let asked = requests.asked.load(Ordering::SeqCst);
                    // The check of the thread that requests.
                    if called.load(Ordering::SeqCst) {
                        seen.fetch_add(1, Ordering::SeqCst);
                    }
                    requests.answered.store(asked, Ordering::SeqCst);
                }
            });
            called.store(true, Ordering::SeqCst);
            requests.drain();
            assert!(seen.load(Ordering::SeqCst) > 0, "answered without a check");
            requests.open(false);
        });
        // A request to a recorder that has ended returns at once.
        requests.drain();
    }
}
