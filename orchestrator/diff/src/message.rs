//! Comparison of two messages of a topic.

use std::ops::Range;

use ipc_types::stamp::Stamp;
use mcap_log::known::{CLOCKS, ENCAPSULATION};
use mcap_log::ros2::{Cdr, DecodeError, Schema, field_at};
use tables::Cell;

use crate::history::Message;

/// Bytes of the index of the sender, which is compared by its name.
const SOURCE: Range<usize> = {
    let start = ENCAPSULATION + core::mem::offset_of!(Stamp, source);
    start..start + size_of::<u32>()
};

/// A field with different values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FieldChange {
    /// Its name, such as `robots[3].x`.
    pub(crate) field: String,
    /// Values in both messages; empty if absent.
    pub(crate) values: [String; 2],
    /// Index of the robot that the field is about, if the message tells it.
    pub(crate) robot: Option<u64>,
}

/// Returns the first field that differs; `None` if the messages are equal. Messages of different definitions are equal if
/// the fields that both have are.
pub(crate) fn first_change(a: &Message, b: &Message) -> Option<FieldChange> {
    if a.topic.definition != b.topic.definition {
        return by_names(a, b);
    }
    let is_compared = |at: usize| !CLOCKS.contains(&at) && !SOURCE.contains(&at);
    let pairs = a.data.iter().zip(&b.data).enumerate();
    let differ = pairs
        .filter(|(at, (x, y))| x != y && is_compared(*at))
        .map(|(at, _)| at)
        .next();
    let ends = (a.data.len() != b.data.len()).then(|| a.data.len().min(b.data.len()));
    let at = differ.or(ends)?;
    let Some(schema) = &a.topic.schema else {
        return Some(FieldChange {
            field: format!("byte {at}"),
            values: [&a.data, &b.data].map(|data| byte_text(data, at)),
            robot: None,
        });
    };
    let found = [a, b].map(|message| field_at(schema, &message.data, at).ok().flatten());
    let field = found.iter().flatten().next();
    let field = field.map_or_else(|| format!("byte {at}"), |(name, _)| name.clone());
    Some(FieldChange {
        robot: robot_of(schema, a, &field).or_else(|| robot_of(schema, b, &field)),
        values: found.map(|found| found.map_or_else(String::new, |(_, value)| value.to_string())),
        field,
    })
}

fn byte_text(data: &[u8], at: usize) -> String {
    data.get(at).map_or_else(String::new, u8::to_string)
}

/// Returns the first field of both messages that differs, by name.
fn by_names(a: &Message, b: &Message) -> Option<FieldChange> {
    let [Some(x), Some(y)] = [a, b].map(|message| {
        let schema = message.topic.schema.as_ref()?;
        values(schema, &message.data).ok()
    }) else {
        return Some(FieldChange {
            field: "definition of the message".to_owned(),
            values: [String::new(), String::new()],
            robot: None,
        });
    };
    let other: std::collections::BTreeMap<&str, &Cell> =
        y.iter().map(|(name, cell)| (name.as_str(), cell)).collect();
    let changed = x.iter().find_map(|(name, cell)| {
        let other = other.get(name.as_str())?;
        (!cell.is_same(other)).then(|| (name.clone(), [cell.to_string(), other.to_string()]))
    });
    let (field, values) = changed?;
    let schema = a.topic.schema.as_ref()?;
    Some(FieldChange {
        robot: robot_of(schema, a, &field),
        field,
        values,
    })
}

/// Returns all values of a message in order, without its clocks and the index of its sender.
fn values(schema: &Schema, data: &[u8]) -> Result<Vec<(String, Cell)>, DecodeError> {
    let mut values = Vec::new();
    let mut cdr = Cdr::new(schema, data)?;
    for field in schema.fields() {
        cdr.field(field, &field.name, &mut |name, cell, end| {
            let last = end + ENCAPSULATION - 1;
            if !CLOCKS.contains(&last) && !SOURCE.contains(&last) {
                values.push((name.to_owned(), cell));
            }
        })?;
    }
    Ok(values)
}

/// Returns the value of the field `robot` beside a field or beside an element around it.
fn robot_of(schema: &Schema, message: &Message, field: &str) -> Option<u64> {
    let all = values(schema, &message.data).ok()?;
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
