//! The part of the Foxglove `WebSocket` protocol that a send-only server needs.

use data_encoding::BASE64;
use mcap_log::ChannelSpec;
use serde::Deserialize;
use serde_json::{Value as Json, json};

/// Opcodes of binary server messages.
const MESSAGE_DATA: u8 = 1;
const TIME: u8 = 2;

/// Returns the `serverInfo` message, the first to a viewer.
pub(super) fn server_info(session: &str) -> String {
    json!({
        "op": "serverInfo",
        "name": concat!("protean ", env!("CARGO_PKG_VERSION")),
        // Time only: no client publishing, parameters, services or playback control.
        "capabilities": ["time"],
        "supportedEncodings": [],
        "metadata": {},
        "sessionId": session,
    })
    .to_string()
}

/// Returns the announcement of a channel.
pub(super) fn channel(id: u32, spec: &ChannelSpec<'_>) -> Json {
    let schema = match spec.schema_encoding {
        // Binary schemas are encoded as Base64.
        "protobuf" | "flatbuffer" => BASE64.encode(spec.schema),
        _ => String::from_utf8_lossy(spec.schema).into_owned(),
    };
    json!({
        "id": id,
        "topic": spec.topic,
        "encoding": spec.message_encoding,
        "schemaName": spec.schema_name,
        "schemaEncoding": spec.schema_encoding,
        "schema": schema,
    })
}

/// Returns the `advertise` message of channels.
pub(super) fn advertise(channels: &[Json]) -> String {
    json!({ "op": "advertise", "channels": channels }).to_string()
}

/// Returns a message of a subscription; `time_ns` is simulated time (ns).
pub(super) fn message(subscription: u32, time_ns: u64, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(13 + data.len());
    bytes.push(MESSAGE_DATA);
    bytes.extend_from_slice(&subscription.to_le_bytes());
    bytes.extend_from_slice(&time_ns.to_le_bytes());
    bytes.extend_from_slice(data);
    bytes
}

/// Returns the `time` message (simulated ns).
pub(super) fn time(time_ns: u64) -> Vec<u8> {
    let mut bytes = vec![TIME];
    bytes.extend_from_slice(&time_ns.to_le_bytes());
    bytes
}

/// A request of a viewer.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(super) enum Request {
    /// Subscribe to channels.
    Subscribe {
        /// Channels and subscription ids.
        subscriptions: Vec<Subscription>,
    },
    /// End subscriptions.
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        /// Subscription ids.
        subscription_ids: Vec<u32>,
    },
}

/// A subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Subscription {
    /// Id chosen by the viewer.
    pub(super) id: u32,
    /// Id of the channel.
    pub(super) channel_id: u32,
}

/// Parses a text message of a viewer; returns `None` for unsupported requests.
pub(super) fn request(text: &str) -> Option<Request> {
    serde_json::from_str(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscriptions_are_parsed_and_other_requests_ignored() {
        let subscription = Subscription {
            id: 7,
            channel_id: 3,
        };
        assert_eq!(
            request(r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":3}]}"#),
            Some(Request::Subscribe {
                subscriptions: vec![subscription]
            })
        );
        assert_eq!(
            request(r#"{"op":"unsubscribe","subscriptionIds":[7,8]}"#),
            Some(Request::Unsubscribe {
                subscription_ids: vec![7, 8]
            })
        );
        for text in [
            "",
            "{}",
            "subscribe",
            r#"{"op":"advertise","channels":[]}"#,
            r#"{"op":"setParameters","parameters":[]}"#,
            r#"{"op":"subscribe","subscriptions":[{"id":-1,"channelId":3}]}"#,
        ] {
            assert_eq!(request(text), None, "{text}");
        }
    }

    #[test]
    fn messages_have_the_bytes_of_the_protocol() {
        assert_eq!(
            message(0x0102, 0x0304, b"xy"),
            [1, 2, 1, 0, 0, 4, 3, 0, 0, 0, 0, 0, 0, b'x', b'y']
        );
        assert_eq!(time(5), [2, 5, 0, 0, 0, 0, 0, 0, 0]);
    }
}
