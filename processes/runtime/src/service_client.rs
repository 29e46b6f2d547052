//! Client of a request–response service.

use std::time::{Duration, Instant};

use ipc_types::bus::{Answer, Bus, Client, Listener, Notifier, PendingResponse};
use ipc_types::topics::Service;

use crate::error::ProcessError;

/// Maximum time for which a lost wake-up goes unnoticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Wait after which the log says what the process waits for.
const LONG_WAIT: Duration = Duration::from_secs(5);

/// Client of a service, with at most one pending request. It belongs to the thread that opened it.
#[derive(Debug)]
pub struct ServiceClient<S: Service> {
    client: Client<S>,
    /// Wakes the server; none on a bus in memory, where the answer is immediate.
    wake: Option<Notifier>,
    /// Listener for wake-ups of the server.
    woken: Option<Listener>,
    source: u32,
    open: Option<PendingResponse<S>>,
}

impl<S: Service> ServiceClient<S> {
    /// Opens the client of the process with index `source`, for requests of at most `elements`.
    ///
    /// # Errors
    /// [`ProcessError::Bus`] if the service or its events do not exist.
    pub fn open(bus: &Bus, source: u32, elements: usize) -> Result<Self, ProcessError> {
        let between_processes = !bus.is_local();
        let wake = between_processes.then(|| bus.notifier(S::ASKED));
        let woken = between_processes.then(|| bus.listener(S::ANSWERED));
        Ok(Self {
            client: bus.client(source, elements)?,
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
    pub fn ask(
        &mut self,
        request: S::RequestHeader,
        elements: &[S::RequestElement],
    ) -> Result<(), ProcessError> {
        // Dropped first: its place is needed.
        self.open = None;
        self.open = Some(self.client.ask(request, elements)?);
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
    /// is there already. The server may have failed and may restart: ask again later.
    pub fn is_server_gone(&self) -> bool {
        self.open.as_ref().is_some_and(|open| !open.is_open())
    }

    /// Returns the answer, if it has arrived.
    ///
    /// # Errors
    /// [`ProcessError::Receive`] if the transport fails.
    pub fn poll(&mut self) -> Result<Option<Answer<S>>, ProcessError> {
        let Some(open) = &self.open else {
            return Ok(None);
        };
        let answer = open.poll()?;
        if answer.is_some() {
            self.open = None;
        }
        Ok(answer)
    }

    /// Sleeps until the answer has arrived; `None` if no request is pending, or the server ended
    /// without an answer. The wait has no time limit: an answer may take long on a busy machine, and the
    /// run ends a server that hangs.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn wait(&mut self) -> Result<Option<Answer<S>>, ProcessError> {
        let begun = Instant::now();
        let mut is_long = false;
        while self.open.is_some() {
            // Checked before the answer: a server that answers and then ends has answered.
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
                tracing::warn!("no answer of {} for {LONG_WAIT:?}: waits on", S::NAME);
            }
            if let Some(woken) = &self.woken {
                // The answer to another client wakes this one, too.
                woken.wait(POLL_INTERVAL, |_| {})?;
            }
        }
        Ok(None)
    }
}
