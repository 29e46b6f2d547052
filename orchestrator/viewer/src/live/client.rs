//! Connection of one viewer, on its own thread.

use std::io;
use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags};
use tungstenite::handshake::HandshakeError;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket, accept_hdr_with_config};

use super::admission::Admission;
use super::broadcaster::{Broadcaster, Frame};
use super::control::Control;
use super::handshake::{self, Token};
use super::page::PageData;
use super::request::{Connection, HANDSHAKE_TIMEOUT, wait};
use super::wire;

/// Timeout for sending queued messages after the end of the run.
pub(super) const END_TIMEOUT: Duration = Duration::from_secs(2);
/// Maximum size of a batch written to the connection (bytes).
const MAX_BATCH_BYTES: usize = 256 << 10;
/// Maximum size of a message of a viewer (bytes): subscriptions to thousands of topics.
const MAX_REQUEST_BYTES: usize = 1 << 20;

/// State shared by all connections.
#[derive(Debug, Clone)]
pub(super) struct ServerState {
    /// Source of the frames.
    pub(super) broadcaster: Arc<Broadcaster>,
    /// Token that authorises viewers.
    pub(super) token: Token,
    /// Session id of the server.
    pub(super) session: String,
    /// Time without reading after which a viewer is disconnected.
    pub(super) stall_timeout: Duration,
    /// Data of the page.
    pub(super) pages: Arc<PageData>,
    /// Control by pages; `None`: they control nothing.
    pub(super) control: Option<Arc<Control>>,
    /// Locked while a branch is made.
    pub(super) branches: Arc<Mutex<()>>,
    /// Set at the end of the server, which pages may use after the end of the run.
    pub(super) done: Arc<AtomicBool>,
}

impl ServerState {
    /// Returns `true` if the server ends.
    pub(super) fn is_done(&self) -> bool {
        self.done.load(Ordering::SeqCst)
    }
}

/// Serves one connection until it ends.
pub(super) fn serve(server_state: &ServerState, connection: Connection, admission: &Admission) {
    let broadcaster = &*server_state.broadcaster;
    let Some(socket) = handshake(broadcaster, &server_state.token, connection, admission) else {
        return;
    };
    if !admission.admit() {
        return;
    }
    let wake = Arc::clone(admission.wake());
    let Some(id) = broadcaster.join(&server_state.session, Arc::clone(&wake)) else {
        return;
    };
    let mut client = Client {
        broadcaster,
        stall_timeout: server_state.stall_timeout,
        id,
        socket,
        wake,
        unsent_since: None,
    };
    let stalled = matches!(client.run(), Ok(End::Stalled));
    broadcaster.leave(id, stalled);
}

/// Reason for the end of a connection.
pub(super) enum End {
    /// The viewer disconnected, or the run ended.
    Done,
    /// The viewer stopped reading.
    Stalled,
}

fn handshake(
    broadcaster: &Broadcaster,
    token: &Token,
    connection: Connection,
    admission: &Admission,
) -> Option<WebSocket<Connection>> {
    let deadline = Instant::now() + HANDSHAKE_TIMEOUT;
    #[expect(clippy::result_large_err, reason = "signature of the library")]
    let judge = |request: &Request, response: Response| -> Result<Response, ErrorResponse> {
        handshake::answer(token, request, response)
    };
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_REQUEST_BYTES))
        .max_frame_size(Some(MAX_REQUEST_BYTES));
    let mut result = accept_hdr_with_config(connection, judge, Some(config));
    loop {
        match result {
            Ok(socket) => return Some(socket),
            // Refused, with a reason in the response; or not a WebSocket client.
            Err(HandshakeError::Failure(_)) => return None,
            Err(HandshakeError::Interrupted(half)) => {
                if Instant::now() >= deadline || admission.is_dismissed() || broadcaster.is_closed()
                {
                    return None;
                }
                // Responses fit every buffer: the request is incomplete.
                let stream = &half.get_ref().get_ref().tcp;
                let woken = PollFd::new(&**admission.wake(), PollFlags::IN);
                wait(&mut [PollFd::new(stream, PollFlags::IN), woken]).ok()?;
                result = half.handshake();
            }
        }
    }
}

