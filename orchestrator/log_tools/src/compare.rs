//! Comparison of two simulated histories message by message: that of a log, and that of the repeated run or of some of
//! its processes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;
use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::known::{self, CLOCKS};
use mcap_log::ros2::field_at;
use mcap_log::source::{Logged, Source};
use serde::Serialize;

use super::deviation::{Deviation, add_deviations};

/// The first difference of a topic.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Tick of the message.
    pub tick: u64,
    /// Time of the tick (s).
    pub time_s: f64,
    /// Index of the sender.
    pub source: u32,
    /// Field, e.g. `robots[2].x`; empty if one of the histories lacks the message.
    pub field: String,
    /// Value in the log; empty if absent.
    pub logged: String,
    /// Value in the new run; empty if absent.
    pub again: String,
    /// Number of messages of the topic that differ, are missing or are extra.
    pub messages: u64,
}

/// Comparison of the messages of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicComparison {
    /// Number of messages in the log.
    pub recorded: u64,
    /// Number of messages in the new run.
    pub now: u64,
    /// Number of equal messages, except for clocks.
    pub equal: u64,
    /// First difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<Difference>,
    /// Deviations by field, if only some processes are compared.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub fields: BTreeMap<String, Deviation>,
}

/// Comparison of two histories.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Topics with messages in either history.
    pub topics: BTreeMap<&'static str, TopicComparison>,
    /// Last tick with a message in the log.
    #[serde(skip)]
    pub last_tick: u64,
    /// `true` if a log may end before its run: messages scheduled for a time after its end are not compared.
    #[serde(skip)]
    cut: bool,
    /// Senders whose messages are compared; `None` for all.
    #[serde(skip)]
    sources: Option<BTreeSet<u32>>,
}

/// A message of the simulated history.
#[derive(Clone, Copy)]
struct SimulatedMessage<'a> {
    /// Log time (ns).
    time: u64,
    stamp: Stamp,
    data: &'a [u8],
}

impl Comparison {
    /// Creates a comparison of the messages of these processes.
    pub fn of(sources: BTreeSet<u32>) -> Self {
        Self {
            sources: Some(sources),
            cut: true,
            ..Self::default()
        }
    }

    /// Returns the number of equal messages.
    pub fn equal(&self) -> u64 {
        self.topics.values().map(|topic| topic.equal).sum()
    }

    /// Returns the number of messages in the log.
    pub fn recorded(&self) -> u64 {
        self.topics.values().map(|topic| topic.recorded).sum()
    }

    /// Returns `true` if no message has been compared.
    pub fn is_empty(&self) -> bool {
        self.topics
            .values()
            .all(|topic| topic.equal == 0 && topic.first.is_none())
    }

    /// Returns the first difference of every topic that has one.
    pub fn differences(&self) -> impl Iterator<Item = (&'static str, &Difference)> {
        let topics = self.topics.iter();
        topics.filter_map(|(topic, found)| Some((*topic, found.first.as_ref()?)))
    }

    /// Returns the earliest difference.
    pub fn first(&self) -> Option<(&'static str, &Difference)> {
        // Of several topics at one tick, the world comes last: it depends on the others.
        self.differences()
            .min_by_key(|(topic, d)| (d.tick, topic.starts_with("world/")))
    }

    /// Adds all messages of one time. With `may_lack` the log ends within this time, so that messages missing in it are
    /// not differences.
    pub fn add(&mut self, logged: &[Logged], again: &[Logged], may_lack: bool) {
        let (logged, again) = (self.history(logged), self.history(again));
        let keys: BTreeSet<_> = logged.keys().chain(again.keys()).copied().collect();
        for key in keys {
            let Some(id) = TopicId::all().nth(key.0) else {
                continue;
            };
            let of = |history: &BTreeMap<_, Vec<_>>| history.get(&key).cloned().unwrap_or_default();
            let (logged, again): (Vec<SimulatedMessage<'_>>, Vec<_>) = (of(&logged), of(&again));
            let last = logged.last().map_or(0, |message| message.stamp.tick);
            self.last_tick = self.last_tick.max(last);
            let topic = self.topics.entry(id.name()).or_default();
            topic.recorded += logged.len() as u64;
            topic.now += again.len() as u64;
            let with_fields = self.sources.is_some();
            for at in 0..logged.len().max(again.len()) {
                match (logged.get(at), again.get(at)) {
                    (None, Some(_)) if may_lack => {}
                    (logged, again) => topic.add(id, logged, again, with_fields),
                }
            }
        }
    }

    /// Returns the compared messages by topic and sender.
    fn history<'m>(
        &self,
        messages: &'m [Logged],
    ) -> BTreeMap<(usize, u32), Vec<SimulatedMessage<'m>>> {
        let mut history: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for message in messages {
            let (time, data) = (message.time, message.data.as_slice());
            let topic = TopicId::all().nth(message.rank);
            let is_simulated = topic.is_some_and(|topic| topic.facts().simulated);
            let Some(stamp) = known::stamp(data).filter(|_| is_simulated) else {
                continue;
            };
            let mut sources = self.sources.iter();
            let is_wanted = sources.all(|sources| sources.contains(&stamp.source));
            // A message scheduled for a time after the end is stored at the end of a log.
            if is_wanted && (!self.cut || stamp.time_ns <= time) {
                let of_sender = history.entry((message.rank, stamp.source)).or_default();
                of_sender.push(SimulatedMessage { time, stamp, data });
            }
        }
        history
    }
}

