//! Who comes in: viewers on this machine that were told the address by whoever started the run.
//!
//! Every page of the web can open a `WebSocket` to a loopback port, and so can every user of this
//! machine. The token in the address keeps both out; the origin is looked at besides, so that a page
//! of the web stays outside even if the address got known.

use std::fs::File;
use std::io::{self, Read as _};

use data_encoding::HEXLOWER;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::header::{
    HeaderMap, HeaderName, HeaderValue, ORIGIN, SEC_WEBSOCKET_PROTOCOL,
};
use tungstenite::http::{StatusCode, Uri};

/// What viewers call the protocol: today's name, and the one of Foxglove Studio up to version 1.
const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// Viewers in the web that connect to servers on the user's own machine.
const KNOWN_ORIGINS: [&str; 1] = ["https://app.foxglove.dev"];

/// Random bytes of a token.
const TOKEN_BYTES: usize = 16;

/// The secret part of the address.
#[derive(Debug, Clone)]
pub(super) struct Token(String);

impl Token {
    /// A new one.
    pub(super) fn random() -> io::Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        File::open("/dev/urandom")?.read_exact(&mut bytes)?;
        Ok(Self(HEXLOWER.encode(&bytes)))
    }

    /// As it stands in the address.
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    /// Whether this path is the one with the token.
    fn opens(&self, path: &str) -> bool {
        let path = path.strip_prefix('/').unwrap_or(path);
        let path = path.strip_suffix('/').unwrap_or(path);
        // Hashes compare in constant time: how long it takes tells nothing of the token.
        blake3::hash(path.as_bytes()) == blake3::hash(self.0.as_bytes())
    }
}

/// Why somebody stays outside.
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
                "the address lacks the token: use the one that the run has printed\n",
            ),
            Self::Origin => (
                StatusCode::FORBIDDEN,
                "pages of this origin may not look on\n",
            ),
            Self::Protocol => (
                StatusCode::BAD_REQUEST,
                "this is a WebSocket server for viewers that speak foxglove.sdk.v1\n",
            ),
        };
        let mut response = ErrorResponse::new(Some(words.to_owned()));
        *response.status_mut() = status;
        response
    }
}

/// Answers a handshake.
#[expect(clippy::result_large_err, reason = "the library's own signature")]
pub(super) fn answer(
    token: &Token,
    request: &Request,
    mut response: Response,
) -> Result<Response, ErrorResponse> {
    let protocol = judge(token, request.uri(), request.headers()).map_err(Refusal::response)?;
    let chosen = HeaderValue::from_static(protocol);
    response
        .headers_mut()
        .insert(SEC_WEBSOCKET_PROTOCOL, chosen);
    Ok(response)
}

/// The protocol to speak with somebody, or why he stays outside.
fn judge(token: &Token, uri: &Uri, headers: &HeaderMap) -> Result<&'static str, Refusal> {
    if !token.opens(uri.path()) {
        return Err(Refusal::Token);
    }
    if !texts(headers, &ORIGIN).all(|origin| origin.is_some_and(may_look_on)) {
        return Err(Refusal::Origin);
    }
    let offered = texts(headers, &SEC_WEBSOCKET_PROTOCOL)
        .flatten()
        .flat_map(|value| value.split(','))
        .map(str::trim);
    let offered: Vec<&str> = offered.collect();
    let ours = PROTOCOLS.into_iter().find(|p| offered.contains(p));
    ours.ok_or(Refusal::Protocol)
}

/// The values of a header; `None` for one that is not text.
fn texts<'a>(
    headers: &'a HeaderMap,
    name: &HeaderName,
) -> impl Iterator<Item = Option<&'a str>> + use<'a> {
    headers.get_all(name).into_iter().map(|v| v.to_str().ok())
}

/// Whether a page of this origin may connect: programs on this machine (`file://`, and `null` for
/// what has no origin), pages that this machine serves itself, and viewers that are known.
fn may_look_on(origin: &str) -> bool {
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
        judge(&token, &path.parse().unwrap(), &headers)
    }

    #[test]
    fn only_the_address_with_the_token_opens() {
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
    fn pages_of_the_web_stay_outside_and_viewers_do_not() {
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
    fn both_names_of_the_protocol_are_understood_and_the_new_one_preferred() {
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
    fn tokens_are_long_and_never_the_same() {
        let [a, b] = [Token::random().unwrap(), Token::random().unwrap()];
        assert_eq!(a.text().len(), 2 * TOKEN_BYTES);
        assert_ne!(a.text(), b.text());
    }
}
