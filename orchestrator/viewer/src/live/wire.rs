//! The Foxglove `WebSocket` protocol, as far as a server that only sends needs it.

use data_encoding::BASE64;
use mcap_log::ChannelSpec;
use serde::Deserialize;
use serde_json::{Value as Json, json};

/// Binary messages of the server begin with one of these.
const MESSAGE_DATA: u8 = 1;
const TIME: u8 = 2;

/// The first words to a viewer.
pub(super) fn server_info(session: &str) -> String {
    json!({
        "op": "serverInfo",
        "name": concat!("protean ", env!("CARGO_PKG_VERSION")),
        // The clock of the run, and no means to touch it: nothing to publish to, no parameters, no
        // services, no control of the playback.
        "capabilities": ["time"],
        "supportedEncodings": [],
        "metadata": {},
        "sessionId": session,
    })
    .to_string()
}

/// A channel as viewers are told of it.
pub(super) fn channel(id: u32, spec: &ChannelSpec<'_>) -> Json {
    let schema = match spec.schema_encoding {
        // Schemas that are no text travel as Base64.
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

/// The announcement of channels.
pub(super) fn advertise(channels: &[Json]) -> String {
    json!({ "op": "advertise", "channels": channels }).to_string()
}

/// A message of a subscription; `time_ns` is simulated.
pub(super) fn message(subscription: u32, time_ns: u64, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(13 + data.len());
    bytes.push(MESSAGE_DATA);
    bytes.extend_from_slice(&subscription.to_le_bytes());
    bytes.extend_from_slice(&time_ns.to_le_bytes());
    bytes.extend_from_slice(data);
    bytes
}

/// How late it is in the run (simulated ns).
pub(super) fn time(time_ns: u64) -> Vec<u8> {
    let mut bytes = vec![TIME];
    bytes.extend_from_slice(&time_ns.to_le_bytes());
    bytes
}

/// What a viewer can ask for.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(super) enum Request {
    /// Messages of these channels.
    Subscribe {
        /// Which, and what the viewer calls them.
        subscriptions: Vec<Subscription>,
    },
    /// No more messages of these subscriptions.
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        /// As the viewer calls them.
        subscription_ids: Vec<u32>,
    },
}

/// A subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Subscription {
    /// What the viewer calls it.
    pub(super) id: u32,
    /// The channel.
    pub(super) channel_id: u32,
}

/// What a viewer's text asks for; `None` for anything that this server does not do.
pub(super) fn request(text: &str) -> Option<Request> {
    serde_json::from_str(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscriptions_are_understood_and_everything_else_is_not() {
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
    fn the_bytes_are_those_of_the_protocol() {
        assert_eq!(
            message(0x0102, 0x0304, b"xy"),
            [1, 2, 1, 0, 0, 4, 3, 0, 0, 0, 0, 0, 0, b'x', b'y']
        );
        assert_eq!(time(5), [2, 5, 0, 0, 0, 0, 0, 0, 0]);
    }
}
