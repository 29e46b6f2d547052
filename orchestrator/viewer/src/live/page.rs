//! The page of the run for a browser, and the stream of its data: a line of JSON whenever the log has grown.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use report::page::LivePage;
use rustix::event::{PollFd, PollFlags};
use serde_json::json;
use tungstenite::handshake::server::{ErrorResponse, Request};

use super::admission::Admission;
use super::client::{END_TIMEOUT, End, ServerState, wait};
use super::handshake;

/// Minimum time between two states of the data.
const INTERVAL: Duration = Duration::from_millis(400);
/// Maximum share of the time that the server works on the data: one part in this many.
const SHARE: u32 = 5;

/// The data of the page, common to all browsers.
#[derive(Debug, Default)]
pub(super) struct PageData(Mutex<Latest>);

#[derive(Debug, Default)]
struct Latest {
    /// The log, and `true` if it is replayed.
    source: Option<(LivePage, bool)>,
    line: Arc<[u8]>,
    /// Number of the line; 0 before the first.
    number: u64,
    due: Option<Instant>,
    /// `true` if no other line follows.
    is_last: bool,
}

impl PageData {
    /// Shows this log, which is being written or `replayed`.
    pub(super) fn show(&self, log: &Path, replayed: bool) {
        let mut latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        latest.source = Some((LivePage::new(log), replayed));
    }

    /// Returns the latest line with its number, if that is not `than`. `now_ns`: simulated time (ns).
    fn newer(&self, than: u64, now_ns: u64, ended: bool) -> Option<(u64, Arc<[u8]>)> {
        let mut latest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let latest = &mut *latest;
        let began = Instant::now();
        let is_due = ended || latest.due.is_none_or(|due| began >= due);
        if than == latest.number && is_due && !latest.is_last {
            latest.is_last = ended;
            let data = latest
                .source
                .as_mut()
                .map(|(page, replayed)| page.data(replayed.then_some(now_ns), ended));
            let line = match data {
                Some(Ok(line)) => line,
                Some(Err(error)) => {
                    latest.is_last = true;
                    Some(json!({ "error": error.to_string() }).to_string())
                }
                None => None,
            };
            if let Some(line) = line {
                latest.line = (line + "\n").into_bytes().into();
                latest.number += 1;
            }
            latest.due = Some(Instant::now() + INTERVAL.max(began.elapsed() * SHARE));
        }
        (latest.number != than).then(|| (latest.number, Arc::clone(&latest.line)))
    }
}

/// Answers a request that asks for no `WebSocket`: with the page, which holds nothing of the run; with its data for the
/// token; or with a refusal.
pub(super) fn answer(
    server_state: &ServerState,
    tcp: &TcpStream,
    request: &Request,
    admission: &Admission,
) {
    // A viewer that does not read the answer leaves in any case.
    let _ = if request.uri().path() == "/" {
        let page = LivePage::html();
        send_all(
            server_state,
            tcp,
            &head("200 OK", "text/html; charset=utf-8"),
        )
        .and_then(|()| send_all(server_state, tcp, page.as_bytes()))
    } else if let Err(refused) = handshake::permit(&server_state.token, request) {
        refuse(server_state, tcp, &refused)
    } else if admission.admit() && server_state.broadcaster.count_viewer() {
        let sent = stream(server_state, tcp, admission);
        if matches!(sent, Ok(End::Stalled)) {
            server_state.broadcaster.count_cut_off();
        }
        sent.map(drop)
    } else {
        Ok(())
    };
}

fn head(status: &str, kind: &str) -> Vec<u8> {
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nConnection: close\r\n\r\n"
    )
    .into_bytes()
}

fn refuse(server_state: &ServerState, tcp: &TcpStream, refused: &ErrorResponse) -> io::Result<()> {
    let head = head(&refused.status().to_string(), "text/plain");
    send_all(server_state, tcp, &head)?;
    let words = refused.body().as_deref().unwrap_or_default();
    send_all(server_state, tcp, words.as_bytes())
}

/// Sends the data whenever they have grown, to the last of the run.
fn stream(server_state: &ServerState, tcp: &TcpStream, admission: &Admission) -> io::Result<End> {
    let (broadcaster, mut number) = (&server_state.broadcaster, 0);
    let mut bytes: Vec<u8> = head("200 OK", "application/x-ndjson");
    loop {
        match send_all(server_state, tcp, &bytes) {
            Err(e) if e.kind() == ErrorKind::TimedOut => return Ok(End::Stalled),
            sent => sent?,
        }
        bytes.clear();
        let ended = broadcaster.is_closed();
        match server_state
            .pages
            .newer(number, broadcaster.time_ns(), ended)
        {
            Some((newer, line)) => {
                number = newer;
                bytes.extend_from_slice(&line);
            }
            None if ended => return Ok(End::Done),
            None => {
                let woken = PollFd::new(&**admission.wake(), PollFlags::IN);
                wait(&mut [PollFd::new(tcp, PollFlags::IN), woken])?;
                // A browser sends nothing more until it leaves.
                let mut tcp = tcp;
                match tcp.read(&mut [0; 64]) {
                    Err(e) if e.kind() == ErrorKind::WouldBlock => {}
                    _ => return Ok(End::Done),
                }
            }
        }
    }
}

/// Sends bytes.
///
/// # Errors
/// [`ErrorKind::TimedOut`] if the viewer does not read.
fn send_all(server_state: &ServerState, mut tcp: &TcpStream, bytes: &[u8]) -> io::Result<()> {
    let (mut rest, mut since) = (bytes, Instant::now());
    while !rest.is_empty() {
        match tcp.write(rest) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(sent) => (rest, since) = (rest.get(sent..).unwrap_or_default(), Instant::now()),
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) if e.kind() == ErrorKind::WouldBlock => {
                let is_closed = server_state.broadcaster.is_closed();
                let limit = if is_closed {
                    END_TIMEOUT
                } else {
                    server_state.stall_timeout
                };
                if since.elapsed() >= limit {
                    return Err(ErrorKind::TimedOut.into());
                }
                wait(&mut [PollFd::new(tcp, PollFlags::OUT)])?;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
