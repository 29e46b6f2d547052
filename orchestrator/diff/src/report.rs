//! The differences of two logs.

use std::path::Path;

use mcap_log::{Condition, LogReadError, ReadProgress};
use serde::Serialize;

use crate::comparison::Comparison;
use crate::facts::{EventChange, ValueChange, event_changes, result_changes, scenario_changes};
use crate::history::{History, Moment};
use crate::message::Message;

/// One of the two logs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogFacts {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: String,
    /// Version of Protean that recorded it.
    pub version: String,
    /// Digest of the run; `None` if the run did not reach its end.
    pub digest: Option<String>,
    /// Condition of the file.
    pub condition: Condition,
}

/// The differences of two logs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiffReport {
    /// The first log.
    pub a: LogFacts,
    /// The second log.
    pub b: LogFacts,
    /// `true` if the simulated histories are equal as far as both logs go.
    pub same: bool,
    /// `true` if both logs contain their whole run.
    pub whole: bool,
    /// Keys of the scenario that differ.
    pub scenario: Vec<ValueChange>,
    /// Comparison of the histories.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Values of the result that differ; none if one of the logs has no result.
    pub results: Vec<ValueChange>,
    /// Events that differ.
    pub events: Vec<EventChange>,
}

/// Compares two logs, in memory that does not grow with them.
///
/// Processes are compared by name, fields of messages of different versions too. A log without the end of its run is
/// compared up to its end.
///
/// # Errors
/// [`LogReadError`]: a log cannot be read, is not a Protean log, or its times are not in order.
pub fn diff(a: &Path, b: &Path, watch: &mut ReadProgress) -> Result<DiffReport, LogReadError> {
    diff_before(a, b, u64::MAX, watch)
}

/// Compares two logs like [`diff()`], their histories up to log time `before` (ns).
///
/// # Errors
/// As [`diff()`].
pub fn diff_before(
    a: &Path,
    b: &Path,
    before: u64,
    watch: &mut ReadProgress,
) -> Result<DiffReport, LogReadError> {
    let (mut x, mut y) = (History::open(a, before)?, History::open(b, before)?);
    watch.begin(x.condition().file_bytes);
    let mut comparison = Comparison::new([x.run.clone(), y.run.clone()]);
    let (mut p, mut q) = (x.moment()?, y.moment()?);
    loop {
        watch.at(x.offset())?;
        let times = [&p, &q].map(|moment| moment.as_ref().map(|moment| moment.time_ns));
        let has_more = times.map(|time| time.is_some());
        let is_cut = [has_more[0] || x.has_ended(), has_more[1] || y.has_ended()].contains(&false);
        let Some(now) = times.into_iter().flatten().min().filter(|_| !is_cut) else {
            break;
        };
        let (of_x, of_y) = (take(&mut p, &mut x, now)?, take(&mut q, &mut y, now)?);
        // The last tick of a log that was cut may be incomplete.
        let may_lack = [p.is_none() && !x.has_ended(), q.is_none() && !y.has_ended()];
        comparison.add(now, &of_x, &of_y, may_lack);
    }
    x.finish()?;
    y.finish()?;
    watch.end();
    let has_results = !x.origin.result.is_empty() && !y.origin.result.is_empty();
    let scenario = |history: &History| {
        let text = history.origin.scenario.as_deref().unwrap_or_default();
        String::from_utf8_lossy(text).into_owned()
    };
    Ok(DiffReport {
        same: comparison.first.is_none(),
        whole: x.has_ended() && y.has_ended(),
        scenario: scenario_changes(&scenario(&x), &scenario(&y)),
        results: if has_results {
            result_changes(&x.origin.result, &y.origin.result)
        } else {
            Vec::new()
        },
        events: event_changes(&x.events, &y.events),
        a: log_facts(&x),
        b: log_facts(&y),
        comparison,
    })
}

/// Returns the messages of this time (ns), and reads the next moment if there are any.
fn take(
    moment: &mut Option<Moment>,
    history: &mut History,
    now: u64,
) -> Result<Vec<Message>, LogReadError> {
    match moment.take_if(|moment| moment.time_ns == now) {
        Some(found) => {
            *moment = history.moment()?;
            Ok(found.messages)
        }
        None => Ok(Vec::new()),
    }
}

fn log_facts(history: &History) -> LogFacts {
    let entry = |key: &str| {
        history
            .origin
            .manifest
            .get(key)
            .cloned()
            .unwrap_or_default()
    };
    LogFacts {
        scenario: entry("scenario"),
        seed: entry("seed"),
        version: entry("version"),
        digest: history.origin.result.get("digest").cloned(),
        condition: history.condition().clone(),
    }
}
