//! A measurement on the messages of a log, with a table of its own.

use mcap_log::reader::Item;
use tables::{Cell, Column};

/// A measurement on the messages of a log.
pub(crate) trait Measurement {
    /// Columns of its table.
    fn columns(&self) -> Vec<Column>;

    /// Takes the next part of the log; returns its rows.
    fn take(&mut self, item: &Item<'_>) -> Vec<Vec<Cell>>;

    /// Number of messages measured.
    fn messages(&self) -> u64;
}
