//! Topics that a program declares while it runs, by the text of their messages.

use std::collections::BTreeMap;
use std::sync::{PoisonError, RwLock};

use crate::bus::AnyTopic;
use crate::marks::DrawnFields;
use crate::message::{Descriptor, Field, FieldKind, Message as _};
use crate::schema;
use crate::stamp::PlainHeader;
use crate::topics::{Arity, Drawing, Qos, TopicFacts, TopicId};

/// Name of the sequence of elements in the schema of such a topic.
const ELEMENTS: &str = "elements";

/// Layouts that are registered, so that each is read once.
static KNOWN: RwLock<Vec<(TopicLayout, TopicId)>> = RwLock::new(Vec::new());

/// A topic in words.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TopicLayout {
    /// Name: words of lower-case letters, digits and `_`, separated by `/`.
    pub name: String,
    /// Fields of the element as in `ros2msg`, one a line (`float64 angle  # direction [rad]`); then the fields of each message
    /// in it, and of the header, after a line `MSG: package/Name`.
    pub message: String,
    /// Name of the element; by the name of the topic if empty.
    pub element: String,
    /// Name of the header; [`PlainHeader`] if empty.
    pub header: String,
    /// `true` if each message has exactly one element.
    pub is_one: bool,
    /// Fields in which infinity is valid.
    pub may_be_infinite: Vec<String>,
    /// Form of the elements in pictures: keys `x`, `y`, `angle` and `radius` with names of fields; none if empty.
    pub drawing: BTreeMap<String, String>,
}

/// Reason why a layout is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("topic {topic:?}: {fault}")]
pub struct LayoutError {
    /// Name of the topic.
    pub topic: String,
    /// The fault.
    pub fault: LayoutFault,
}

/// Fault of a part of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{part}expected {expected}")]
pub struct LayoutFault {
    /// Names of the part, each with `: ` behind it; empty for the whole layout.
    pub part: String,
    /// Description of an accepted part.
    pub expected: String,
}

impl LayoutFault {
    fn whole(expected: impl Into<String>) -> Self {
        Self {
            part: String::new(),
            expected: expected.into(),
        }
    }

    fn for_part(part: impl core::fmt::Display, expected: impl Into<String>) -> Self {
        Self::whole(expected).within(part)
    }

    fn within(mut self, part: impl core::fmt::Display) -> Self {
        self.part = format!("{part}: {}", self.part);
        self
    }
}

impl TopicLayout {
    /// Returns the layout of a known topic.
    pub fn for_topic(topic: TopicId) -> Self {
        let facts = topic.facts();
        let drawing = facts.drawing.map(|drawing| drawing.to_string());
        let entries = drawing.iter().flat_map(|text| text.split(' '));
        let entries = entries.filter_map(|entry| entry.split_once('='));
        Self {
            name: facts.name.to_owned(),
            message: schema::definitions(facts),
            element: facts.element.name.to_owned(),
            header: facts.header.name.to_owned(),
            is_one: facts.arity == Arity::One,
            may_be_infinite: facts
                .may_be_infinite
                .iter()
                .map(|&f| f.to_owned())
                .collect(),
            drawing: entries
                .map(|(key, field)| (key.to_owned(), field.to_owned()))
                .collect(),
        }
    }

    /// Returns it as metadata of the topic's channel in a log.
    pub fn entries(&self) -> Vec<(String, String)> {
        let drawing = self.drawing.iter();
        let drawing: Vec<String> = drawing
            .map(|(key, field)| format!("{key}={field}"))
            .collect();
        [
            ("message", self.message.clone()),
            (
                "messages_of",
                if self.is_one { "one" } else { "many" }.to_owned(),
            ),
            ("may_be_infinite", self.may_be_infinite.join(" ")),
            ("drawing", drawing.join(" ")),
        ]
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }

    /// Returns the layout of a topic from such metadata, with `element_type` and `header_type`; `None` if it says none.
    pub fn from_entries(name: &str, entries: &BTreeMap<String, String>) -> Option<Self> {
        let text = |key: &str| entries.get(key).cloned().unwrap_or_default();
        let drawing = text("drawing");
        let drawing = drawing.split(' ').filter_map(|entry| entry.split_once('='));
        Some(Self {
            name: name.to_owned(),
            message: entries.get("message")?.clone(),
            element: text("element_type"),
            header: text("header_type"),
            is_one: text("messages_of") == "one",
            may_be_infinite: text("may_be_infinite")
                .split_whitespace()
                .map(str::to_owned)
                .collect(),
            drawing: drawing
                .map(|(key, field)| (key.to_owned(), field.to_owned()))
                .collect(),
        })
    }

