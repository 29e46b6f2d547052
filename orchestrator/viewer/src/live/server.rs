//! Live server: the port and its threads.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use platform::eprintln;
use platform::scratch::Scratch;
use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};
use tungstenite::http::header::UPGRADE;

use super::admission::Admission;
use super::broadcaster::{BroadcastHandle, Broadcaster, LiveTotals};
use super::browser;
use super::client::{self, ServerState};
use super::control::Control;
use super::error::LiveError;
use super::handshake::Token;
use super::page::PageData;
use super::request;

/// Maximum number of viewers.
const MAX_VIEWERS: usize = 32;
/// Maximum number of connections that have not presented the token; one more replaces the oldest of them.
const MAX_NEWCOMERS: usize = 32;
/// Default time without reading after which a viewer is disconnected.
const STALL_TIMEOUT: Duration = Duration::from_secs(10);
/// Interval between two checks for the end of a server that outlives its run.
const WAIT_FOR_END: Duration = Duration::from_millis(50);
/// Pause after the operating system failed to accept a connection, for example without free descriptors,
/// which become available only when a viewer disconnects.
const ACCEPT_RETRY: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};

/// Request for a live server.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LiveOptions {
    /// Port on 127.0.0.1; 0 selects a free port.
    pub port: u16,
    /// `true` to open the page in the browser of the user.
    pub open: bool,
    /// Pace (simulated s per s) at which pages begin to control what the server shows; `None`: they control nothing.
    pub control: Option<f64>,
}

/// Server for viewers on the loopback address, until finished or dropped.
#[derive(Debug)]
pub struct LiveServer {
    broadcaster: Arc<Broadcaster>,
    pages: Arc<PageData>,
    control: Option<Arc<Control>>,
    /// Directory of the file that leads the browser to the page.
    leads: Option<Scratch>,
    address: SocketAddr,
    token: Token,
    /// Set at the end of the server.
    done: Arc<AtomicBool>,
    /// Event descriptor, readable after the end.
    end: Arc<OwnedFd>,
    thread: Option<JoinHandle<()>>,
}

impl LiveServer {
    /// Listens on the port, prints the addresses to stderr and opens the page if requested.
    ///
    /// # Errors
    /// [`LiveError`] if the port is not available.
    pub fn start(options: LiveOptions) -> Result<Self, LiveError> {
        let mut server = Self::with_stall_timeout(options, STALL_TIMEOUT)?;
        // Shown also in quiet mode, since viewers need the address.
        eprintln!("{}", server.invitation());
        if options.open {
            let open = server.open();
            server.leads = Some(open.map_err(|source| {
                let what = "cannot open the page";
                LiveError::System { what, source }
            })?);
        }
        Ok(server)
    }

    /// Opens the page in the browser of the user, by a file that leads to it: all users can read the arguments of a
    /// program, but not the file.
    fn open(&self) -> io::Result<Scratch> {
        let scratch = Scratch::create()?;
        let file = scratch.path().join("live.html");
        let target = self.page();
        let lead = format!("<meta http-equiv=\"refresh\" content=\"0;url={target}\">\n");
        std::fs::write(&file, lead)?;
        let open = move || {
            if let Err(why) = platform::browser::open(&file) {
                eprintln!(
                    "note: cannot show the page with xdg-open: {why}; open the printed address"
                );
            }
        };
        std::thread::Builder::new()
            .name("open".into())
            .spawn(open)?;
        Ok(scratch)
    }

    /// Shows the page of this log, which is being written or `replayed`.
    pub fn show(&self, log: &Path, replayed: bool) {
        self.pages.show(log, replayed);
    }

