//! Idleness of patrols over time, as a table.

use ipc_types::consumer::LoggedMessage;
use ipc_types::topics::{TopicId, WorldState};
use mcap_log::known;
use mcap_log::reader::Item;
use mcap_log::{MessageHeader, Origin};
use recorder::{PatrolMeasurement, RunInfo};
use tables::{Cell, Column, Type};

use crate::measurement::Measurement;

/// The patrols of a log, measured while it is read.
#[derive(Debug, Default)]
pub(crate) struct PatrolRows {
    origin: Origin,
    /// Channel of the states of the robots.
    states: Option<u16>,
    patrols: Vec<PatrolMeasurement>,
    messages: u64,
}

impl Measurement for PatrolRows {
    fn columns(&self) -> Vec<Column> {
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

    fn take(&mut self, item: &Item<'_>) -> Vec<Vec<Cell>> {
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

    fn messages(&self) -> u64 {
        self.messages
    }
}

impl PatrolRows {
    fn rows(&mut self, header: &MessageHeader, data: &[u8]) -> Vec<Vec<Cell>> {
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
            vec![
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
