//! Comparison of two simulated histories, moment by moment.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use recorder::RunInfo;
use serde::Serialize;

use crate::cause::causes;
use crate::deviation::{Deviation, add_deviations};
use crate::message::{Message, first_change, is_same};

/// Maximum number of messages that are listed of the first tick with a difference.
const MAX_DIFFERENCES: usize = 64;

/// A message that differs, or that only one of the histories has.
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
    /// First field that differs, e.g. `robots[2].x`; empty if one of the histories lacks the message.
    pub field: String,
    /// Its value in the first history; empty if it has none.
    pub a: String,
    /// Its value in the second history; empty if it has none.
    pub b: String,
}

impl fmt::Display for Difference {
    /// Writes process, topic, field and both values on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}:", self.process, self.topic)?;
        if !self.field.is_empty() {
            write!(f, " {}", self.field)?;
            if let Some(robot) = &self.robot {
                write!(f, " of {robot}")?;
            }
            write!(f, ":")?;
        }
        let [a, b] = [&self.a, &self.b].map(|value| or_none(value));
        write!(f, " {a} → {b}")
    }
}

/// Returns a value, or `none` for an empty one.
pub fn or_none(value: &str) -> &str {
    if value.is_empty() { "none" } else { value }
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

impl FirstDifference {
    /// Returns the tick.
    pub fn tick(&self) -> u64 {
        self.causes.first().map_or(0, |cause| cause.tick)
    }
}

/// Comparison of the messages of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicComparison {
    /// Number of messages in the first history.
    pub a: u64,
    /// Number of messages in the second history.
    pub b: u64,
    /// Number of messages that are equal, except for clocks.
    pub equal: u64,
    /// Number of messages that differ, or that only one of the histories has.
    pub different: u64,
    /// Tick of the first of these; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_tick: Option<u64>,
    /// Deviations by field, if they are requested.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub fields: BTreeMap<String, Deviation>,
}

/// Comparison of two histories, as far as they have been added.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// First difference; absent if there is none.
    pub first: Option<FirstDifference>,
    /// Topics with messages in either history.
    pub topics: BTreeMap<String, TopicComparison>,
    /// Last tick with a message in the first history.
    #[serde(skip)]
    pub last_tick: u64,
    /// `true` to sum up the deviations of fields.
    #[serde(skip)]
    with_fields: bool,
    /// `true` if indices name the same processes in both runs.
    #[serde(skip)]
    has_same_processes: bool,
    /// Processes and robots of both runs.
    #[serde(skip)]
    runs: [RunInfo; 2],
}

impl Comparison {
    /// Creates a comparison of the histories of two runs.
    pub(crate) fn new(runs: [RunInfo; 2]) -> Self {
        let [a, b] = &runs;
        Self {
            has_same_processes: a.processes == b.processes,
            runs,
            ..Self::default()
        }
    }

    /// Creates a comparison of messages of one run with those that its processes send again, with the deviation of
    /// every field.
    pub fn with_fields(run: &RunInfo) -> Self {
        Self {
            with_fields: true,
            ..Self::new([run.clone(), run.clone()])
        }
    }

    /// Returns the number of equal messages.
    pub fn equal(&self) -> u64 {
        self.topics.values().map(|topic| topic.equal).sum()
    }

    /// Returns `true` if no message has been compared.
    pub fn is_empty(&self) -> bool {
        self.equal() == 0 && self.first.is_none()
    }