    /// Listens with this time without reading after which a viewer is disconnected.
    ///
    /// # Errors
    /// As [`LiveServer::start`].
    fn with_stall_timeout(
        options: LiveOptions,
        stall_timeout: Duration,
    ) -> Result<Self, LiveError> {
        let LiveOptions { port, control, .. } = options;
        let listen = |source| LiveError::Listen { port, source };
        let system = |what| move |source| LiveError::System { what, source };
        let token = Token::random().map_err(system("cannot read random numbers"))?;
        let session = Token::random().map_err(system("cannot read random numbers"))?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(listen)?;
        listener.set_nonblocking(true).map_err(listen)?;
        let address = listener.local_addr().map_err(listen)?;
        let end = Arc::new(wake_up().map_err(system("cannot create an event descriptor"))?);
        let broadcaster = Arc::new(Broadcaster::default());
        let pages = Arc::new(PageData::default());
        let control = control.map(|pace| Arc::new(Control::new(pace)));
        let done = Arc::<AtomicBool>::default();
        let handshake = Acceptor {
            server_state: ServerState {
                broadcaster: Arc::clone(&broadcaster),
                token: token.clone(),
                session: session.text().to_owned(),
                stall_timeout,
                pages: Arc::clone(&pages),
                control: control.clone(),
                branches: Arc::default(),
                done: Arc::clone(&done),
            },
            end: Arc::clone(&end),
        };
        let thread = std::thread::Builder::new()
            .name("live".into())
            .spawn(move || handshake.run(&listener))
            .map_err(system("cannot start a thread"))?;
        Ok(Self {
            broadcaster,
            pages,
            control,
            leads: None,
            address,
            token,
            done,
            end,
            thread: Some(thread),
        })
    }

    /// Returns the address for viewers; it contains the token that authorises them.
    fn url(&self) -> String {
        format!("ws://{}/{}", self.address, self.token.text())
    }

    /// Returns the address of the page, with the token.
    fn page(&self) -> String {
        format!("http://{}/#{}", self.address, self.token.text())
    }

    /// Returns the lines that tell the user the addresses.
    fn invitation(&self) -> String {
        format!(
            "live: {}\n      in Foxglove or Lichtblick: Open connection, Foxglove WebSocket, this address\n\
             live: {}\n      in a browser",
            self.url(),
            self.page()
        )
    }

    /// Returns the handle that receives logged messages.
    pub fn tap(&self) -> BroadcastHandle {
        self.broadcaster.tap()
    }

    /// Returns what pages ask for, if they may.
    pub fn control(&self) -> Option<&Control> {
        self.control.as_deref()
    }

    /// Returns the totals so far.
    pub fn totals(&self) -> LiveTotals {
        self.broadcaster.totals()
    }

    /// Sends queued messages, closes all connections and returns the totals. With control, pages may make branches before,
    /// until `interrupted` is set.
    pub fn finish(mut self, interrupted: &AtomicBool) -> LiveTotals {
        self.broadcaster.close();
        if self.control.is_some() && !interrupted.load(Ordering::SeqCst) {
            eprintln!("live: the run has ended; its page stays, for branches, until Ctrl-C");
            while !interrupted.load(Ordering::SeqCst) {
                std::thread::park_timeout(WAIT_FOR_END);
            }
        }
        self.stop();
        self.broadcaster.totals()
    }

