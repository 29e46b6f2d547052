//! Table of the messages of a topic, in a file or in memory.

use std::io;

use mcap_log::MessageHeader;
use mcap_log::reader::{Channel, Schema};
use recorder::{ROBOTS_TOPIC, robot_names};
use tables::{Cell, Column, Rows};

use super::layout::Layout;
use super::message_json::{Undecodable, schema_of};

/// Returns the layout of a channel's table, or the reason why it has none.
pub fn layout(channel: &Channel, schema: Option<&Schema>) -> Result<Layout, Undecodable> {
    Ok(Layout::new(schema_of(channel, schema)?)?)
}

/// Names of the robots of a log.
#[derive(Debug, Default)]
pub struct RobotNames {
    /// Channel of the names, and its schema.
    channel: Option<(u16, Vec<u8>)>,
    /// Names by index; empty if the log does not state them.
    pub(crate) names: Vec<String>,
}

impl RobotNames {
    /// Takes note of a channel.
    pub(crate) fn channel(&mut self, channel: &Channel, schema: Option<&Schema>) {
        if channel.topic == ROBOTS_TOPIC {
            self.channel = schema.map(|schema| (channel.id, schema.data.clone()));
        }
    }

    /// Reads the names if they are in this message.
    pub(crate) fn message(&mut self, header: &MessageHeader, data: &[u8]) {
        if let Some((channel, schema)) = &self.channel
            && *channel == header.channel_id
        {
            self.names = robot_names(schema, data).unwrap_or_default();
        }
    }
}

/// A table that is being filled; its end returns `W`.
pub struct TopicTable<W> {
    layout: Layout,
    /// Positions of the columns that state a robot by index.
    robot_columns: Vec<usize>,
    /// Names of the robots, by index.
    robots: Vec<String>,
    rows: Box<dyn Rows<W>>,
    /// Number of messages in it.
    pub(crate) messages: u64,
    /// Number of rows.
    pub(crate) row_count: u64,
    /// Number of messages that do not fit their schema and were omitted.
    pub(crate) undecodable: u64,
    /// Reason of the first of them.
    pub(crate) fault: Option<String>,
}

impl<W> TopicTable<W> {
    /// Creates the table. If the names of the robots are known, each column with the index of one has another with
    /// the name, after all others. `rows` creates the writer of a table with these columns.
    pub(crate) fn begin<E>(
        topic: &str,
        layout: Layout,
        robots: &[String],
        rows: impl FnOnce(&[Column]) -> Result<Box<dyn Rows<W>>, E>,
    ) -> Result<Self, E> {
        let with_names = !robots.is_empty() && topic != ROBOTS_TOPIC;
        let robot_columns = layout.columns_with_robots().filter(|_| with_names);
        Ok(Self {
            rows: rows(&layout.columns(with_names))?,
            robot_columns: robot_columns.collect(),
            layout,
            robots: robots.to_vec(),
            messages: 0,
            row_count: 0,
            undecodable: 0,
            fault: None,
        })
    }

    /// Adds a message.
    ///
    /// # Errors
    /// The rows cannot be written.
    pub(crate) fn take(&mut self, header: &MessageHeader, data: &[u8]) -> io::Result<()> {
        let first = [
            Cell::UInt(header.log_time),
            Cell::UInt(header.publish_time),
            Cell::UInt(u64::from(header.sequence)),
        ];
        let Self {
            layout,
            robot_columns,
            robots,
            rows,
            ..
        } = self;
        let mut written = 0;
        let result = layout.rows(&first, data, &mut |cells| {
            written += 1;
            for at in robot_columns.iter() {
                let name = name_of(cells.get(*at), robots);
                cells.push(name);
            }
            rows.row(cells)
        });
        self.row_count += written;
        match result {
            Ok(Ok(())) => self.messages += 1,
            Ok(Err(error)) => return Err(error),
            Err(error) => {
                self.undecodable += 1;
                self.fault.get_or_insert_with(|| error.to_string());
            }
        }
        Ok(())
    }

    /// Ends the table.
    ///
    /// # Errors
    /// The rows cannot be written.
    pub(crate) fn finish(self) -> io::Result<W> {
        self.rows.finish()
    }
}

/// Returns the name of the robot with the index in a cell; empty if there is none.
fn name_of(index: Option<&Cell>, robots: &[String]) -> Cell {
    let Some(Cell::UInt(index)) = index else {
        return Cell::Empty;
    };
    let name = usize::try_from(*index)
        .ok()
        .and_then(|index| robots.get(index));
    name.map_or(Cell::Empty, |name| Cell::Text(name.clone()))
}
