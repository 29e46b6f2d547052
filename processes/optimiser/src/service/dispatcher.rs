//! The thread that owns the ports.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::Duration;

use ipc_types::bus::{
    ActiveRequest, Bus, BusOptions, Listener, Notifier, RunSpace, SendError, Server,
};
use ipc_types::clock;
use ipc_types::messages::optimiser::{PlanRequest, PlanResponse};
use ipc_types::topics::{MAX_EVENT_ID, OptimiserPlan, Service as _};
use runtime::ProcessError;
use trajectory::plan::Plan;

use super::pool::{Job, JobResult, Pool};
use super::recent_plans::Memory;
use crate::wire::{Refusal, decode_request, encode_answer};

/// Maximum time for which a lost wake-up, a disconnected client or the end of the run goes
/// unnoticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Inputs of the dispatcher.
#[derive(Debug, Clone)]
pub struct DispatcherInput {
    /// Shared-memory space of the run.
    pub space: RunSpace,
    /// Buffer layout of the run.
    pub options: BusOptions,
    /// Name of the process.
    pub name: String,
    /// Index of the process.
    pub source: u32,
    /// Threads that plan.
    pub workers: u32,
}

/// Running dispatcher; dropping it ends it and its workers.
#[derive(Debug)]
pub struct Dispatcher {
    thread: Option<JoinHandle<Result<(), ProcessError>>>,
    stop: Arc<AtomicBool>,
    refused: Arc<AtomicU64>,
}

impl Dispatcher {
    /// Starts it and waits until its ports are open.
    ///
    /// # Errors
    /// [`ProcessError`] if a port or a thread cannot be created.
    pub fn start(given: DispatcherInput) -> Result<Self, ProcessError> {
        let stop = Arc::new(AtomicBool::new(false));
        let refused = Arc::new(AtomicU64::new(0));
        let (tell, opened) = mpsc::channel();
        let flags = (Arc::clone(&stop), Arc::clone(&refused));
        let thread = std::thread::Builder::new()
            .name("dispatcher".to_owned())
            .spawn(move || {
                // Ports belong to the thread that opened them.
                let mut state = DispatcherState::open(&given, flags)?;
                let _ = tell.send(());
                state.serve()
            })
            .map_err(|e| ProcessError::system("cannot start the dispatcher", e))?;
        let mut dispatcher = Self {
            thread: Some(thread),
            stop,
            refused,
        };
        match opened.recv() {
            Ok(()) => Ok(dispatcher),
            // The thread ended before it reported its start.
            Err(_) => dispatcher.end().map(|()| dispatcher),
        }
    }

    /// Checks that the thread still runs.
    ///
    /// # Errors
    /// The error with which the thread ended.
    pub fn check(&mut self) -> Result<(), ProcessError> {
        match &self.thread {
            Some(thread) if !thread.is_finished() => Ok(()),
            _ => self.end(),
        }
    }

    /// Waits for its end, which must be near.
    fn end(&mut self) -> Result<(), ProcessError> {
        let ended = |what: &str| ProcessError::Algorithm(format!("the dispatcher {what}"));
        let thread = self.thread.take().ok_or_else(|| ended("has ended"))?;
        let result = thread.join().map_err(|_| ended("panicked"))?;
        result.and_then(|()| Err(ended("ended before the run")))
    }

    /// Returns the number of invalid requests so far.
    pub fn refused(&self) -> u64 {
        self.refused.load(Ordering::Relaxed)
    }
}

impl Drop for Dispatcher {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take()
            && let Ok(Err(error)) = thread.join()
        {
            tracing::error!("dispatcher: {error}");
        }
    }
}

/// Request in progress.
struct OpenRequest {
    id: u64,
    request: ActiveRequest<OptimiserPlan>,
    cancelled: Arc<AtomicBool>,
}

/// State of the dispatcher thread.
struct DispatcherState {
    stop: Arc<AtomicBool>,
    refused: Arc<AtomicU64>,
    // Closed in this order: the dispatcher stops answering only after the pool has stopped
    // planning.
    pool: Pool,
    open: Vec<OpenRequest>,
    server: Server<OptimiserPlan>,
    asked: Listener,
    answered: Notifier,
    next_id: u64,
    done: Vec<JobResult>,
    memory: Memory,
}

impl DispatcherState {
    fn open(
        given: &DispatcherInput,
        (stop, refused): (Arc<AtomicBool>, Arc<AtomicU64>),
    ) -> Result<Self, ProcessError> {
        let bus = Bus::join(&given.space, given.options, &given.name)?;
        let pool = Pool::start(given.workers)
            .map_err(|e| ProcessError::system("cannot start the workers", e))?;
        Ok(Self {
            stop,
            refused,
            pool,
            open: Vec::new(),
            // The first check of the service also finds requests from before the listener existed.
            asked: bus.listener(OptimiserPlan::ASKED)?,
            answered: bus.notifier(OptimiserPlan::ANSWERED)?,
            server: bus.server(given.source, PlanResponse::MAX_SAMPLES)?,
            next_id: 0,
            done: Vec::new(),
            memory: Memory::default(),
        })
    }