    fn stop(&mut self) {
        self.broadcaster.close();
        self.done.store(true, Ordering::SeqCst);
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

/// State of the thread that accepts connections.
struct Acceptor {
    server_state: ServerState,
    end: Arc<OwnedFd>,
}

/// A connection and its thread.
struct Connection {
    thread: JoinHandle<()>,
    admission: Arc<Admission>,
}

impl Acceptor {
    /// Accepts connections until the end, and until all viewers have disconnected.
    fn run(&self, listener: &TcpListener) {
        let mut connections: Vec<Connection> = Vec::new();
        let mut failed = false;
        while !self.server_state.is_done() {
            let mut fds = [
                PollFd::new(&*self.end, PollFlags::IN),
                PollFd::new(listener, PollFlags::IN),
            ];
            // A pending connection that cannot be accepted would wake the thread repeatedly.
            let (wanted, limit) = if failed {
                (1, Some(&ACCEPT_RETRY))
            } else {
                (2, None)
            };
            // The only possible error is an interruption.
            let _ = poll(&mut fds[..wanted], limit);
            failed = loop {
                match listener.accept() {
                    Ok((stream, _)) => {
                        connections.retain(|connection| !connection.thread.is_finished());
                        self.admit(stream, &mut connections);
                    }
                    Err(e) if e.kind() == io::ErrorKind::ConnectionAborted => {}
                    Err(e) => break e.kind() != io::ErrorKind::WouldBlock,
                }
            };
        }
        for connection in connections {
            let _ = connection.thread.join();
        }
    }

    /// Starts a thread for a connection, or closes it if there are too many viewers.
    fn admit(&self, stream: TcpStream, connections: &mut Vec<Connection>) {
        let viewers = connections
            .iter()
            .filter(|c| c.admission.is_viewer())
            .count();
        if viewers >= MAX_VIEWERS {
            return;
        }
        // A real viewer presents the token at once, long before so many others have connected after it.
        if connections.len() - viewers >= MAX_NEWCOMERS
            && let Some(oldest) = connections.iter().position(|c| c.admission.dismiss())
        {
            // It ends at once.
            let _ = connections.remove(oldest).thread.join();
        }
        if let Ok(connection) = self.connect(stream) {
            connections.push(connection);
        }
    }

    fn connect(&self, stream: TcpStream) -> io::Result<Connection> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        let admission = Arc::new(Admission::new(wake_up()?));
        let (server_state, own) = (self.server_state.clone(), Arc::clone(&admission));
        let serve = move || match request::Connection::open(stream, &own, || server_state.is_done())
        {
            Some((connection, asked)) if asked.request.headers().contains_key(UPGRADE) => {
                client::serve(&server_state, connection, &own);
            }
            Some((connection, asked)) => {
                browser::answer(&server_state, &connection.tcp, &asked, &own);
            }
            None => {}
        };
        let thread = std::thread::Builder::new()
            .name("viewer".into())
            .spawn(serve)?;
        Ok(Connection { thread, admission })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::time::Instant;

    use mcap_log::{ChannelSpec, LogObserver as _};
    use tungstenite::client::IntoClientRequest as _;
    use tungstenite::{Message, WebSocket};

    use super::*;

    /// Timeout of the tests.
    const LIMIT: Duration = Duration::from_secs(60);

    /// Returns a viewer that has subscribed to the first channel and does not read.
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

    /// Sends messages of 1 MB until the totals satisfy `enough`.
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

    fn server(stall_timeout: Duration) -> LiveServer {
        let options = LiveOptions::default();
        let server = LiveServer::with_stall_timeout(options, stall_timeout).unwrap();
        server.tap().channel(&ChannelSpec {
            topic: "/rosout",
            schema_name: "Thing",
            schema_encoding: "ros2msg",
            schema: b"uint8 x",
            message_encoding: "cdr",
            metadata: &BTreeMap::new(),
        });
        server
    }

    #[test]
    fn connections_without_the_token_keep_no_viewer_out() {
        let server = server(LIMIT);
        let address = server.address;
        let half_open: Vec<TcpStream> = (0..3 * MAX_NEWCOMERS)
            .map(|_| TcpStream::connect(address).unwrap())
            .collect();
        let mut viewers: Vec<_> = (0..4).map(|_| viewer(&server)).collect();
        for viewer in &mut viewers {
            let greeting = viewer.read().unwrap();
            assert!(
                greeting.to_text().unwrap().contains("serverInfo"),
                "{greeting}"
            );
        }
        drop((half_open, viewers));
        server.finish(&AtomicBool::default());
    }

    #[test]
    fn a_viewer_that_does_not_read_is_disconnected_after_the_timeout() {
        // Timeout of zero: as soon as the connection is full.
        let server = server(Duration::ZERO);
        let mut silent = viewer(&server);
        let totals = send_until(&server, |totals| totals.cut_off > 0);
        assert_eq!((totals.viewers, totals.cut_off), (1, 1));
        // Messages in transit can be read; then the connection ends while the server continues.
        let end = loop {
            match silent.read() {
                Ok(Message::Close(_)) => panic!("disconnected, not closed"),
                Ok(_) => {}
                Err(end) => break end,
            }
        };
        let timed_out = matches!(&end, tungstenite::Error::Io(e)
            if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut));
        assert!(!timed_out, "{end}");
        assert_eq!(server.finish(&AtomicBool::default()).cut_off, 1);
    }

    #[test]
    fn a_viewer_that_does_not_read_loses_messages_before_the_timeout() {
        let server = server(Duration::from_secs(3600));
        let silent = viewer(&server);
        let totals = send_until(&server, |totals| totals.left_out > 0);
        assert_eq!((totals.viewers, totals.cut_off), (1, 0));
        drop(silent);
        assert_eq!(server.finish(&AtomicBool::default()).cut_off, 0);
    }
}
