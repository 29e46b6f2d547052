//! Requests of connections: for a `WebSocket`, for a page, or to obey an order.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use tungstenite::handshake::machine::TryParse as _;
use tungstenite::handshake::server::Request;
use tungstenite::http::header::CONTENT_LENGTH;

use super::admission::Admission;

/// Maximum time from the connection to its complete request.
pub(super) const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);
/// Maximum sleep of the thread without an event.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// Maximum size of a request (bytes).
const MAX_BYTES: usize = 16 << 10;
/// End of the head of a request.
const END: &[u8] = b"\r\n\r\n";

/// Complete request of a connection.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) request: Request,
    /// Body of a POST: an order.
    pub(super) order: Option<Vec<u8>>,
}

impl Asked {
    /// Parses a request; `None` before its end, an error if it is neither a GET nor a POST with the length of its body.
    fn parse(bytes: &[u8]) -> Result<Option<Self>, tungstenite::Error> {
        let Some(end) = bytes.windows(END.len()).position(|four| four == END) else {
            return Ok(None);
        };
        let post = bytes.strip_prefix(b"POST ");
        // The library parses requests for a `WebSocket`.
        let get = post.map(|rest| [b"GET ", rest].concat());
        let parsed = Request::try_parse(get.as_deref().unwrap_or(bytes))?;
        let Some((_, request)) = parsed else {
            return Ok(None);
        };
        let body = bytes.get(end + END.len()..).unwrap_or_default();
        let length = request.headers().get(CONTENT_LENGTH);
        let length = length.and_then(|text| text.to_str().ok()?.parse().ok());
        let order = match (post, length) {
            (None, _) => None,
            (Some(_), Some(length)) if body.len() < length => return Ok(None),
            (Some(_), length) => Some(body.iter().copied().take(length.unwrap_or(0)).collect()),
        };
        Ok(Some(Self { request, order }))
    }
}

/// A non-blocking connection; bytes that were read before are read again first.
#[derive(Debug)]
pub(super) struct Connection {
    pub(super) tcp: TcpStream,
    head: Vec<u8>,
}

impl Connection {
    /// Reads the request; `None` if it is neither a GET nor a POST, or does not arrive before the deadline or the end
    /// (`stops`).
    pub(super) fn open(
        mut tcp: TcpStream,
        admission: &Admission,
        stops: impl Fn() -> bool,
    ) -> Option<(Self, Asked)> {
        let deadline = Instant::now() + HANDSHAKE_TIMEOUT;
        let (mut head, mut part) = (Vec::new(), [0; 2048]);
        loop {
            if let Some(asked) = Asked::parse(&head).ok()? {
                return Some((Self { tcp, head }, asked));
            }
            match tcp.read(&mut part) {
                Ok(0) => return None,
                Ok(read) if head.len() + read <= MAX_BYTES => {
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
