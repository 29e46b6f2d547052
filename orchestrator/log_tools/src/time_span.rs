//! A span of time of a log.

use std::path::Path;

use mcap_log::output::MANIFEST;
use mcap_log::reader::{Item, Reader};
use mcap_log::{LogReadError, ReadProgress};

/// Log times of the first and of the last message to take (ns).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeSpan {
    pub from: u64,
    pub to: u64,
}

impl TimeSpan {
    /// Returns the span between two times on the command line (s): simulated time in logs of Protean, time since
    /// the first message in other logs.
    ///
    /// # Errors
    /// [`LogReadError`] if the log cannot be read, a time is out of range, or the start is after the end.
    pub(crate) fn new(
        log: &Path,
        start_s: Option<f64>,
        end_s: Option<f64>,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let start = nanoseconds("--start", start_s)?;
        let end = nanoseconds("--end", end_s)?;
        if let (Some(start), Some(end)) = (start, end)
            && start > end
        {
            let text = "--start: expected a time that is not after --end";
            return Err(LogReadError::Argument(text.to_owned()));
        }
        let zero = match (start, end) {
            (None, None) => 0,
            _ => zero(log, watch)?,
        };
        Ok(Self {
            from: start.map_or(0, |start| zero.saturating_add(start)),
            to: end.map_or(u64::MAX, |end| zero.saturating_add(end)),
        })
    }

    /// Returns `true` if a log time (ns) lies in the span.
    pub(crate) fn contains(self, time: u64) -> bool {
        (self.from..=self.to).contains(&time)
    }
}

/// Converts a time on the command line (s) to nanoseconds.
///
/// # Errors
/// [`LogReadError::Argument`] if it is negative, not finite or beyond 1e10 s.
pub fn nanoseconds(option: &str, time: Option<f64>) -> Result<Option<u64>, LogReadError> {
    match time {
        None => Ok(None),
        Some(t) if (0.0..=1e10).contains(&t) => Ok(Some((t * 1e9).round() as u64)),
        Some(t) => Err(LogReadError::Argument(format!(
            "{option} {t}: expected a time from 0 to 1e10 (s)"
        ))),
    }
}

/// Returns the log time that counts as 0: the start of the run in logs of Protean, the first message in others.
fn zero(log: &Path, watch: &mut ReadProgress) -> Result<u64, LogReadError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let mut first = u64::MAX;
    while let Some(item) = reader.next()? {
        match item {
            // The manifest precedes the first message.
            Item::Metadata(record) if record.name == MANIFEST => return Ok(0),
            Item::Message(header, _) => first = first.min(header.log_time),
            _ => {}
        }
    }
    Ok(if first == u64::MAX { 0 } else { first })
}
