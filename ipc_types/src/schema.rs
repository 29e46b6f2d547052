//! Schemas of the topics for logs, generated from the message definitions.

use core::fmt::Write as _;

use crate::message::{Descriptor, FieldKind};
use crate::topics::{Arity, Topic, TopicFacts, TopicId};

/// Name of the logged message of a topic, e.g. `protean/msg/WorldState`.
pub fn message_name(topic: TopicId) -> String {
    let mut name = String::from("protean/msg/");
    for part in topic.name().split(['/', '_']) {
        let mut letters = part.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        name.push_str(letters.as_str());
    }
    name
}

/// The ROS 2 message definition (`ros2msg`) of a logged topic: the fields of the user header, then
/// the fields of the one element or a sequence of elements; nested types follow after separators.
/// The text has the format of `schema_encoding = "ros2msg"`.
pub fn ros2msg(topic: TopicId) -> String {
    let facts = topic.facts();
    let mut text = String::new();
    let mut nested = Vec::new();
    fields(&mut text, &facts.header, &mut nested);
    let element = facts.element;
    match facts.arity {
        Arity::One => fields(&mut text, &element, &mut nested),
        Arity::Many => {
            let _ = writeln!(text, "{}[] {}", element.name, facts.elements);
            if !element.fields.is_empty() {
                nested.push(element);
            }
        }
    }
    definitions_of(&mut text, nested);
    text
}

/// The fields of the element of a topic in the same words, then each message in it, and the header.
pub(crate) fn definitions(facts: &TopicFacts) -> String {
    let mut text = String::new();
    let mut nested = vec![facts.header];
    fields(&mut text, &facts.element, &mut nested);
    definitions_of(&mut text, nested);
    text
}

/// Adds messages, each once.
fn definitions_of(text: &mut String, mut nested: Vec<Descriptor>) {
    let mut done: Vec<&str> = Vec::new();
    while let Some(descriptor) = nested.pop() {
        if done.contains(&descriptor.name) {
            continue;
        }
        done.push(descriptor.name);
        let _ = writeln!(text, "{}\nMSG: {}", "=".repeat(80), descriptor.name);
        fields(text, &descriptor, &mut nested);
    }
}

fn fields(text: &mut String, descriptor: &Descriptor, nested: &mut Vec<Descriptor>) {
    for field in descriptor.fields {
        // A write to a String cannot fail.
        let _ = match field.kind {
            FieldKind::Number(ros) => write!(text, "{ros} {}", field.name),
            FieldKind::Array(ros, n) => write!(text, "{ros}[{n}] {}", field.name),
            FieldKind::Nested(inner) => {
                nested.push(*inner);
                write!(text, "{} {}", inner.name, field.name)
            }
        };
        let _ = writeln!(text, "  # {}", field.doc);
    }
}

/// Hash of all properties on which two processes must agree to exchange a topic: names, order,
/// types and offsets of all fields. It is stored as an attribute of the service, because iceoryx2
/// itself compares only names and sizes of types.
pub fn hash<T: Topic>() -> String {
    fingerprint(T::FACTS)
}

/// As [`hash`], of the topic as a value.
pub fn hash_of(topic: TopicId) -> String {
    fingerprint(topic.facts())
}

/// As [`hash`], of the facts of a topic.
pub(crate) fn fingerprint(topic: &TopicFacts) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(topic.name.as_bytes());
    hasher.update(&[u8::from(topic.arity == Arity::Many)]);
    digest(&mut hasher, &topic.header);
    digest(&mut hasher, &topic.element);
    hasher.finalize().to_hex()[..16].to_owned()
}

fn digest(hasher: &mut blake3::Hasher, descriptor: &Descriptor) {
    hasher.update(descriptor.name.as_bytes());
    for n in [descriptor.size, descriptor.align, descriptor.fields.len()] {
        hasher.update(&(n as u64).to_le_bytes());
    }
    for field in descriptor.fields {
        hasher.update(field.name.as_bytes());
        hasher.update(&(field.offset as u64).to_le_bytes());
        match field.kind {
            FieldKind::Number(ros) => {
                hasher.update(ros.as_bytes());
            }
            FieldKind::Array(ros, n) => {
                hasher.update(ros.as_bytes());
                hasher.update(&(n as u64).to_le_bytes());
            }
            FieldKind::Nested(inner) => digest(hasher, inner),
        }
    }
}
