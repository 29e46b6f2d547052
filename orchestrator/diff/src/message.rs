//! Messages of a simulated history, and the comparison of two of a topic.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use ipc_types::schema::ros2msg;
use ipc_types::stamp::Stamp;
use ipc_types::topics::{PerTopic, TopicId};
use mcap_log::known::{self, CLOCKS, ENCAPSULATION};
use mcap_log::ros2::{Cdr, Schema, field_at};
use tables::Cell;

/// Bytes of the index of the sender, which is compared by its name.
const SOURCE: Range<usize> = {
    let start = ENCAPSULATION + core::mem::offset_of!(Stamp, source);
    start..start + size_of::<u32>()
};

/// A topic of a history.
#[derive(Debug)]
pub struct TopicFormat {
    /// Its name.
    pub(crate) name: String,
    /// Definition of its messages.
    pub(crate) definition: Vec<u8>,
    /// The same, parsed; `None` if it cannot be.
    pub(crate) schema: Option<Schema>,
}

/// A message of a simulated history.
#[derive(Debug)]
pub struct Message {
    pub(crate) topic: Arc<TopicFormat>,
    pub(crate) stamp: Stamp,
    /// CDR form.
    pub(crate) data: Vec<u8>,
}

impl Message {
    /// Returns a message in CDR form of a topic of this version; `None` if the topic does not belong to the simulated
    /// history, or the message has no stamp.
    pub fn from_cdr(topic: TopicId, data: Vec<u8>) -> Option<Self> {
        static FORMATS: PerTopic<Arc<TopicFormat>> = PerTopic::new(|topic| {
            Arc::new(TopicFormat {
                name: topic.name().to_owned(),
                definition: ros2msg(topic).into_bytes(),
                schema: known::layout(topic).schema.clone(),
            })
        });
        let stamp = known::stamp(&data).filter(|_| topic.facts().simulated)?;
        Some(Self {
            topic: Arc::clone(FORMATS.get(topic)),
            stamp,
            data,
        })
    }
}

/// A field with different values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldChange {
    /// Its name, such as `robots[3].x`.
    pub(crate) field: String,
    /// Values in both messages; empty if absent.
    pub(crate) values: [String; 2],
    /// Index of the robot that the field is about, if the message tells it.
    pub(crate) robot: Option<u64>,
}

/// Returns `true` if two messages are equal, except for clocks. Messages of different definitions are equal if the fields
/// that both have are.
pub fn is_same(a: &Message, b: &Message) -> bool {
    if a.topic.definition == b.topic.definition {
        differing_byte(&a.data, &b.data).is_none()
    } else {
        common(a, b).is_some_and(|fields| fields.iter().all(|(_, x, y)| x.is_same(y)))
    }
}

/// Returns the first byte in which two messages of one definition differ.
fn differing_byte(a: &[u8], b: &[u8]) -> Option<usize> {
    // Whole parts are compared first: most messages are equal.
    let compared = [
        0..SOURCE.start,
        SOURCE.end..CLOCKS.start,
        CLOCKS.end..usize::MAX,
    ];
    for part in compared {
        let [x, y] = [a, b].map(|data| {
            let end = part.end.min(data.len());
            data.get(part.start.min(end)..end).unwrap_or_default()
        });
        if x != y {
            let differ = x.iter().zip(y).position(|(x, y)| x != y);
            return Some(part.start + differ.unwrap_or_else(|| x.len().min(y.len())));
        }
    }
    None
}

/// Returns the first field that differs of two messages that are not the same.
pub fn first_change(a: &Message, b: &Message) -> FieldChange {
    if a.topic.definition != b.topic.definition {
        let changed = common(a, b).unwrap_or_default();
        let changed = changed.into_iter().find(|(_, x, y)| !x.is_same(y));
        let (field, values) = match changed {
            Some((field, x, y)) => (field, [x.to_string(), y.to_string()]),
            None => ("definition of the message".to_owned(), Default::default()),
        };
        let robot = robot_of(a, &field);
        return FieldChange {
            field,
            values,
            robot,
        };
    }
    let at = differing_byte(&a.data, &b.data).unwrap_or_default();
    let schema = a.topic.schema.as_ref();
    let found = [a, b].map(|message| field_at(schema?, &message.data, at).ok().flatten());
    match found.iter().flatten().next() {
        Some((field, _)) => FieldChange {
            field: field.clone(),
            robot: robot_of(a, field).or_else(|| robot_of(b, field)),
            values: found
                .map(|found| found.map_or_else(String::new, |(_, value)| value.to_string())),
        },
        None => FieldChange {
            field: format!("byte {at}"),
            values: [a, b]
                .map(|message| message.data.get(at).map_or_else(String::new, u8::to_string)),
            robot: None,
        },
    }
}

/// Returns the fields that both messages have, by name, with both values; `None` if one cannot be decoded.
pub fn common(a: &Message, b: &Message) -> Option<Vec<(String, Cell, Cell)>> {
    let mut others: BTreeMap<String, Cell> = values(b)?.into_iter().collect();
    let fields = values(a)?.into_iter();
    let fields = fields.filter_map(|(name, cell)| {
        let other = others.remove(&name)?;
        Some((name, cell, other))
    });
    Some(fields.collect())
}

/// Returns all values of a message in order, without its clocks and the index of its sender.
fn values(message: &Message) -> Option<Vec<(String, Cell)>> {
    let schema = message.topic.schema.as_ref()?;
    let mut values = Vec::new();
    let mut cdr = Cdr::new(schema, &message.data).ok()?;
    for field in schema.fields() {
        cdr.field(field, &field.name, &mut |name, cell, end| {
            let last = end + ENCAPSULATION - 1;
            if !CLOCKS.contains(&last) && !SOURCE.contains(&last) {
                values.push((name.to_owned(), cell));
            }
        })
        .ok()?;
    }
    Some(values)
}

/// Returns the value of the field `robot` beside a field or beside an element around it.
fn robot_of(message: &Message, field: &str) -> Option<u64> {
    let all = values(message)?;
    let mut within = field;
    while let Some((outer, _)) = within.rsplit_once('.') {
        let name = format!("{outer}.robot");
        if let Some((_, Cell::UInt(robot))) = all.iter().find(|(known, _)| *known == name) {
            return Some(*robot);
        }
        within = outer;
    }
    all.iter().find_map(|(name, cell)| match cell {
        Cell::UInt(robot) if name == "robot" || name == "header.robot" => Some(*robot),
        _ => None,
    })
}
