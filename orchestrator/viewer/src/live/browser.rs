//! Connections of browsers: the page of the run, the stream of its data, and orders.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Instant;

use report::page::LivePage;
use rustix::event::{PollFd, PollFlags};
use serde::Deserialize;
use tungstenite::handshake::server::ErrorResponse;

use super::admission::Admission;
use super::client::{END_TIMEOUT, End, ServerState};
use super::control::Order;
use super::handshake;
use super::request::{Asked, wait};
use super::what_if::{WhatIf, WhatIfError};

/// Answers a request that asks for no `WebSocket`: with the page, which holds nothing of the run; with its data for the
/// token; or with a refusal.
pub(super) fn answer(
    server_state: &ServerState,
    tcp: &TcpStream,
    asked: &Asked,
    admission: &Admission,
) {
    let (request, order) = (&asked.request, asked.order.as_deref());
    // A viewer that does not read the answer leaves in any case.
    let _ = if order.is_none() && request.uri().path() == "/" {
        let page = LivePage::html();
        send_all(
            server_state,
            tcp,
            &head("200 OK", "text/html; charset=utf-8"),
        )
        .and_then(|()| send_all(server_state, tcp, page.as_bytes()))
    } else if let Err(refused) = handshake::permit(&server_state.token, request) {
        refuse(server_state, tcp, &refused)
    } else if let Some(order) = order {
        // Admitted first, as a viewer: the answer may take its time.
        if !admission.admit() {
            return;
        }
        let (status, words) = obey(server_state, order);
        send_all(server_state, tcp, &head(status, "application/json"))
            .and_then(|()| send_all(server_state, tcp, words.as_bytes()))
    } else if admission.admit() {
        server_state.broadcaster.count_viewer();
        let _open = server_state.control.as_ref().map(|control| control.enter());
        let sent = stream(server_state, tcp, admission);
        if matches!(sent, Ok(End::Stalled)) {
            server_state.broadcaster.count_cut_off();
        }
        sent.map(drop)
    } else {
        Ok(())
    };
}

/// Body of a request that is an order.
#[derive(Deserialize)]
#[serde(untagged)]
enum Body {
    Branch { branch: WhatIf },
    Order(Order),
}

/// Obeys the order of a page; returns the status and the words of the answer.
fn obey(server_state: &ServerState, order: &[u8]) -> (&'static str, String) {
    let Some(control) = &server_state.control else {
        let words = "this server takes no orders: start it with --control\n";
        return ("403 Forbidden", words.to_owned());
    };
    let obeyed = match serde_json::from_slice(order) {
        Ok(Body::Order(order)) => match control.obey(order) {
            Ok(wish) => Ok(serde_json::json!(wish).to_string()),
            Err(error) => Err(error.to_string()),
        },
        Ok(Body::Branch { branch }) => {
            make(server_state, &branch).map_err(|error| error.to_string())
        }
        Err(_) => Err(
            "order: expected \"pause\", \"step\", \"go\", {\"pace\": FACTOR} or \
             {\"branch\": {\"at_s\": T, \"place\": [\"ROBOT=X,Y\"], \"set\": [\"KEY=VALUE\"]}}"
                .to_owned(),
        ),
    };
    match obeyed {
        Ok(answer) => ("200 OK", answer),
        Err(words) => ("422 Unprocessable Content", words),
    }
}

/// Makes a branch, unless another one is being made.
fn make(server_state: &ServerState, branch: &WhatIf) -> Result<String, WhatIfError> {
    let ended = server_state.broadcaster.is_closed();
    let log = server_state.pages.whole_log(ended);
    let log = log.ok_or(WhatIfError::Running)?;
    let Ok(_one) = server_state.branches.try_lock() else {
        return Err(WhatIfError::Busy);
    };
    branch.make(&log, || server_state.is_done())
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
        match server_state.pages.newer(
            number,
            broadcaster.times_ns(),
            ended,
            server_state.control.as_deref(),
        ) {
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
