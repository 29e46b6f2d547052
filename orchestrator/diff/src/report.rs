//! The differences of two logs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use mcap_log::{Condition, LogReadError, ReadProgress};
use serde::Serialize;

use crate::cause::causes;
use crate::facts::{EventChange, ValueChange, event_changes, result_changes, scenario_changes};
use crate::history::{History, Message, Moment};
use crate::message::first_change;

/// Maximum number of messages that are listed of the first tick with a difference.
const MAX_DIFFERENCES: usize = 64;

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

/// A message that differs, or that only one of the logs has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Tick of the message.
    pub tick: u64,
    /// Name of the process that sent it.
    pub process: String,
    /// Kind of that process.
    pub kind: String,
    /// Topic.
    pub topic: String,
    /// Name of the robot that the field is about, if the message tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// First field that differs, e.g. `robots[2].x`; empty if one of the logs lacks the message.
    pub field: String,
    /// Its value in the first log; empty if it has none.
    pub a: String,
    /// Its value in the second log; empty if it has none.
    pub b: String,
}

/// The first tick in which two histories differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FirstDifference {
    /// Simulated time (s).
    pub time_s: f64,
    /// Messages of the processes that received the same inputs in both runs, one of each topic.
    pub causes: Vec<Difference>,
    /// Other messages of this tick that differ, of processes that received other inputs.
    pub effects: Vec<Difference>,
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
    /// First difference of the histories; `None` if there is none.
    pub first: Option<FirstDifference>,
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
    let (mut x, mut y) = (History::open(a)?, History::open(b)?);
    watch.begin(x.condition().file_bytes);
    let mut first = None;
    let (mut p, mut q) = (x.moment()?, y.moment()?);
    while first.is_none() {
        watch.at(x.at())?;
        let times = [&p, &q].map(|moment| moment.as_ref().map(|moment| moment.time_ns));
        let Some(now) = times.into_iter().flatten().min() else {
            break;
        };
        let (of_x, of_y) = (take(&mut p, &mut x, now)?, take(&mut q, &mut y, now)?);
        // The last tick of a log that was cut may be incomplete.
        if p.is_none() && x.result.is_empty() || q.is_none() && y.result.is_empty() {
            break;
        }
        first = difference(&x, &y, now, &of_x, &of_y);
    }
    x.finish()?;
    y.finish()?;
    watch.end();
    let has_results = !x.result.is_empty() && !y.result.is_empty();
    Ok(DiffReport {
        same: first.is_none(),
        whole: has_results && x.condition().is_whole() && y.condition().is_whole(),
        scenario: scenario_changes(&x.scenario, &y.scenario),
        first,
        results: if has_results {
            result_changes(&x.result, &y.result)
        } else {
            Vec::new()
        },
        events: event_changes(&x.events, &y.events),
        a: log_facts(&x),
        b: log_facts(&y),
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
    let entry = |key: &str| history.manifest.get(key).cloned().unwrap_or_default();
    LogFacts {
        scenario: entry("scenario"),
        seed: entry("seed"),
        version: entry("version"),
        digest: history.result.get("digest").cloned(),
        condition: history.condition().clone(),
    }
}

/// Returns the differences of all messages of a time (ns); `None` if there are none.
fn difference(
    x: &History,
    y: &History,
    time_ns: u64,
    a: &[Message],
    b: &[Message],
) -> Option<FirstDifference> {
    let (of_a, of_b) = (by_sender(x, a), by_sender(y, b));
    let senders: BTreeSet<&(String, String)> = of_a.keys().chain(of_b.keys()).collect();
    let mut found: Vec<Difference> = Vec::new();
    for sender in senders {
        let of = |all: &BTreeMap<_, Vec<_>>| all.get(sender).cloned().unwrap_or_default();
        let (a, b): (Vec<&Message>, Vec<&Message>) = (of(&of_a), of(&of_b));
        let mut pairs = (0..a.len().max(b.len())).map(|at| (a.get(at), b.get(at)));
        let change = pairs.find_map(|pair| change(x, y, sender, pair));
        found.extend(change);
    }
    if found.is_empty() {
        return None;
    }
    let differing = found.iter().map(|change| change.process.clone()).collect();
    let causes = causes(&x.run, &differing);
    let is_cause = |change: &Difference| causes.contains(&change.process);
    let (mut causes, mut effects): (Vec<_>, Vec<_>) = found.into_iter().partition(is_cause);
    causes.truncate(MAX_DIFFERENCES);
    effects.truncate(MAX_DIFFERENCES);
    Some(FirstDifference {
        time_s: mcap_log::seconds(time_ns),
        causes,
        effects,
    })
}

/// Returns messages by process and topic.
fn by_sender<'m>(
    history: &History,
    messages: &'m [Message],
) -> BTreeMap<(String, String), Vec<&'m Message>> {
    let mut senders: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for message in messages {
        let sender = (
            history.process(message.stamp.source),
            message.topic.name.clone(),
        );
        senders.entry(sender).or_default().push(message);
    }
    senders
}

/// Returns the difference of two messages of a sender with the same position.
fn change(
    x: &History,
    y: &History,
    (process, topic): &(String, String),
    pair: (Option<&&Message>, Option<&&Message>),
) -> Option<Difference> {
    let (tick, field, [a, b], robot) = match pair {
        (Some(a), Some(b)) => {
            let change = first_change(a, b)?;
            (a.stamp.tick, change.field, change.values, change.robot)
        }
        (Some(one), None) => (
            one.stamp.tick,
            String::new(),
            [sent(one), String::new()],
            None,
        ),
        (None, Some(one)) => (
            one.stamp.tick,
            String::new(),
            [String::new(), sent(one)],
            None,
        ),
        (None, None) => return None,
    };
    let mut processes = x.run.processes.iter().chain(&y.run.processes);
    let kind = processes.find(|info| info.name == *process);
    let robot = robot.and_then(|robot| x.run.robots.get(usize::try_from(robot).ok()?));
    Some(Difference {
        tick,
        process: process.clone(),
        kind: kind.map_or_else(String::new, |info| info.kind.clone()),
        topic: topic.clone(),
        robot: robot.map(|robot| robot.name.clone()),
        field,
        a,
        b,
    })
}

fn sent(message: &Message) -> String {
    format!("message {}", message.stamp.sequence)
}