struct Client<'a> {
    broadcaster: &'a Broadcaster,
    stall_timeout: Duration,
    id: u64,
    socket: WebSocket<Connection>,
    wake: Arc<OwnedFd>,
    /// Time since which written data are unsent.
    unsent_since: Option<Instant>,
}

impl Client<'_> {
    fn run(&mut self) -> Result<End, Error> {
        let mut last_call: Option<Instant> = None;
        loop {
            let idle = self.send()?;
            if self.broadcaster.is_closed() {
                let since = *last_call.get_or_insert_with(Instant::now);
                if idle || since.elapsed() >= END_TIMEOUT {
                    return self.close(since + END_TIMEOUT);
                }
            }
            if self
                .unsent_since
                .is_some_and(|since| since.elapsed() >= self.stall_timeout)
            {
                return Ok(End::Stalled);
            }
            self.wait()?;
            self.receive()?;
        }
    }

    /// Sends queued frames; returns `false` if the connection accepts no more data now.
    fn send(&mut self) -> Result<bool, Error> {
        loop {
            if self.unsent_since.is_some() && !self.flush()? {
                return Ok(false);
            }
            let frames = self.broadcaster.take(self.id, MAX_BATCH_BYTES);
            if frames.is_empty() {
                return Ok(true);
            }
            for frame in frames {
                let message = match frame {
                    Frame::Text(text) => Message::text(text),
                    Frame::Time(time_ns) => Message::binary(wire::time(time_ns)),
                    Frame::Message {
                        subscription,
                        time_ns,
                        data,
                        ..
                    } => Message::binary(wire::message(subscription, time_ns, &data)),
                };
                // The socket buffers data that the connection does not accept now.
                unless_full(self.socket.write(message))?;
            }
            self.unsent_since = Some(Instant::now());
        }
    }

    /// Flushes the connection; returns `true` if all data have been sent.
    fn flush(&mut self) -> Result<bool, Error> {
        let flushed = unless_full(self.socket.flush())?;
        if flushed {
            self.unsent_since = None;
        }
        Ok(flushed)
    }

    /// Handles requests of the viewer; ignores other messages.
    fn receive(&mut self) -> Result<(), Error> {
        loop {
            let message = match self.socket.read() {
                Err(Error::Io(e)) if e.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                other => other?,
            };
            let Message::Text(text) = message else {
                continue;
            };
            match wire::request(&text) {
                Some(wire::Request::Subscribe { subscriptions }) => {
                    self.broadcaster.subscribe(self.id, &subscriptions);
                }
                Some(wire::Request::Unsubscribe { subscription_ids }) => {
                    self.broadcaster.unsubscribe(self.id, &subscription_ids);
                }
                None => {}
            }
        }
    }

    /// Waits until the viewer sends or reads data, or a frame is queued.
    fn wait(&self) -> io::Result<()> {
        let mut events = PollFlags::IN;
        if self.unsent_since.is_some() {
            events |= PollFlags::OUT;
        }
        let wake: BorrowedFd<'_> = self.wake.as_fd();
        wait(&mut [
            PollFd::new(&self.socket.get_ref().tcp, events),
            PollFd::from_borrowed_fd(wake, PollFlags::IN),
        ])?;
        // The counter is empty if the wake-up had another cause.
        let _ = rustix::io::read(&*self.wake, &mut [0; 8]);
        Ok(())
    }

    /// Closes the connection according to the protocol; waits for the answer until the deadline.
    fn close(&mut self, deadline: Instant) -> Result<End, Error> {
        unless_full(self.socket.close(None))?;
        while Instant::now() < deadline {
            self.flush()?;
            self.wait()?;
            // Returns an error when the connection is closed.
            self.receive()?;
        }
        Ok(End::Done)
    }
}

/// Returns `false` if the connection accepts no more data now.
fn unless_full(result: Result<(), Error>) -> Result<bool, Error> {
    match result {
        Ok(()) => Ok(true),
        Err(Error::Io(e)) if e.kind() == io::ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error),
    }
}
