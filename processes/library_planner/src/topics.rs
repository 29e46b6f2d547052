//! The topics that a library declares, and its structures beside their messages.

use core::ffi::c_char;
use std::collections::BTreeMap;

use ipc_types::layout::TopicLayout;
use ipc_types::message::Descriptor;
use ipc_types::topics::TopicId;
use runtime::declaration::{WrittenDeclaration, WrittenOutput, WrittenTopic};

use crate::abi::{Field, LATER, PlannerTable, SOLE, Topic};
use crate::error::{TableError, Unexpected};
use crate::start_functions::text;

/// Maximum number of topics, and of fields of one of them.
const MAX_COUNT: usize = 256;

/// Returns the names of the topics that a library reads.
///
/// # Errors
/// [`Unexpected`] names the part of the table.
pub fn reads(table: &PlannerTable) -> Result<Vec<String>, Unexpected> {
    let topics = array("reads", table.reads, table.read_count)?;
    Ok(topics.iter().map(|topic| string(topic.name)).collect())
}

/// Returns the topics that a process reads and writes. Registers those that it writes.
///
/// # Errors
/// [`TableError`] names the part of the table, the topic and the field.
pub fn declaration(table: &PlannerTable) -> Result<WrittenDeclaration, TableError> {
    let topics = array("writes", table.writes, table.write_count)?;
    let declared = WrittenDeclaration {
        reads: reads(table)?,
        writes: topics.iter().map(output).collect::<Result<_, _>>()?,
    };
    declared.register()?;
    for topic in topics {
        compare(topic)?;
    }
    Ok(declared)
}

/// Checks the structures of the topics that a library reads, which are known by now.
///
/// # Errors
/// [`Unexpected`] names the topic and the field.
pub fn check_reads(table: &PlannerTable) -> Result<(), Unexpected> {
    let topics = array("reads", table.reads, table.read_count)?;
    topics.iter().try_for_each(compare)
}

fn output(topic: &Topic) -> Result<WrittenOutput, Unexpected> {
    let name = string(topic.name);
    if topic.flags & !(LATER | SOLE) != 0 {
        return Err(Unexpected::new(
            format!("topic {name:?}: flags = {}", topic.flags),
            "a sum of PROTEAN_LATER and PROTEAN_SOLE",
        ));
    }
    let fields = fields(topic, &name)?.iter();
    let fields = fields.map(|field| format!("{} {}\n", string(field.kind), string(field.name)));
    let drawing = string(topic.drawing);
    if let Some(word) = drawing.split_whitespace().find(|word| !word.contains('=')) {
        let part = format!("topic {name:?}: drawing: {word:?}");
        return Err(Unexpected::new(part, "words as x=FIELD"));
    }
    let entries = [
        ("message", fields.collect()),
        ("may_be_infinite", string(topic.may_be_infinite)),
        ("drawing", drawing),
    ];
    let entries: BTreeMap<String, String> = entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect();
    let layout = TopicLayout::from_entries(&name, &entries).unwrap_or_default();
    Ok(WrittenOutput {
        topic: WrittenTopic::from_layout(layout, topic.flags & LATER != 0),
        elements: topic.capacity,
        sole: topic.flags & SOLE != 0,
    })
}

/// Compares the structure of a topic with its message.
fn compare(topic: &Topic) -> Result<(), Unexpected> {
    let name = string(topic.name);
    let Some(known) = TopicId::from_name(&name) else {
        // Refused when it is opened.
        return Ok(());
    };
    let element = &known.facts().element;
    let fields = fields(topic, &name)?;
    let differs = |found: String, expected: String| {
        let part = format!("topic {name:?}: the structure has {found}");
        Err(Unexpected::new(part, expected))
    };
    if !fields.is_empty() {
        let own = fields.iter().map(|field| {
            let (offset, size) = (field.offset as usize, field.size as usize);
            (string(field.name), offset, size)
        });
        let (own, expected): (Vec<_>, Vec<_>) = (own.collect(), spans(element).collect());
        for (at, expected) in expected.iter().enumerate() {
            if own.get(at) != Some(expected) {
                let found = own.get(at).map_or("nothing".to_owned(), span);
                return differs(found, span(expected));
            }
        }
        if let Some(more) = own.get(expected.len()) {
            return differs(span(more), "no further field".to_owned());
        }
    }
    if topic.size != element.size {
        return differs(format!("{} bytes", topic.size), element.size.to_string());
    }
    Ok(())
}

/// Returns name, offset and size of the fields of a message, which has no padding.
fn spans(message: &Descriptor) -> impl Iterator<Item = (String, usize, usize)> {
    let ends = message.fields.iter().skip(1).map(|field| field.offset);
    let ends = ends.chain([message.size]);
    let fields = message.fields.iter().zip(ends);
    fields.map(|(field, end)| (field.name.to_owned(), field.offset, end - field.offset))
}

fn span((name, offset, size): &(String, usize, usize)) -> String {
    format!("field {name} with {size} bytes at byte {offset}")
}

fn fields<'a>(topic: &'a Topic, name: &str) -> Result<&'a [Field], Unexpected> {
    array("fields", topic.fields, topic.field_count)
        .map_err(|e| e.within(&format!("topic {name:?}")))
}

#[expect(unsafe_code, reason = "strings of the table are C strings")]
fn string(string: *const c_char) -> String {
    // SAFETY: duty of the library, stated in the header: NULL or a string, which stays valid with the table.
    unsafe { text(string) }
}

/// Returns the elements of an array in the table.
#[expect(unsafe_code, reason = "arrays of the table are of the library")]
fn array<'a, T>(what: &str, first: *const T, count: usize) -> Result<&'a [T], Unexpected> {
    if count == 0 {
        return Ok(&[]);
    }
    if count > MAX_COUNT || first.is_null() || !first.is_aligned() {
        let address = if first.is_null() {
            "NULL"
        } else {
            "an address"
        };
        return Err(Unexpected::new(
            format!("{what}: {count} at {address}"),
            format!("an array of at most {MAX_COUNT}"),
        ));
    }
    // SAFETY: duty of the library, stated in the header: the array has this many elements, which stay valid with the table.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}