impl TopicComparison {
    /// Adds two messages with the same position; one of them may be missing.
    fn add(
        &mut self,
        topic: TopicId,
        logged: Option<&SimulatedMessage<'_>>,
        again: Option<&SimulatedMessage<'_>>,
        with_fields: bool,
    ) {
        let Some(SimulatedMessage { stamp, time, .. }) = logged.or(again).copied() else {
            return;
        };
        let at = match (logged, again) {
            (Some(x), Some(y)) => {
                let Some(at) = first_difference(x.data, y.data) else {
                    self.equal += 1;
                    return;
                };
                if let Some(schema) = known::layout(topic).schema.as_ref().filter(|_| with_fields) {
                    // A message that does not fit the schema has no fields, but still counts as different.
                    let _ = add_deviations(schema, stamp.tick, x.data, y.data, &mut self.fields);
                }
                Some(at)
            }
            _ => None,
        };
        if let Some(first) = &mut self.first {
            first.messages += 1;
            return;
        }
        // Name and value of the field.
        let value = |message: Option<&SimulatedMessage<'_>>| match (message, at) {
            (None, _) => None,
            (Some(message), None) => {
                let number = format!("message {}", message.stamp.sequence);
                Some((String::new(), number))
            }
            (Some(message), Some(at)) => {
                let schema = known::layout(topic).schema.as_ref()?;
                let found = field_at(schema, message.data, at);
                let (name, cell) = found.ok()??;
                Some((name, cell.to_string()))
            }
        };
        let (logged, again) = (value(logged), value(again));
        let name = logged.as_ref().or(again.as_ref()).map(|(name, _)| name);
        let field = match at {
            Some(at) => name.cloned().unwrap_or_else(|| format!("byte {at}")),
            None => String::new(),
        };
        let text =
            |value: Option<(String, String)>| value.map_or_else(String::new, |(_, text)| text);
        self.first = Some(Difference {
            tick: stamp.tick,
            time_s: mcap_log::seconds(time),
            source: stamp.source,
            field,
            logged: text(logged),
            again: text(again),
            messages: 1,
        });
    }
}

/// Compares the simulated history in a log with that of the same run, repeated, up to log time `before` (ns). If the
/// log does not reach the end of its run (`cut`), only its part is compared.
///
/// # Errors
/// [`LogReadError`] if a log is unreadable or its times are not in order.
pub fn compare(
    log: &Path,
    again: &Path,
    before: u64,
    cut: bool,
    watch: &mut ReadProgress,
) -> Result<Comparison, LogReadError> {
    let open = |path: &Path, watch: &mut ReadProgress| {
        let mut source = Source::open(path, &Topics::default(), before, false)?;
        source.seek(0, watch)?;
        Ok::<_, LogReadError>(source)
    };
    let (mut a, mut b) = (open(log, watch)?, open(again, watch)?);
    watch.begin(a.length());
    let mut comparison = Comparison {
        cut,
        ..Comparison::default()
    };
    let (mut x, mut y) = (next(&mut a, 0)?, next(&mut b, 0)?);
    loop {
        watch.at(a.at())?;
        let time = match (x.first(), y.first()) {
            (Some(x), Some(y)) => x.time.min(y.time),
            (Some(one), None) => one.time,
            (None, Some(one)) if !cut => one.time,
            (None, _) => break,
        };
        let (mut logged, mut again) = (Vec::new(), Vec::new());
        for (from, to, source) in [(&mut x, &mut logged, &mut a), (&mut y, &mut again, &mut b)] {
            if from.first().is_some_and(|first| first.time == time) {
                *to = std::mem::replace(from, next(source, time)?);
            }
        }
        // The last tick of a log that was cut may be incomplete.
        comparison.add(&logged, &again, cut && x.is_empty());
    }
    watch.end();
    Ok(comparison)
}

/// Returns all messages of the next time, which must not precede `time`; none at the end.
fn next(source: &mut Source, time: u64) -> Result<Vec<Logged>, LogReadError> {
    let mut messages = Vec::new();
    source.tick(&mut messages)?;
    if messages.first().is_some_and(|first| first.time < time) {
        return Err(LogReadError::NotRepeatable {
            path: source.path().to_owned(),
            reason: "its messages are not in order of time".to_owned(),
        });
    }
    Ok(messages)
}

/// Returns the first byte in which two messages differ, except for clocks.
fn first_difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let differ = a
        .iter()
        .zip(b)
        .enumerate()
        .position(|(at, (x, y))| x != y && !CLOCKS.contains(&at));
    differ.or_else(|| (a.len() != b.len()).then(|| a.len().min(b.len())))
}
