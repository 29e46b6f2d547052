//! Tables of what is measured on the messages of a log, beside those of its topics.

use std::path::Path;

use mcap_log::reader::Reader;
use mcap_log::{LogReadError, ReadProgress};
use tables::{InMemory, Rows as _};

use crate::belief_rows::BeliefRows;
use crate::measurement::Measurement;
use crate::patrol_rows::PatrolRows;
use crate::topic_columns::{TopicColumns, too_many_texts};

/// A table of measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// Idleness of the patrols over time: a row for each patrol and state of the world.
    Patrols,
    /// Errors of the beliefs: a row for each belief about a robot in play.
    Beliefs,
}

impl Measured {
    /// All tables.
    pub(crate) const ALL: [Self; 2] = [Self::Patrols, Self::Beliefs];

    /// Name of the table.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Patrols => "patrols",
            Self::Beliefs => "beliefs",
        }
    }

    pub(crate) fn begin(self) -> Box<dyn Measurement> {
        match self {
            Self::Patrols => Box::<PatrolRows>::default(),
            Self::Beliefs => Box::<BeliefRows>::default(),
        }
    }

    /// Reads the table, as [`export`](crate::export()) writes it.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read.
    pub fn read(self, log: &Path, watch: &mut ReadProgress) -> Result<TopicColumns, LogReadError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let mut measured = self.begin();
        let mut rows = InMemory::new(&measured.columns());
        let mut count = 0;
        while let Some(item) = reader.next()? {
            for row in measured.take(&item) {
                rows.row(&row).map_err(too_many_texts)?;
                count += 1;
            }
        }
        Ok(TopicColumns {
            messages: measured.messages(),
            rows: count,
            undecodable: 0,
            columns: Box::new(rows).finish().map_err(too_many_texts)?,
        })
    }
}
