//! The port and its threads.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};

use super::broadcaster::{BroadcastHandle, Broadcaster, LiveTotals};
use super::client::{self, ServerState};
use super::error::LiveError;
use super::handshake::Token;

/// Most connections at a time.
const CONNECTIONS: usize = 32;
/// A viewer that takes nothing for so long is cut off, unless something else is output.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long nobody is let in when the system could not accept a connection: it has no descriptors
/// left, for instance, and will have at once only if somebody goes.
const CLOSED_FOR: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};

/// Serves viewers on the loopback address until it is finished or dropped.
#[derive(Debug)]
pub struct LiveServer {
    broadcaster: Arc<Broadcaster>,
    address: SocketAddr,
    token: Token,
    /// Readable when all is over.
    end: Arc<OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl LiveServer {
    /// Listens on this port of 127.0.0.1; 0 is any that is free.
    ///
    /// # Errors
    /// [`LiveError`] if the port cannot be had.
    pub fn start(port: u16) -> Result<Self, LiveError> {
        Self::with_patience(port, PATIENCE)
    }

    /// The same, cutting off viewers that take nothing for so long.
    ///
    /// # Errors
    /// As [`LiveServer::start`].
    pub fn with_patience(port: u16, patience: Duration) -> Result<Self, LiveError> {
        let listen = |source| LiveError::Listen { port, source };
        let system = |what| move |source| LiveError::System { what, source };
        let token = Token::random().map_err(system("no random numbers"))?;
        let session = Token::random().map_err(system("no random numbers"))?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(listen)?;
        listener.set_nonblocking(true).map_err(listen)?;
        let address = listener.local_addr().map_err(listen)?;
        let end = Arc::new(wake_up().map_err(system("no event"))?);
        let broadcaster = Arc::new(Broadcaster::default());
        let handshake = Acceptor {
            server_state: ServerState {
                broadcaster: Arc::clone(&broadcaster),
                token: token.clone(),
                session: session.text().to_owned(),
                patience,
            },
            end: Arc::clone(&end),
        };
        let thread = std::thread::Builder::new()
            .name("live".into())
            .spawn(move || handshake.keep(&listener))
            .map_err(system("no thread"))?;
        Ok(Self {
            broadcaster,
            address,
            token,
            end,
            thread: Some(thread),
        })
    }

    /// What a viewer is to connect to. Whoever knows it may look on.
    pub fn url(&self) -> String {
        format!("ws://{}/{}", self.address, self.token.text())
    }

    /// The end that takes what goes into the log.
    pub fn tap(&self) -> BroadcastHandle {
        self.broadcaster.tap()
    }

    /// What viewers got so far.
    pub fn totals(&self) -> LiveTotals {
        self.broadcaster.totals()
    }

    /// Sends what still waits, says good-bye to everybody, and says what they got.
    pub fn finish(mut self) -> LiveTotals {
        self.stop();
        self.broadcaster.totals()
    }

    fn stop(&mut self) {
        self.broadcaster.close();
        let _ = rustix::io::write(&*self.end, &1_u64.to_ne_bytes());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for LiveServer {
    fn drop(&mut self) {
        self.stop();
    }
}

fn wake_up() -> io::Result<OwnedFd> {
    Ok(eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?)
}

/// What the thread that accepts connections has.
struct Acceptor {
    server_state: ServerState,
    end: Arc<OwnedFd>,
}

/// Who was at the handshake.
enum ConnectionAttempt {
    Viewer(JoinHandle<()>),
    Nobody,
    /// Somebody whom the system does not let in now.
    Stuck,
}

impl Acceptor {
    /// Lets people in until all is over and everybody has gone.
    fn keep(&self, listener: &TcpListener) {
        let mut threads: Vec<JoinHandle<()>> = Vec::new();
        let mut stuck = false;
        while !self.server_state.broadcaster.is_closed() {
            let mut fds = [
                PollFd::new(&*self.end, PollFlags::IN),
                PollFd::new(listener, PollFlags::IN),
            ];
            // Who waits at a handshake that is stuck would wake it again and again.
            let (wanted, limit) = if stuck {
                (1, Some(&CLOSED_FOR))
            } else {
                (2, None)
            };
            // Nothing but an interruption can happen to it.
            let _ = poll(&mut fds[..wanted], limit);
            threads.retain(|thread| !thread.is_finished());
            stuck = loop {
                match self.admit(listener, threads.len()) {
                    ConnectionAttempt::Viewer(thread) => threads.push(thread),
                    ConnectionAttempt::Nobody => break false,
                    ConnectionAttempt::Stuck => break true,
                }
            };
        }
        for thread in threads {
            let _ = thread.join();
        }
    }

    /// Starts a thread for the next connection, if there is one. One too many is closed at once.
    fn admit(&self, listener: &TcpListener, there: usize) -> ConnectionAttempt {
        loop {
            let (stream, _) = match listener.accept() {
                Ok(accepted) => accepted,
                Err(e) if e.kind() == io::ErrorKind::ConnectionAborted => continue,
                Err(e) if e.kind() == io::ErrorKind::WouldBlock => {
                    return ConnectionAttempt::Nobody;
                }
                Err(_) => return ConnectionAttempt::Stuck,
            };
            if there >= CONNECTIONS
                || stream.set_nonblocking(true).is_err()
                || stream.set_nodelay(true).is_err()
            {
                continue;
            }
            let Ok(wake) = wake_up() else {
                continue;
            };
            let server_state = self.server_state.clone();
            let serve = move || client::serve(&server_state, stream, wake);
            let thread = std::thread::Builder::new().name("viewer".into());
            if let Ok(thread) = thread.spawn(serve) {
                return ConnectionAttempt::Viewer(thread);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::net::TcpStream;
    use std::time::Instant;

    use mcap_log::{ChannelSpec, LogObserver as _};
    use tungstenite::client::IntoClientRequest as _;
    use tungstenite::{Message, WebSocket};

    use super::*;

    /// Longest that anything here may take.
    const LIMIT: Duration = Duration::from_secs(60);

    /// A viewer that subscribes to the first channel, and is not read from.
    fn viewer(server: &LiveServer) -> WebSocket<TcpStream> {
        let mut request = server.url().into_client_request().unwrap();
        let protocol = "foxglove.sdk.v1".parse().unwrap();
        request
            .headers_mut()
            .insert("sec-websocket-protocol", protocol);
        let stream = TcpStream::connect(server.address).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        let (mut socket, _) = tungstenite::client(request, stream).unwrap();
        let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]}"#;
        socket.send(Message::text(subscribe)).unwrap();
        socket
    }

    /// Sends a megabyte again and again until the totals say so.
    fn send_until(server: &LiveServer, enough: impl Fn(LiveTotals) -> bool) -> LiveTotals {
        let mut tap = server.tap();
        let large = vec![0; 1 << 20];
        let deadline = Instant::now() + LIMIT;
        let mut time_ns = 0;
        loop {
            let totals = server.totals();
            if enough(totals) {
                return totals;
            }
            assert!(Instant::now() < deadline, "{totals:?}");
            time_ns += 1;
            tap.message(0, time_ns, &large);
            std::thread::yield_now();
        }
    }

    fn server(patience: Duration) -> LiveServer {
        let server = LiveServer::with_patience(0, patience).unwrap();
        server.tap().channel(&ChannelSpec {
            topic: "/viewer/log",
            schema_name: "Thing",
            schema_encoding: "ros2msg",
            schema: b"uint8 x",
            message_encoding: "cdr",
            metadata: &BTreeMap::new(),
        });
        server
    }

    #[test]
    fn who_takes_nothing_is_cut_off_when_the_patience_is_over() {
        // No patience at all: as soon as the connection is full.
        let server = server(Duration::ZERO);
        let mut silent = viewer(&server);
        let totals = send_until(&server, |totals| totals.cut_off > 0);
        assert_eq!((totals.viewers, totals.cut_off), (1, 1));
        // What was on its way may be read, and then nothing any more, while the server goes on.
        let end = loop {
            match silent.read() {
                Ok(Message::Close(_)) => panic!("cut off, not told good-bye"),
                Ok(_) => {}
                Err(end) => break end,
            }
        };
        let timed_out = matches!(&end, tungstenite::Error::Io(e)
            if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut));
        assert!(!timed_out, "{end}");
        assert_eq!(server.finish().cut_off, 1);
    }

    #[test]
    fn who_takes_nothing_misses_messages_as_long_as_there_is_patience() {
        let server = server(Duration::from_secs(3600));
        let silent = viewer(&server);
        let totals = send_until(&server, |totals| totals.left_out > 0);
        assert_eq!((totals.viewers, totals.cut_off), (1, 0));
        drop(silent);
        assert_eq!(server.finish().cut_off, 0);
    }
}
