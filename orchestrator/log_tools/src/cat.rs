//! The messages of a log as lines of JSON.

use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::ops::ControlFlow;
use std::path::Path;

use mcap_log::reader::{Channel, Item, Reader, Schema as LogSchema};
use mcap_log::ros2::Schema;
use mcap_log::{Condition, LogReadError, ReadProgress, Topics, seconds};

use crate::message_json::{Undecodable, object, quoted, schema_of};
use crate::time_span::TimeSpan;

/// Selection of messages.
#[derive(Debug, Clone, Default)]
pub struct CatOptions {
    /// Start (s): simulated time in logs of Protean, time since the first message in others.
    pub start_s: Option<f64>,
    /// End (s), inclusive.
    pub end_s: Option<f64>,
    /// Topics.
    pub topics: Topics,
    /// Maximum number of messages; `None`: all.
    pub limit: Option<NonZeroU64>,
}

/// Form of the messages of a channel.
enum Form {
    /// ROS 2 messages with this schema.
    Ros2(Schema),
    /// JSON text.
    Json,
    /// An encoding that is not decoded, with the reason.
    Opaque(Undecodable),
}

impl Form {
    fn for_channel(channel: &Channel, schema: Option<&LogSchema>) -> Self {
        if channel.message_encoding == "json" {
            return Self::Json;
        }
        schema_of(channel, schema).map_or_else(Self::Opaque, Self::Ros2)
    }

    /// Returns the members of a line behind topic and time.
    fn members(&self, data: &[u8]) -> String {
        let decoded = match self {
            Self::Ros2(schema) => object(schema, data).map_err(|error| error.to_string()),
            Self::Json => verbatim(data).map_err(|error| format!("it is not JSON: {error}")),
            Self::Opaque(reason) => Err(reason.to_string()),
        };
        match decoded {
            Ok(message) => format!("\"message\":{message}"),
            Err(note) => format!("\"bytes\":{},\"note\":{}", data.len(), quoted(&note)),
        }
    }
}

/// Returns a JSON message on one line.
fn verbatim(data: &[u8]) -> Result<String, Box<dyn core::error::Error>> {
    let text = str::from_utf8(data)?;
    serde_json::from_str::<serde::de::IgnoredAny>(text)?;
    // Within strings, JSON allows no line breaks.
    Ok(text.replace(['\n', '\r'], " "))
}

/// Passes every selected message to `print` as one line of JSON, in the order of the log: `topic`, `log_time_s`, and
/// `message`, or `bytes` and `note` if the message cannot be decoded. Stops early at the limit or if `print` breaks.
/// Returns the condition of the log, or `None` if it stopped early.
///
/// # Errors
/// [`LogReadError`] if the log cannot be read or the options are wrong.
pub fn cat(
    log: &Path,
    options: &CatOptions,
    watch: &mut ReadProgress,
    mut print: impl FnMut(&str) -> ControlFlow<()>,
) -> Result<Option<Condition>, LogReadError> {
    let span = TimeSpan::new(log, options.start_s, options.end_s, watch)?;
    let mut reader = Reader::open(log, Some(watch))?;
    let mut channels: BTreeMap<u16, (String, Form)> = BTreeMap::new();
    let mut left = options.limit.map_or(u64::MAX, NonZeroU64::get);
    while let Some(item) = reader.next()? {
        match item {
            Item::Channel(channel) if options.topics.take(&channel.topic) => {
                let form = Form::for_channel(&channel, reader.schema(channel.schema_id).as_deref());
                channels.insert(channel.id, (quoted(&channel.topic), form));
            }
            Item::Message(header, data) if span.contains(header.log_time) => {
                let Some((topic, form)) = channels.get(&header.channel_id) else {
                    continue;
                };
                let line = format!(
                    "{{\"topic\":{topic},\"log_time_s\":{:?},{}}}",
                    seconds(header.log_time),
                    form.members(data)
                );
                left -= 1;
                if print(&line).is_break() || left == 0 {
                    return Ok(None);
                }
            }
            _ => {}
        }
    }
    options
        .topics
        .check(&reader.channels().map(|channel| channel.topic.as_str()))?;
    Ok(Some(reader.condition().clone()))
}
