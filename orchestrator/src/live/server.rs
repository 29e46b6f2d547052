//! The port and its threads.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::thread::JoinHandle;

use rustix::event::{EventfdFlags, PollFd, PollFlags, eventfd, poll};

use super::client;
use super::door::Token;
use super::error::LiveError;
use super::hub::{Hub, HubTap, LiveTotals};

/// Most connections at a time.
const CONNECTIONS: usize = 32;

/// Serves viewers on the loopback address until it is finished or dropped.
#[derive(Debug)]
pub struct LiveServer {
    hub: Arc<Hub>,
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
        let listen = |source| LiveError::Listen { port, source };
        let system = |what| move |source| LiveError::System { what, source };
        let token = Token::random().map_err(system("no random numbers"))?;
        let session = Token::random().map_err(system("no random numbers"))?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(listen)?;
        listener.set_nonblocking(true).map_err(listen)?;
        let address = listener.local_addr().map_err(listen)?;
        let end = Arc::new(wake_up().map_err(system("no event"))?);
        let hub = Arc::new(Hub::default());
        let door = Door {
            hub: Arc::clone(&hub),
            token: token.clone(),
            session: session.text().to_owned(),
            end: Arc::clone(&end),
        };
        let thread = std::thread::Builder::new()
            .name("live".into())
            .spawn(move || door.keep(&listener))
            .map_err(system("no thread"))?;
        Ok(Self {
            hub,
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
    pub fn tap(&self) -> HubTap {
        self.hub.tap()
    }

    /// Sends what still waits, says good-bye to everybody, and says what they got.
    pub fn finish(mut self) -> LiveTotals {
        self.stop();
        self.hub.totals()
    }

    fn stop(&mut self) {
        self.hub.close();
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
struct Door {
    hub: Arc<Hub>,
    token: Token,
    session: String,
    end: Arc<OwnedFd>,
}

impl Door {
    /// Lets people in until all is over and everybody has gone.
    fn keep(&self, listener: &TcpListener) {
        let mut threads: Vec<JoinHandle<()>> = Vec::new();
        while !self.hub.is_closed() {
            let mut fds = [
                PollFd::new(listener, PollFlags::IN),
                PollFd::new(&*self.end, PollFlags::IN),
            ];
            // Nothing but an interruption can happen to it.
            let _ = poll(&mut fds, None);
            threads.retain(|thread| !thread.is_finished());
            while let Some(thread) = self.admit(listener, threads.len()) {
                threads.push(thread);
            }
        }
        for thread in threads {
            let _ = thread.join();
        }
    }

    /// Starts a thread for the next connection, if there is one. One too many is closed at once.
    fn admit(&self, listener: &TcpListener, there: usize) -> Option<JoinHandle<()>> {
        loop {
            let (stream, _) = match listener.accept() {
                Ok(accepted) => accepted,
                Err(e) if e.kind() == io::ErrorKind::ConnectionAborted => continue,
                Err(e) => {
                    if e.kind() != io::ErrorKind::WouldBlock {
                        // No descriptors left, for instance: it will not be better at once.
                        std::thread::sleep(std::time::Duration::from_millis(50));
                    }
                    return None;
                }
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
            let (hub, token) = (Arc::clone(&self.hub), self.token.clone());
            let session = self.session.clone();
            let serve = move || client::serve(&hub, &token, &session, stream, wake);
            let thread = std::thread::Builder::new().name("viewer".into());
            if let Ok(thread) = thread.spawn(serve) {
                return Some(thread);
            }
        }
    }
}
