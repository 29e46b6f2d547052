//! Idleness of patrols over time, as a table.

use std::path::Path;

use ipc_types::consumer::LoggedMessage;
use ipc_types::topics::{TopicId, WorldState};
use mcap_log::known;
use mcap_log::reader::{Item, Reader};
use mcap_log::{LogReadError, MessageHeader, Origin, ReadProgress};
use recorder::{PatrolMeasurement, RunInfo};
use tables::{Cell, Column, InMemory, Rows as _, Type};

use super::topic_columns::{TopicColumns, too_many_texts};

/// Name of the table.
pub const PATROLS: &str = "patrols";

/// The patrols of a log, measured while it is read.
#[derive(Debug, Default)]
pub struct PatrolRows {
    origin: Origin,
    /// Channel of the states of the robots.
    states: Option<u16>,
    patrols: Vec<PatrolMeasurement>,
    /// Number of messages measured.
    pub(crate) messages: u64,
}

impl PatrolRows {
    /// Columns of the table.
    pub(crate) fn columns() -> Vec<Column> {
        let [uint, text, number] = [Type::UInt, Type::Text, Type::F64];
        [
            ("log_time_ns", uint),
            ("robots", text),
            ("mean_idleness_s", number),
            ("worst_idleness_s", number),
            ("worst_x", number),
            ("worst_y", number),
            ("visited", number),
        ]
        .map(|(name, kind)| Column::new(name, kind))
        .into()
    }

    /// Takes the next part of the log: a row for each patrol after each state of the world.
    pub(crate) fn take(&mut self, item: &Item<'_>) -> Vec<[Cell; 7]> {
        match item {
            Item::Attachment(header, _) if header.name == Origin::RUN => {
                self.origin.add(item);
                if let Some(run) = RunInfo::from_log(&self.origin) {
                    self.patrols = PatrolMeasurement::of_all(&run.patrols, &run.robots);
                }
            }
            Item::Channel(channel) if known::topic_of(channel) == Some(TopicId::WorldState) => {
                self.states = Some(channel.id);
            }
            Item::Message(header, data) if Some(header.channel_id) == self.states => {
                return self.rows(header, data);
            }
            _ => {}
        }
        Vec::new()
    }

    fn rows(&mut self, header: &MessageHeader, data: &[u8]) -> Vec<[Cell; 7]> {
        let message = LoggedMessage::new(TopicId::WorldState, header.log_time, data);
        let states = message.as_ref().and_then(LoggedMessage::view::<WorldState>);
        let (Some(message), Some((_, states))) = (&message, states) else {
            return Vec::new();
        };
        self.messages += 1;
        let row = |patrol: &mut PatrolMeasurement| {
            patrol.add(message.time_s(), states.clone());
            let now = patrol.places().now();
            let ends = patrol.ends().get(now.worst_place).copied();
            let middle = |axis: usize| ends.map(|[a, b]| f64::midpoint(a[axis], b[axis]));
            let [x, y] = [0, 1].map(|axis| middle(axis).map_or(Cell::Empty, Cell::F64));
            [
                Cell::UInt(header.log_time),
                Cell::Text(patrol.names().join(", ")),
                Cell::F64(now.mean_s),
                Cell::F64(now.worst_s),
                x,
                y,
                Cell::F64(now.visited),
            ]
        };
        self.patrols.iter_mut().map(row).collect()
    }
}

/// Reads the idleness of the patrols over time, as [`export`](crate::export()) writes it: a row for each patrol and state
/// of the world. No rows without a patrol.
///
/// # Errors
/// [`LogReadError`]: the log cannot be read.
pub fn patrols(log: &Path, watch: &mut ReadProgress) -> Result<TopicColumns, LogReadError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let mut patrols = PatrolRows::default();
    let mut rows = InMemory::new(&PatrolRows::columns());
    let mut count = 0;
    while let Some(item) = reader.next()? {
        for row in patrols.take(&item) {
            rows.row(&row).map_err(too_many_texts)?;
            count += 1;
        }
    }
    Ok(TopicColumns {
        messages: patrols.messages,
        rows: count,
        undecodable: 0,
        columns: Box::new(rows).finish().map_err(too_many_texts)?,
    })
}
