//! Client of the optimiser.

use std::time::{Duration, Instant};

use ipc_types::bus::{Answer, Bus, Client, Listener, Notifier, PendingResponse};
use ipc_types::messages::optimiser::PlanRequest;
use ipc_types::messages::world::ShapePoint;
use ipc_types::topics::{OptimiserPlan, PLAN_ANSWERED_EVENT, PLAN_ASKED_EVENT};

use crate::error::ProcessError;

/// Maximum time for which a lost wake-up goes unnoticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Wait after which the log says what the process waits for.
const LONG_WAIT: Duration = Duration::from_secs(5);

/// An answer of the optimiser: header and samples.
pub type PlanAnswer = Answer<OptimiserPlan>;

/// Client of `optimiser/plan`, with at most one pending request. It belongs to the thread that
/// opened it.
#[derive(Debug)]
pub struct OptimiserClient {
    client: Client<OptimiserPlan>,
    /// Wakes the optimiser; none on a bus in memory, where the answer is immediate.
    wake: Option<Notifier>,
    /// Listener for wake-ups of the optimiser.
    woken: Option<Listener>,
    source: u32,
    open: Option<PendingResponse<OptimiserPlan>>,
}

impl OptimiserClient {
    /// Opens the client of the process with index `source`.
    ///
    /// # Errors
    /// [`ProcessError::Bus`] if the service or its events do not exist.
    pub fn open(bus: &Bus, source: u32) -> Result<Self, ProcessError> {
        let between_processes = !bus.is_local();
        let wake = between_processes.then(|| bus.notifier(PLAN_ASKED_EVENT));
        let woken = between_processes.then(|| bus.listener(PLAN_ANSWERED_EVENT));
        Ok(Self {
            client: bus.client(source, PlanRequest::MAX_POINTS)?,
            wake: wake.transpose()?,
            woken: woken.transpose()?,
            source,
            open: None,
        })
    }

    /// Sends a request and drops a pending one.
    ///
    /// # Errors
    /// [`ProcessError::Send`] if the request does not fit or the transport fails.
    pub fn ask(&mut self, request: PlanRequest, points: &[ShapePoint]) -> Result<(), ProcessError> {
        // Dropped first: its place is needed.
        self.open = None;
        self.open = Some(self.client.ask(request, points)?);
        if let Some(wake) = &self.wake {
            wake.notify(self.source as usize)?;
        }
        Ok(())
    }

    /// Returns `true` if a request is pending.
    pub fn is_asking(&self) -> bool {
        self.open.is_some()
    }

    /// Drops a pending request.
    pub fn give_up(&mut self) {
        self.open = None;
    }

    /// Returns `true` if the server of the pending request has gone: no answer will come unless it
    /// is there already. The optimiser may have failed and may restart: ask again later.
    pub fn is_server_gone(&self) -> bool {
        self.open.as_ref().is_some_and(|open| !open.is_open())
    }

    /// Returns the answer, if it has arrived.
    ///
    /// # Errors
    /// [`ProcessError::Receive`] if the transport fails.
    pub fn poll(&mut self) -> Result<Option<PlanAnswer>, ProcessError> {
        let Some(open) = &self.open else {
            return Ok(None);
        };
        let answer = open.poll()?;
        if answer.is_some() {
            self.open = None;
        }
        Ok(answer)
    }

    /// Sleeps until the answer has arrived; `None` if no request is pending, or the optimiser ended
    /// without an answer. The wait has no time limit: a plan may take long on a busy machine, and the
    /// run ends an optimiser that hangs.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn wait(&mut self) -> Result<Option<PlanAnswer>, ProcessError> {
        let begun = Instant::now();
        let mut is_long = false;
        while self.open.is_some() {
            // Checked before the answer: an optimiser that answers and then ends has answered.
            let gone = self.is_server_gone();
            if let Some(answer) = self.poll()? {
                return Ok(Some(answer));
            }
            if gone {
                self.open = None;
                return Ok(None);
            }
            if begun.elapsed() >= LONG_WAIT && !is_long {
                is_long = true;
                tracing::warn!("no answer of the optimiser for {LONG_WAIT:?}: waits on");
            }
            if let Some(woken) = &self.woken {
                // The answer to another client wakes this one, too.
                woken.wait(POLL_INTERVAL, |_| {})?;
            }
        }
        Ok(None)
    }
}