    /// Returns the topic with this layout, and registers it if it is new.
    ///
    /// # Errors
    /// [`LayoutError`] if the layout is invalid, or the topic is known with other messages.
    pub fn register(&self) -> Result<TopicId, LayoutError> {
        let known = |known: &[(Self, TopicId)]| {
            let found = known.iter().find(|(layout, _)| layout == self);
            found.map(|(_, topic)| *topic)
        };
        if let Some(topic) = known(&KNOWN.read().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(topic);
        }
        let failed = |fault: LayoutFault| LayoutError {
            topic: self.name.clone(),
            fault,
        };
        if TopicId::all().filter(|topic| !topic.is_built_in()).count() >= MAX_TOPICS {
            let expected = format!("at most {MAX_TOPICS} topics in a program");
            return Err(failed(LayoutFault::whole(expected)));
        }
        let facts = self.facts().map_err(failed)?;
        let topic = match TopicId::from_name(&self.name) {
            Some(known) if known.is_built_in() => {
                let expected = "a name that Protean's own topics do not have";
                return Err(failed(LayoutFault::whole(expected)));
            }
            Some(known) => known,
            None => {
                let facts = Box::leak(Box::new(facts));
                let topic = TopicId::intern(facts);
                AnyTopic::register_raw(facts, topic);
                topic
            }
        };
        if schema::hash_of(topic) != schema::fingerprint(&facts) {
            let expected = schema::definitions(topic.facts());
            return Err(failed(LayoutFault::whole(format!(
                "the messages that this program knows:\n{expected}"
            ))));
        }
        let mut all = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
        all.push((self.clone(), topic));
        Ok(topic)
    }

    fn facts(&self) -> Result<TopicFacts, LayoutFault> {
        let is_word = |word: &str| {
            let mut letters = word.bytes();
            word.starts_with(|c: char| c.is_ascii_lowercase())
                && letters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_')
        };
        let words: Vec<&str> = self.name.split('/').collect();
        if words.len() < 2 || self.name.len() > 64 || !words.iter().all(|word| is_word(word)) {
            return Err(LayoutFault::whole(
                "a name of lower-case words, as sonar/echo",
            ));
        }
        let mut blocks: Blocks<'_> = vec![(self.element_name(&words), Vec::new())];
        for line in self.message.lines() {
            let line = line.split_once('#').map_or(line, |(code, _)| code).trim();
            if let Some(name) = line.strip_prefix("MSG:") {
                blocks.push((name.trim().to_owned(), Vec::new()));
            } else if !line.is_empty()
                && !line.starts_with("====")
                && let Some((_, lines)) = blocks.last_mut()
            {
                lines.push(line);
            }
        }
        let element = match number(&self.element) {
            Some((name, size)) => Descriptor {
                name,
                size,
                align: size,
                fields: &[],
            },
            None => message(&blocks, &blocks[0].0, 0)?,
        };
        let header = if self.header.is_empty() || self.header == PlainHeader::DESCRIPTOR.name {
            PlainHeader::DESCRIPTOR
        } else {
            message(&blocks, &self.header, 0)?
        };
        let mut facts = TopicFacts {
            name: leak(&self.name),
            arity: if self.is_one { Arity::One } else { Arity::Many },
            elements: ELEMENTS,
            header,
            element,
            simulated: true,
            latched: false,
            timed: true,
            may_be_infinite: Vec::leak(self.may_be_infinite.iter().map(|f| leak(f)).collect()),
            drawing: None,
            qos: |size| Qos {
                history: 0,
                per_tick: size.robots,
                publishers: size.processes,
                subscribers: size.readers(),
            },
        };
        let fields = [&facts.header, &facts.element].map(|of| of.fields.iter());
        let names: Vec<&str> = fields.into_iter().flatten().map(|f| f.name).collect();
        let is_unknown = |field: &&String| !names.contains(&field.as_str());
        if let Some(field) = self.may_be_infinite.iter().find(is_unknown) {
            return Err(LayoutFault::for_part(
                format_args!("may_be_infinite: {field:?}"),
                "a field of the messages",
            ));
        }
        facts.drawing = self.drawn()?;
        if let Err(field) = DrawnFields::from_facts(Box::leak(Box::new(facts))) {
            return Err(LayoutFault::for_part(
                format_args!("drawing: field {field:?}"),
                "a floating-point number of the message",
            ));
        }
        Ok(facts)
    }

    fn element_name(&self, words: &[&str]) -> String {
        if !self.element.is_empty() {
            return self.element.clone();
        }
        let mut name = String::new();
        for word in words[1..].iter().flat_map(|word| word.split('_')) {
            let mut letters = word.chars();
            name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
            name.push_str(letters.as_str());
        }
        format!("{}/{name}", words[0])
    }

    fn drawn(&self) -> Result<Option<Drawing>, LayoutFault> {
        const KEYS: [&str; 4] = ["x", "y", "angle", "radius"];
        if let Some(key) = self
            .drawing
            .keys()
            .find(|key| !KEYS.contains(&key.as_str()))
        {
            return Err(LayoutFault::for_part(
                format_args!("drawing: key {key:?}"),
                "one of x, y, angle, radius",
            ));
        }
        let field = |key: &str| self.drawing.get(key).map(|field| leak(field));
        match (field("x"), field("y")) {
            (Some(x), Some(y)) => Ok(Some(Drawing {
                x,
                y,
                angle: field("angle"),
                radius: field("radius"),
            })),
            (None, None) if self.drawing.is_empty() => Ok(None),
            _ => Err(LayoutFault::for_part("drawing", "x and y")),
        }
    }
}

