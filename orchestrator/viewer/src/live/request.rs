//! Requests of connections: for a `WebSocket`, or for a page.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use tungstenite::handshake::machine::TryParse as _;
use tungstenite::handshake::server::Request;

use super::admission::Admission;

/// Maximum time from the connection to its complete request.
pub(super) const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);
/// Maximum sleep of the thread without an event.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// Maximum size of the head of a request (bytes).
const MAX_HEAD_BYTES: usize = 16 << 10;
/// End of the head of a request.
const END: &[u8] = b"\r\n\r\n";

/// A non-blocking connection; bytes that were read before are read again first.
#[derive(Debug)]
pub(super) struct Connection {
    pub(super) tcp: TcpStream,
    head: Vec<u8>,
}

impl Connection {
    /// Reads the head of the request; `None` if it is not that of a GET, or does not arrive before the deadline or the
    /// end (`stops`).
    pub(super) fn open(
        mut tcp: TcpStream,
        admission: &Admission,
        stops: impl Fn() -> bool,
    ) -> Option<(Self, Request)> {
        let deadline = Instant::now() + HANDSHAKE_TIMEOUT;
        let (mut head, mut part) = (Vec::new(), [0; 2048]);
        while !head.windows(END.len()).any(|four| four == END) {
            match tcp.read(&mut part) {
                Ok(0) => return None,
                Ok(read) if head.len() + read <= MAX_HEAD_BYTES => {
                    head.extend(part.iter().take(read));
                }
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) if e.kind() == ErrorKind::WouldBlock && Instant::now() < deadline => {
                    if admission.is_dismissed() || stops() {
                        return None;
                    }
                    let woken = PollFd::new(&**admission.wake(), PollFlags::IN);
                    wait(&mut [PollFd::new(&tcp, PollFlags::IN), woken]).ok()?;
                }
                Ok(_) | Err(_) => return None,
            }
        }
        let (_, request) = Request::try_parse(&head).ok()??;
        Some((Self { tcp, head }, request))
    }
}

impl Read for Connection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.head.is_empty() {
            return self.tcp.read(buffer);
        }
        let read = self.head.as_slice().read(buffer)?;
        self.head.drain(..read);
        Ok(read)
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.tcp.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.tcp.flush()
    }
}

/// Waits for an event, at most for [`POLL_INTERVAL`].
pub(super) fn wait(fds: &mut [PollFd<'_>]) -> io::Result<()> {
    let timeout = Timespec {
        tv_sec: 0,
        tv_nsec: POLL_INTERVAL.subsec_nanos().into(),
    };
    match poll(fds, Some(&timeout)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
