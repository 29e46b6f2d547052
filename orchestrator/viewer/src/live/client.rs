//! One viewer and the thread that serves it.

use std::io;
use std::net::TcpStream;
use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::sync::Arc;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use tungstenite::handshake::HandshakeError;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket, accept_hdr_with_config};

use super::broadcaster::{Broadcaster, Frame};
use super::handshake::{self, Token};
use super::wire;

/// Time for the handshake.
const HANDSHAKE_WITHIN: Duration = Duration::from_secs(5);
/// Time in which a viewer may take the rest when the run has ended.
const END_WITHIN: Duration = Duration::from_secs(2);
/// How often the thread looks up without being woken.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// Bytes that are handed to the connection at once.
const BATCH_BYTES: usize = 256 << 10;
/// Longest message that a viewer may send: subscriptions to thousands of topics.
const REQUEST_BYTES: usize = 1 << 20;

/// What all connections have in common.
#[derive(Debug, Clone)]
pub(super) struct ServerState {
    /// Where what is to be sent comes from.
    pub(super) broadcaster: Arc<Broadcaster>,
    /// What lets viewers in.
    pub(super) token: Token,
    /// What they call this server.
    pub(super) session: String,
    /// A viewer that takes nothing for so long is cut off.
    pub(super) patience: Duration,
}

/// Serves one connection to its end; the stream does not block.
pub(super) fn serve(server_state: &ServerState, stream: TcpStream, wake: OwnedFd) {
    let broadcaster = &*server_state.broadcaster;
    let Some(socket) = handshake(broadcaster, &server_state.token, stream) else {
        return;
    };
    let wake = Arc::new(wake);
    let Some(id) = broadcaster.join(&server_state.session, Arc::clone(&wake)) else {
        return;
    };
    let mut client = Client {
        broadcaster,
        patience: server_state.patience,
        id,
        socket,
        wake,
        unsent_since: None,
    };
    let stalled = matches!(client.run(), Ok(End::Stalled));
    broadcaster.leave(id, stalled);
}

/// Why a connection ended.
enum End {
    /// The viewer went, or the run ended.
    Done,
    /// The viewer took nothing any more.
    Stalled,
}

fn handshake(
    broadcaster: &Broadcaster,
    token: &Token,
    stream: TcpStream,
) -> Option<WebSocket<TcpStream>> {
    let deadline = Instant::now() + HANDSHAKE_WITHIN;
    #[expect(clippy::result_large_err, reason = "the library's own signature")]
    let judge = |request: &Request, response: Response| -> Result<Response, ErrorResponse> {
        handshake::answer(token, request, response)
    };
    let config = WebSocketConfig::default()
        .max_message_size(Some(REQUEST_BYTES))
        .max_frame_size(Some(REQUEST_BYTES));
    let mut result = accept_hdr_with_config(stream, judge, Some(config));
    loop {
        match result {
            Ok(socket) => return Some(socket),
            // Refused, with a reason that was sent; or not a viewer at all.
            Err(HandshakeError::Failure(_)) => return None,
            Err(HandshakeError::Interrupted(half)) => {
                if Instant::now() >= deadline || broadcaster.is_closed() {
                    return None;
                }
                // Answers are short enough for every buffer: what is missing is the question.
                let stream = half.get_ref().get_ref();
                wait(&mut [PollFd::new(stream, PollFlags::IN)]).ok()?;
                result = half.handshake();
            }
        }
    }
}

struct Client<'a> {
    broadcaster: &'a Broadcaster,
    patience: Duration,
    id: u64,
    socket: WebSocket<TcpStream>,
    wake: Arc<OwnedFd>,
    /// Since when the connection has not taken what it was given.
    unsent_since: Option<Instant>,
}

impl Client<'_> {
    fn run(&mut self) -> Result<End, Error> {
        let mut last_call: Option<Instant> = None;
        loop {
            let idle = self.send()?;
            if self.broadcaster.is_closed() {
                let since = *last_call.get_or_insert_with(Instant::now);
                if idle || since.elapsed() >= END_WITHIN {
                    return self.say_goodbye(since + END_WITHIN);
                }
            }
            if self
                .unsent_since
                .is_some_and(|since| since.elapsed() >= self.patience)
            {
                return Ok(End::Stalled);
            }
            self.wait()?;
            self.receive()?;
        }
    }

    /// Sends what waits; false if the connection takes no more now.
    fn send(&mut self) -> Result<bool, Error> {
        loop {
            if self.unsent_since.is_some() && !self.flush()? {
                return Ok(false);
            }
            let frames = self.broadcaster.take(self.id, BATCH_BYTES);
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
                // What the connection does not take now it keeps.
                unless_full(self.socket.write(message))?;
            }
            self.unsent_since = Some(Instant::now());
        }
    }

    /// Whether everything has gone out.
    fn flush(&mut self) -> Result<bool, Error> {
        let flushed = unless_full(self.socket.flush())?;
        if flushed {
            self.unsent_since = None;
        }
        Ok(flushed)
    }

    /// Takes up what the viewer asks for, and leaves aside whatever else it says.
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

    /// Until the viewer says or takes something, or something is to be sent.
    fn wait(&self) -> io::Result<()> {
        let mut events = PollFlags::IN;
        if self.unsent_since.is_some() {
            events |= PollFlags::OUT;
        }
        let wake: BorrowedFd<'_> = self.wake.as_fd();
        wait(&mut [
            PollFd::new(self.socket.get_ref(), events),
            PollFd::from_borrowed_fd(wake, PollFlags::IN),
        ])?;
        // Empty already if nobody woke us.
        let _ = rustix::io::read(&*self.wake, &mut [0; 8]);
        Ok(())
    }

    /// Closes the connection as the protocol wants it, but waits for no answer beyond the deadline.
    fn say_goodbye(&mut self, deadline: Instant) -> Result<End, Error> {
        unless_full(self.socket.close(None))?;
        while Instant::now() < deadline {
            self.flush()?;
            self.wait()?;
            // Ends with an error: the connection is closed.
            self.receive()?;
        }
        Ok(End::Done)
    }
}

/// False if the connection takes no more now.
fn unless_full(result: Result<(), Error>) -> Result<bool, Error> {
    match result {
        Ok(()) => Ok(true),
        Err(Error::Io(e)) if e.kind() == io::ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error),
    }
}

/// Until something happens, or [`POLL_INTERVAL`] is over.
fn wait(fds: &mut [PollFd<'_>]) -> io::Result<()> {
    let timeout = Timespec {
        tv_sec: 0,
        tv_nsec: POLL_INTERVAL.subsec_nanos().into(),
    };
    match poll(fds, Some(&timeout)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
