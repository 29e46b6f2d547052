//! The keys of a YAML file and their values as text.

use std::collections::BTreeMap;
use std::fmt;

use granit_parser::{Event, Parser, ScalarStyle};

/// Maximum length of a value in a message (characters).
const MAX_SHOWN: usize = 60;

/// A key of the file.
#[derive(Debug, PartialEq)]
pub struct Entry {
    /// Line of the key, from 1.
    pub line: usize,
    /// Its value.
    pub value: Value,
}

/// Value of a key.
#[derive(Debug, PartialEq)]
pub enum Value {
    /// A scalar in any style, without its quotes; empty if it is null.
    Text(String),
    /// A list of scalars.
    List(Vec<String>),
    /// Any other value: its description.
    Other(&'static str),
}

/// A fault of the file: its line, from 1, the actual and the expected text.
pub type Fault = (usize, String, &'static str);

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(&shown(text)),
            Self::List(values) => f.write_str(&shown(&format!("[{}]", values.join(", ")))),
            Self::Other(description) => f.write_str(description),
        }
    }
}

/// Returns the beginning of a long text.
pub fn shown(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// Reads the mapping of a YAML file; tags are ignored, and aliases are values like tables, which no key of a map has.
///
/// # Errors
/// The text is not YAML, is nested too deeply, is not one mapping from texts, or has a key twice.
pub fn entries(text: &str) -> Result<BTreeMap<String, Entry>, Fault> {
    let mut events = Events(Parser::new_from_str(text));
    let mut entries = None;
    while let Some((event, line)) = events.next()? {
        match event {
            Event::MappingStart(..) if entries.is_none() => entries = Some(mapping(&mut events)?),
            Event::Scalar(value, style, ..) if text_of(&value, style).is_empty() => {}
            event if event.is_node() => {
                let found = if entries.is_some() {
                    "a second document"
                } else {
                    "no key"
                };
                return Err((
                    line,
                    found.to_owned(),
                    "one document with lines of `key: value`",
                ));
            }
            _ => {}
        }
    }
    Ok(entries.unwrap_or_default())
}

/// Reads a mapping after its start.
fn mapping(events: &mut Events<'_>) -> Result<BTreeMap<String, Entry>, Fault> {
    let mut entries = BTreeMap::new();
    while let Some((event, line)) = events.next()? {
        let key = match event {
            Event::MappingEnd => break,
            Event::Scalar(key, ..) => key.into_owned(),
            _ => {
                return Err((line, "a key that is no text".to_owned(), "`key: value`"));
            }
        };
        let value = value(events)?;
        if entries.contains_key(&key) {
            let found = format!("{} a second time", shown(&key));
            return Err((line, found, "every key once"));
        }
        entries.insert(key, Entry { line, value });
    }
    Ok(entries)
}

/// Reads the value of a key.
fn value(events: &mut Events<'_>) -> Result<Value, Fault> {
    let mut list = Vec::new();
    let mut depth = 0_usize;
    let mut other = None;
    while let Some((event, _)) = events.next()? {
        match event {
            Event::Scalar(value, style, ..) => {
                let text = text_of(&value, style).to_owned();
                if depth == 0 {
                    return Ok(Value::Text(text));
                }
                list.push(text);
            }
            Event::SequenceStart(..) => {
                depth += 1;
                if depth > 1 {
                    other.get_or_insert("a list of lists");
                }
            }
            Event::MappingStart(..) => {
                depth += 1;
                other.get_or_insert("a table");
            }
            Event::Alias(_) => {
                other.get_or_insert("an alias");
            }
            Event::SequenceEnd | Event::MappingEnd => depth = depth.saturating_sub(1),
            _ => continue,
        }
        if depth == 0 {
            break;
        }
    }
    Ok(other.map_or(Value::List(list), Value::Other))
}

/// Returns the text of a scalar; empty for null.
fn text_of(value: &str, style: ScalarStyle) -> &str {
    match value {
        "~" | "null" | "Null" | "NULL" if style == ScalarStyle::Plain => "",
        text => text,
    }
}

/// The events of a text, with their lines.
struct Events<'a>(Parser<'a, granit_parser::StrInput<'a>>);

impl<'a> Events<'a> {
    fn next(&mut self) -> Result<Option<(Event<'a>, usize)>, Fault> {
        match self.0.next() {
            Some(Ok((event, span))) => Ok(Some((event, span.start.line()))),
            Some(Err(error)) => {
                let (line, found) = (error.marker().line(), shown(&error.info()));
                Err((line, found, "YAML"))
            }
            None => Ok(None),
        }
    }
}
