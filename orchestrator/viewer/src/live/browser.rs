//! Connections of browsers: the page of the run, and the stream of its data.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Instant;

use report::page::LivePage;
use rustix::event::{PollFd, PollFlags};
use tungstenite::handshake::server::{ErrorResponse, Request};

use super::admission::Admission;
use super::client::{END_TIMEOUT, End, ServerState};
use super::handshake;
use super::request::wait;

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
