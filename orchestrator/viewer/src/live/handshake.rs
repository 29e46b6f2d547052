//! Handshake of viewers: a token in the address authorises connections from this machine.
//!
//! Every web page and every user of this machine can open a `WebSocket` to a loopback port. The token in the
//! address keeps both out. The server checks the origin in addition, so that a web page is refused even if
//! the address is known.

use std::fs::File;
use std::io::{self, Read as _};

use data_encoding::HEXLOWER;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::header::{
    HeaderMap, HeaderName, HeaderValue, ORIGIN, SEC_WEBSOCKET_PROTOCOL,
};
use tungstenite::http::{StatusCode, Uri};

/// Names of the protocol: the current one, and that of Foxglove Studio up to version 1.
const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// Origins of web viewers that connect to servers on the user's machine.
const KNOWN_ORIGINS: [&str; 1] = ["https://app.foxglove.dev"];

/// Number of random bytes of a token.
const TOKEN_BYTES: usize = 16;

/// Secret part of the address.
#[derive(Debug, Clone)]
pub(super) struct Token(String);

impl Token {
    /// Creates a random token.
    pub(super) fn random() -> io::Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        File::open("/dev/urandom")?.read_exact(&mut bytes)?;
        Ok(Self(HEXLOWER.encode(&bytes)))
    }

    /// Returns the text in the address.
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    /// Returns `true` if the path contains the token.
    fn matches_path(&self, path: &str) -> bool {
        let path = path.strip_prefix('/').unwrap_or(path);
        let path = path.strip_suffix('/').unwrap_or(path);
        // Hashes compare in constant time, so that the duration reveals no information about the token.
        blake3::hash(path.as_bytes()) == blake3::hash(self.0.as_bytes())
    }
}

/// Reason for refusing a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refusal {
    Token,
    Origin,
    Protocol,
}

impl Refusal {
    fn response(self) -> ErrorResponse {
        let (status, words) = match self {
            Self::Token => (
                StatusCode::FORBIDDEN,
                "the address has no valid token: use the address that the run prints\n",
            ),
            Self::Origin => (StatusCode::FORBIDDEN, "this origin is not allowed\n"),
            Self::Protocol => (
                StatusCode::BAD_REQUEST,
                "this server requires the WebSocket subprotocol foxglove.sdk.v1\n",
            ),
        };
        let mut response = ErrorResponse::new(Some(words.to_owned()));
        *response.status_mut() = status;
        response
    }
}

/// Answers a handshake.
#[expect(clippy::result_large_err, reason = "signature of the library")]
pub(super) fn answer(
    token: &Token,
    request: &Request,
    mut response: Response,
) -> Result<Response, ErrorResponse> {
    let protocol =
        choose_protocol(token, request.uri(), request.headers()).map_err(Refusal::response)?;
    let chosen = HeaderValue::from_static(protocol);
    response
        .headers_mut()
        .insert(SEC_WEBSOCKET_PROTOCOL, chosen);
    Ok(response)
}

/// Checks the token and the origin of a request for the data of the page.
#[expect(clippy::result_large_err, reason = "the same type as for a handshake")]
pub(super) fn permit(token: &Token, request: &Request) -> Result<(), ErrorResponse> {
    check(token, request.uri(), request.headers()).map_err(Refusal::response)
}

fn check(token: &Token, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
    if !token.matches_path(uri.path()) {
        return Err(Refusal::Token);
    }
    if !texts(headers, &ORIGIN).all(|origin| origin.is_some_and(is_allowed_origin)) {
        return Err(Refusal::Origin);
    }
    Ok(())
}

/// Returns the protocol for a connection, or the reason for refusing it.
fn choose_protocol(token: &Token, uri: &Uri, headers: &HeaderMap) -> Result<&'static str, Refusal> {
    check(token, uri, headers)?;
    let offered = texts(headers, &SEC_WEBSOCKET_PROTOCOL)
        .flatten()
        .flat_map(|value| value.split(','))
        .map(str::trim);
    let offered: Vec<&str> = offered.collect();
    let ours = PROTOCOLS.into_iter().find(|p| offered.contains(p));
    ours.ok_or(Refusal::Protocol)
}

