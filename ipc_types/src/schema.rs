//! Schemas of the topics for logs and other languages, made from the message definitions.

use core::fmt::Write as _;

use crate::message::{Descriptor, FieldKind, Message};
use crate::topics::{Shape, Topic};

/// Name of the logged message of a topic, e.g. `protean/msg/WorldState`.
pub fn message_name<T: Topic>() -> String {
    let mut name = String::from("protean/msg/");
    for part in T::NAME.split(['/', '_']) {
        let mut letters = part.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        name.push_str(letters.as_str());
    }
    name
}

/// The ROS 2 message definition (`ros2msg`) of what the log holds for a topic: the fields of the
/// user header, then the fields of the one element or a sequence of elements; nested types follow
/// behind separators. The text is what `schema_encoding = "ros2msg"` expects.
pub fn ros2msg<T: Topic>() -> String {
    let mut text = String::new();
    let mut nested = Vec::new();
    fields(&mut text, &T::Header::DESCRIPTOR, &mut nested);
    let element = T::Element::DESCRIPTOR;
    match T::SHAPE {
        Shape::One => fields(&mut text, &element, &mut nested),
        Shape::Many => {
            let _ = writeln!(text, "{}[] {}", element.name, T::ELEMENTS);
            if !element.fields.is_empty() {
                nested.push(element);
            }
        }
    }
    let mut done: Vec<&str> = Vec::new();
    while let Some(descriptor) = nested.pop() {
        if done.contains(&descriptor.name) {
            continue;
        }
        done.push(descriptor.name);
        let _ = writeln!(text, "{}\nMSG: {}", "=".repeat(80), descriptor.name);
        fields(&mut text, &descriptor, &mut nested);
    }
    text
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

/// Fingerprint of everything two processes must agree on to exchange a topic: names, order, types
/// and offsets of all fields. Stored as an attribute of the service, because iceoryx2 itself
/// compares names and sizes of types only.
pub fn hash<T: Topic>() -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(T::NAME.as_bytes());
    hasher.update(&[u8::from(T::SHAPE == Shape::Many)]);
    digest(&mut hasher, &T::Header::DESCRIPTOR);
    digest(&mut hasher, &T::Element::DESCRIPTOR);
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