    /// Serves requests until the stop flag is set.
    fn serve(&mut self) -> Result<(), ProcessError> {
        while !self.stop.load(Ordering::Relaxed) {
            while let Some(request) = self.server.receive()? {
                self.take_up(request)?;
            }
            self.answer_what_is_done()?;
            self.drop_unwanted();
            self.asked
                .wait_or(self.pool.bell(), POLL_INTERVAL, |_| {})?;
        }
        for open in &self.open {
            open.cancelled.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    fn take_up(&mut self, request: ActiveRequest<OptimiserPlan>) -> Result<(), ProcessError> {
        let header = *request.header();
        self.cancel(header.robot)?;
        let decoded = decode_request(&header, request.elements());
        let (problem, options) = match decoded {
            Ok(decoded) => decoded,
            Err(error) => return self.answer(&request, &Err(error.into()), 0),
        };
        let id = self.next_id;
        self.next_id += 1;
        let cancelled = Arc::new(AtomicBool::new(false));
        self.open.push(OpenRequest {
            id,
            request,
            cancelled: Arc::clone(&cancelled),
        });
        self.pool.give(Job {
            id,
            problem,
            options,
            last: self.memory.followed(&header),
            deadline_ns: deadline_ns(&header, clock::monotonic_ns()),
            cancelled,
        });
        Ok(())
    }

    /// Answers the pending request of a robot that has sent a newer one.
    fn cancel(&mut self, robot: u32) -> Result<(), ProcessError> {
        let of_robot = |open: &OpenRequest| open.request.header().robot == robot;
        while let Some(at) = self.open.iter().position(of_robot) {
            let open = self.open.remove(at);
            open.cancelled.store(true, Ordering::Relaxed);
            self.pool.take_back(open.id);
            self.answer(&open.request, &Err(Refusal::Cancelled { robot }), 0)?;
        }
        Ok(())
    }

    fn answer_what_is_done(&mut self) -> Result<(), ProcessError> {
        let mut done = std::mem::take(&mut self.done);
        self.pool.collect(&mut done);
        for done in done.drain(..) {
            // A request that was cancelled meanwhile has been answered.
            if let Some(at) = self.open.iter().position(|open| open.id == done.id) {
                let open = self.open.remove(at);
                self.answer(&open.request, &done.result, done.solve_ns)?;
                if let Ok(plan) = done.result {
                    self.memory.keep(open.request.header(), plan);
                }
            }
        }
        self.done = done;
        Ok(())
    }

    /// Cancels jobs of requests that their clients have dropped.
    fn drop_unwanted(&mut self) {
        let pool = &self.pool;
        self.open.retain(|open| {
            let wanted = open.request.is_wanted();
            if !wanted {
                open.cancelled.store(true, Ordering::Relaxed);
                pool.take_back(open.id);
            }
            wanted
        });
    }

    /// Sends an answer and wakes the client. A failure with one client must not delay the answers
    /// to others.
    fn answer(
        &self,
        request: &ActiveRequest<OptimiserPlan>,
        result: &Result<Plan, Refusal>,
        solve_ns: u64,
    ) -> Result<(), ProcessError> {
        let header = request.header();
        if let Err(refusal) = result
            && refusal.is_of_request()
        {
            self.refused.fetch_add(1, Ordering::Relaxed);
            tracing::debug!("request of robot {} rejected: {refusal}", header.robot);
        }
        let (response, samples) = encode_answer(header, result, solve_ns);
        match request.answer(response, &samples) {
            Ok(()) => {}
            Err(SendError::Transport { reason, .. }) => {
                tracing::warn!("cannot answer robot {}: {reason}", header.robot);
                return Ok(());
            }
            Err(error) => return Err(error.into()),
        }
        let client = (header.stamp.source as usize).min(MAX_EVENT_ID);
        if let Err(error) = self.answered.notify(client) {
            // The client polls before long.
            tracing::warn!("cannot wake the client of robot {}: {error}", header.robot);
        }
        Ok(())
    }
}

/// Returns the monotonic time at which a request expires (ns). It counts from the time of sending,
/// if that is plausible.
fn deadline_ns(header: &PlanRequest, now_ns: u64) -> Option<u64> {
    let sent_ns = header.stamp.sent_ns;
    let from = if sent_ns == 0 {
        now_ns
    } else {
        sent_ns.min(now_ns)
    };
    (header.deadline_ns > 0).then(|| from.saturating_add(header.deadline_ns))
}

#[cfg(test)]
mod tests {
    use ipc_types::stamp::Stamp;

    use super::*;

    #[test]
    fn time_runs_from_the_sending_unless_that_lies_ahead() {
        let deadline = |sent_ns, deadline_ns| {
            let stamp = Stamp {
                sent_ns,
                ..Stamp::default()
            };
            let header = PlanRequest {
                stamp,
                deadline_ns,
                ..PlanRequest::default()
            };
            super::deadline_ns(&header, 1000)
        };
        assert_eq!(deadline(900, 0), None);
        assert_eq!(deadline(900, 50), Some(950));
        assert_eq!(deadline(0, 50), Some(1050));
        assert_eq!(deadline(u64::MAX, 50), Some(1050));
        assert_eq!(deadline(900, u64::MAX), Some(u64::MAX));
    }
}
