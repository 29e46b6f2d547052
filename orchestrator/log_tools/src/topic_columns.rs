//! Messages of a topic as columns in memory.

use std::io;
use std::path::Path;

use mcap_log::reader::{Item, Reader};
use mcap_log::{LogReadError, ReadProgress};
use tables::{ColumnValues, InMemory, Rows};

use super::layout::Layout;
use super::topic_table::{RobotNames, TopicTable, layout};

/// The messages of a topic, as [`export`](crate::export()) writes them: a row for each element of each message.
#[derive(Debug, Clone, PartialEq)]
pub struct TopicColumns {
    /// The columns.
    pub columns: Vec<ColumnValues>,
    /// Number of messages in them.
    pub messages: u64,
    /// Number of rows.
    pub rows: u64,
    /// Number of messages that do not fit their schema and were omitted.
    pub undecodable: u64,
}

impl TopicColumns {
    /// Reads the messages of the channel with this id. A truncated or damaged log is read as far as possible. The memory
    /// grows with the number of messages.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read, or its channel is absent or has no ROS 2 messages.
    pub fn read(log: &Path, channel: u16, watch: &mut ReadProgress) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let mut robots = RobotNames::default();
        let mut found = None;
        let mut table = None;
        while let Some(item) = reader.next()? {
            match item {
                Item::Channel(next) => {
                    let schema = reader.schema(next.schema_id);
                    robots.channel(&next, schema.as_deref());
                    if next.id == channel {
                        let layout = layout(&next, schema.as_deref());
                        let why = |why| LogReadError::Argument(format!("{}: {why}", next.topic));
                        found = Some((next.topic.clone(), layout.map_err(why)?));
                    }
                }
                Item::Message(header, data) => {
                    robots.message(&header, data);
                    if header.channel_id != channel {
                        continue;
                    }
                    if table.is_none()
                        && let Some((topic, layout)) = found.take()
                    {
                        table = Some(begin(&topic, layout, &robots)?);
                    }
                    if let Some(table) = &mut table {
                        table.take(&header, data).map_err(too_many_texts)?;
                    }
                }
                _ => {}
            }
        }
        let table = match (table, found) {
            (Some(table), _) => table,
            (None, Some((topic, layout))) => begin(&topic, layout, &robots)?,
            (None, None) => {
                let what = format!("{} has no channel {channel}", log.display());
                return Err(LogReadError::Argument(what));
            }
        };
        Ok(Self {
            messages: table.messages,
            rows: table.row_count,
            undecodable: table.undecodable,
            columns: table.finish().map_err(too_many_texts)?,
        })
    }
}

fn begin(
    topic: &str,
    layout: Layout,
    robots: &RobotNames,
) -> Result<TopicTable<Vec<ColumnValues>>, LogReadError> {
    TopicTable::begin(topic, layout, &robots.names, |columns| {
        let rows: Box<dyn Rows<_>> = Box::new(InMemory::new(columns));
        Ok(rows)
    })
}

/// Returns the only error of a table in memory: a column has more than 2³¹ different texts.
#[expect(clippy::needless_pass_by_value, reason = "for `map_err`")]
pub fn too_many_texts(error: io::Error) -> LogReadError {
    LogReadError::Argument(error.to_string())
}