/// Messages by name, each with the lines of its fields.
type Blocks<'a> = Vec<(String, Vec<&'a str>)>;

fn leak(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// Returns the name and the size (bytes) of a type of numbers.
fn number(name: &str) -> Option<(&'static str, usize)> {
    const NUMBERS: [(&str, usize); 10] = [
        ("uint8", 1),
        ("uint16", 2),
        ("uint32", 4),
        ("uint64", 8),
        ("int8", 1),
        ("int16", 2),
        ("int32", 4),
        ("int64", 8),
        ("float32", 4),
        ("float64", 8),
    ];
    NUMBERS.into_iter().find(|(known, _)| *known == name)
}

/// Reads a message. Its bytes are those of ROS 2's CDR: no field needs padding.
fn message(blocks: &Blocks<'_>, name: &str, depth: usize) -> Result<Descriptor, LayoutFault> {
    // A message in itself has no end.
    let found = blocks.iter().find(|(known, _)| known == name && depth < 8);
    let Some((_, lines)) = found else {
        return Err(LayoutFault::for_part(
            format_args!("type {name:?}"),
            "one of float64, float32, a whole number as uint32, a message of the text",
        ));
    };
    let mut fields: Vec<Field> = Vec::new();
    let (mut size, mut align) = (0, 1);
    for line in lines {
        let mut words = line.split_whitespace();
        let (Some(kind), Some(field), None) = (words.next(), words.next(), words.next()) else {
            return Err(LayoutFault::for_part(
                format_args!("line {line:?}"),
                "a type and a name",
            ));
        };
        let is_name = field.starts_with(|c: char| c.is_ascii_lowercase())
            && field
                .bytes()
                .all(|c| c.is_ascii_alphanumeric() || c == b'_');
        if !is_name || fields.iter().any(|known| known.name == field) {
            return Err(LayoutFault::for_part(
                format_args!("field {field:?}"),
                "a name of its own that begins with a lower-case letter",
            ));
        }
        let named = |fault: LayoutFault| fault.within(format_args!("field {field:?}"));
        let of_type =
            |expected: &str| named(LayoutFault::for_part(format_args!("type {kind}"), expected));
        let (base, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
            Some((base, count)) => {
                let count = count.parse().ok().filter(|count| *count > 0);
                let count: usize = count.ok_or_else(|| of_type("a fixed number of elements"))?;
                (base, Some(count))
            }
            None => (kind, None),
        };
        let (kind, bytes, own_align) = match (number(base), count) {
            (Some((ros, bytes)), None) => (FieldKind::Number(ros), bytes, bytes),
            (Some((ros, bytes)), Some(count)) => (
                FieldKind::Array(ros, count),
                bytes.saturating_mul(count),
                bytes,
            ),
            (None, Some(_)) => return Err(of_type("numbers")),
            (None, None) => {
                let inner = message(blocks, base, depth + 1).map_err(named)?;
                let inner: &'static Descriptor = Box::leak(Box::new(inner));
                (FieldKind::Nested(inner), inner.size, inner.align)
            }
        };
        if size % own_align != 0 {
            let expected = format!(
                "a multiple of {own_align}; put larger numbers first, or add a field before it"
            );
            let part = format_args!("it begins at byte {size}");
            return Err(named(LayoutFault::for_part(part, expected)));
        }
        if fields.is_empty() {
            align = own_align;
        } else if own_align > align {
            let part = format_args!("its numbers have {own_align} bytes");
            let expected = "the largest numbers in the first field";
            return Err(named(LayoutFault::for_part(part, expected)));
        }
        fields.push(Field {
            name: leak(field),
            doc: "",
            offset: size,
            kind,
        });
        size = bytes.saturating_add(size);
    }
    if fields.is_empty() || size > MAX_MESSAGE_BYTES {
        return Err(LayoutFault::for_part(
            format_args!("message {name}"),
            format!("from 1 to {MAX_MESSAGE_BYTES} bytes"),
        ));
    }
    if size % align != 0 {
        return Err(LayoutFault::for_part(
            format_args!("message {name} has {size} bytes"),
            format!("a multiple of {align}; add a field at its end, as uint32 reserved"),
        ));
    }
    Ok(Descriptor {
        name: leak(name),
        size,
        align,
        fields: Vec::leak(fields),
    })
}

/// Maximum number of topics that are not built in.
const MAX_TOPICS: usize = 256;

/// Maximum size of an element (bytes).
const MAX_MESSAGE_BYTES: usize = 1 << 20;