    /// Adds all messages of one time (ns). A history that `may_lack` messages ends within this time: messages that it
    /// lacks are no differences.
    pub fn add(&mut self, time_ns: u64, a: &[Message], b: &[Message], may_lack: [bool; 2]) {
        let last = a.last().map_or(0, |message| message.stamp.tick);
        self.last_tick = self.last_tick.max(last);
        let is_partial = self.with_fields || may_lack != [false; 2];
        if !is_partial && a.len() == b.len() && self.are_same(a, b) {
            for message in a {
                let topic = self.topic(message);
                topic.a += 1;
                topic.b += 1;
                topic.equal += 1;
            }
            return;
        }
        // A message scheduled for a time after the end is stored at the end of a log.
        let is_due = |message: &&Message| !is_partial || message.stamp.time_ns <= time_ns;
        let mut senders: BTreeMap<(String, &str), [Vec<&Message>; 2]> = BTreeMap::new();
        for (side, messages) in [a, b].into_iter().enumerate() {
            for message in messages.iter().filter(is_due) {
                let name = self
                    .runs
                    .get(side)
                    .map(|run| run.process_name(message.stamp.source));
                let sender = (name.unwrap_or_default(), message.topic.name.as_str());
                let of_sender = senders.entry(sender).or_default();
                if let Some(list) = of_sender.get_mut(side) {
                    list.push(message);
                }
            }
        }
        let mut found = Vec::new();
        for ((process, _), [a, b]) in &senders {
            let mut change = None;
            for at in 0..a.len().max(b.len()) {
                let pair = (a.get(at).copied(), b.get(at).copied());
                let is_ignored = match pair {
                    (None, _) => may_lack[0],
                    (_, None) => may_lack[1],
                    _ => false,
                };
                if !is_ignored && self.pair(pair) && self.first.is_none() && change.is_none() {
                    change = self.difference(process, pair);
                }
            }
            found.extend(change);
        }
        if !found.is_empty() {
            self.first = Some(self.first_difference(time_ns, found));
        }
    }

    /// Counts two messages with the same position, of which one may be missing; returns `true` if they differ.
    fn pair(&mut self, pair: (Option<&Message>, Option<&Message>)) -> bool {
        let ((Some(one), _) | (None, Some(one))) = pair else {
            return false;
        };
        let with_fields = self.with_fields;
        let topic = self.topic(one);
        topic.a += u64::from(pair.0.is_some());
        topic.b += u64::from(pair.1.is_some());
        if let (Some(a), Some(b)) = pair {
            if is_same(a, b) {
                topic.equal += 1;
                return false;
            }
            if with_fields {
                add_deviations(a, b, &mut topic.fields);
            }
        }
        topic.different += 1;
        topic.first_tick.get_or_insert(one.stamp.tick);
        true
    }

    /// Returns the difference of two messages of a process, of which one may be missing.
    fn difference(
        &self,
        process: &str,
        pair: (Option<&Message>, Option<&Message>),
    ) -> Option<Difference> {
        let sent = |message: &Message| format!("message {}", message.stamp.sequence);
        let (one, field, [a, b], robot) = match pair {
            (Some(a), Some(b)) => {
                let change = first_change(a, b);
                (a, change.field, change.values, change.robot)
            }
            (Some(one), None) => (one, String::new(), [sent(one), String::new()], None),
            (None, Some(one)) => (one, String::new(), [String::new(), sent(one)], None),
            (None, None) => return None,
        };
        let mut processes = self.runs.iter().flat_map(|run| &run.processes);
        let kind = processes.find(|info| info.name == *process);
        let robots = self.runs.first().map_or(&[][..], |run| &run.robots);
        let robot = robot.and_then(|robot| robots.get(usize::try_from(robot).ok()?));
        Some(Difference {
            tick: one.stamp.tick,
            process: process.to_owned(),
            kind: kind.map_or_else(String::new, |info| info.kind.clone()),
            topic: one.topic.name.clone(),
            robot: robot.map(|robot| robot.name.clone()),
            field,
            a,
            b,
        })
    }

    /// Separates the causes of the first difference from its effects.
    fn first_difference(&self, time_ns: u64, found: Vec<Difference>) -> FirstDifference {
        let differing: BTreeSet<String> = found.iter().map(|d| d.process.clone()).collect();
        let [run, _] = &self.runs;
        let causes = causes(run, &differing);
        let is_cause = |change: &Difference| causes.contains(&change.process);
        let (mut causes, mut effects): (Vec<_>, Vec<_>) = found.into_iter().partition(is_cause);
        causes.truncate(MAX_DIFFERENCES);
        effects.truncate(MAX_DIFFERENCES);
        FirstDifference {
            time_s: mcap_log::seconds(time_ns),
            causes,
            effects,
        }
    }

    /// Returns `true` if the messages are the same, in the same order, of the same processes.
    fn are_same(&self, a: &[Message], b: &[Message]) -> bool {
        let mut pairs = a.iter().zip(b);
        self.has_same_processes
            && pairs.all(|(a, b)| {
                a.topic.name == b.topic.name && a.stamp.source == b.stamp.source && is_same(a, b)
            })
    }

    fn topic(&mut self, message: &Message) -> &mut TopicComparison {
        self.topics.entry(message.topic.name.clone()).or_default()
    }
}