/// Returns the values of a header; `None` for a value that is not text.
fn texts<'a>(
    headers: &'a HeaderMap,
    name: &HeaderName,
) -> impl Iterator<Item = Option<&'a str>> + use<'a> {
    headers.get_all(name).into_iter().map(|v| v.to_str().ok())
}

/// Returns `true` if the origin is allowed: programs on this machine (`file://`, and `null` without an
/// origin), pages served by this machine, and known viewers.
fn is_allowed_origin(origin: &str) -> bool {
    if matches!(origin, "null" | "file://") || KNOWN_ORIGINS.contains(&origin) {
        return true;
    }
    let Ok(uri) = origin.parse::<Uri>() else {
        return false;
    };
    matches!(uri.scheme_str(), Some("http" | "https"))
        && matches!(uri.host(), Some("localhost" | "127.0.0.1" | "[::1]"))
        && uri.path() == "/"
        && !origin.contains('@')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(path: &str, origin: Option<&str>, protocol: &str) -> Result<&'static str, Refusal> {
        let mut headers = HeaderMap::new();
        if let Some(origin) = origin {
            headers.insert(ORIGIN, origin.parse().unwrap());
        }
        headers.insert(SEC_WEBSOCKET_PROTOCOL, protocol.parse().unwrap());
        let token = Token("secret".to_owned());
        choose_protocol(&token, &path.parse().unwrap(), &headers)
    }

    #[test]
    fn only_the_address_with_the_token_is_accepted() {
        let now = "foxglove.sdk.v1";
        assert_eq!(judged("/secret", None, now), Ok(now));
        assert_eq!(judged("/secret/?x=1", None, now), Ok(now));
        for path in [
            "/",
            "/Secret",
            "/secre",
            "/secrets",
            "/x/secret",
            "/?secret",
            "//secret",
        ] {
            assert_eq!(judged(path, None, now), Err(Refusal::Token), "{path}");
        }
    }

    #[test]
    fn web_pages_are_refused_and_viewers_accepted() {
        let now = "foxglove.sdk.v1";
        for origin in [
            "null",
            "file://",
            "http://localhost",
            "http://localhost:8080",
            "http://127.0.0.1:5173",
            "https://[::1]:1",
            "https://app.foxglove.dev",
        ] {
            assert_eq!(judged("/secret", Some(origin), now), Ok(now), "{origin}");
        }
        for origin in [
            "https://evil.example",
            "http://app.foxglove.dev",
            "https://app.foxglove.dev.evil.example",
            "https://app.foxglove.dev:444",
            "http://localhost.evil.example",
            "http://127.0.0.1.evil.example",
            "http://localhost@evil.example",
            "http://evil.example@localhost",
            "ftp://localhost",
            "chrome-extension://localhost",
            "localhost",
            "",
        ] {
            let judged = judged("/secret", Some(origin), now);
            assert_eq!(judged, Err(Refusal::Origin), "{origin}");
        }
    }

    #[test]
    fn both_names_of_the_protocol_are_accepted_and_the_current_one_preferred() {
        let spoken = |offered| judged("/secret", None, offered);
        assert_eq!(spoken("foxglove.websocket.v1"), Ok("foxglove.websocket.v1"));
        assert_eq!(
            spoken("foxglove.websocket.v1, foxglove.sdk.v1.1,foxglove.sdk.v1"),
            Ok("foxglove.sdk.v1")
        );
        assert_eq!(spoken("foxglove.sdk.v1.1"), Err(Refusal::Protocol));
        assert_eq!(spoken("mqtt"), Err(Refusal::Protocol));
    }

    #[test]
    fn tokens_are_long_and_different() {
        let [a, b] = [Token::random().unwrap(), Token::random().unwrap()];
        assert_eq!(a.text().len(), 2 * TOKEN_BYTES);
        assert_ne!(a.text(), b.text());
    }
}
