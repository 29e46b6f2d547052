//! Two simulated histories of a run, message by message: that in a log, and that of the run, or of some
//! of its processes, done again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;
use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::known;
use mcap_log::ros2::field_at;
use mcap_log::source::{Logged, Source};
use serde::Serialize;

use super::deviation::{CLOCKS, Deviation, add_deviations};

/// The first difference of a topic.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Tick of the message.
    pub tick: u64,
    /// Time of the tick (s).
    pub time_s: f64,
    /// Index of the process that sent it.
    pub source: u32,
    /// The field, e.g. `robots[2].x`; empty if one of the histories has no such message.
    pub field: String,
    /// Its value in the log; empty if there is none.
    pub logged: String,
    /// Its value now; empty if there is none.
    pub again: String,
    /// How many messages of the topic differ, are missing or are too many.
    pub messages: u64,
}

/// How the messages of a topic compare.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicComparison {
    /// Messages in the log.
    pub recorded: u64,
    /// Messages now.
    pub now: u64,
    /// Messages that are the same, clocks apart.
    pub equal: u64,
    /// The first difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<Difference>,
    /// By how much fields differ, if only some processes are compared.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub fields: BTreeMap<String, Deviation>,
}

/// How two histories compare.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// The topics on which something was message, then or now.
    pub topics: BTreeMap<&'static str, TopicComparison>,
    /// Last tick of which the log has a message.
    #[serde(skip)]
    pub last_tick: u64,
    /// Whose messages are compared; everybody's if not message.
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
    /// A comparison of what these processes say.
    pub fn of(sources: BTreeSet<u32>) -> Self {
        Self {
            sources: Some(sources),
            ..Self::default()
        }
    }

    /// Messages that are the same.
    pub fn equal(&self) -> u64 {
        self.topics.values().map(|topic| topic.equal).sum()
    }

    /// The first difference of every topic that has one.
    pub fn differences(&self) -> impl Iterator<Item = (&'static str, &Difference)> {
        let topics = self.topics.iter();
        topics.filter_map(|(topic, found)| Some((*topic, found.first.as_ref()?)))
    }

    /// Where the two part: the earliest difference.
    pub fn first(&self) -> Option<(&'static str, &Difference)> {
        // Of several at one tick the world's comes last: it is what it was told.
        self.differences()
            .min_by_key(|(topic, d)| (d.tick, topic.starts_with("world/")))
    }

    /// Takes up all messages of one time; with `may_lack` the log ends within it, so that what only the
    /// other has is no difference.
    pub fn add(&mut self, logged: &[Logged], again: &[Logged], may_lack: bool) {
        let (logged, again) = (self.history(logged), self.history(again));
        let keys: BTreeSet<_> = logged.keys().chain(again.keys()).copied().collect();
        for key in keys {
            let Some(&id) = TopicId::ALL.get(key.0) else {
                continue;
            };
            let of = |message: &BTreeMap<_, Vec<_>>| message.get(&key).cloned().unwrap_or_default();
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

    /// Those of these messages that are compared, by topic and sender.
    fn history<'m>(
        &self,
        messages: &'m [Logged],
    ) -> BTreeMap<(usize, u32), Vec<SimulatedMessage<'m>>> {
        let mut history: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for message in messages {
            let (time, data) = (message.time, message.data.as_slice());
            let topic = TopicId::ALL.get(message.rank);
            let is_simulated = topic.is_some_and(|topic| topic.facts().simulated);
            let Some(stamp) = known::stamp(data).filter(|_| is_simulated) else {
                continue;
            };
            let mut sources = self.sources.iter();
            let is_wanted = sources.all(|sources| sources.contains(&stamp.source));
            // What was announced for a time that never came is kept in a log at its end.
            if is_wanted && stamp.time_ns <= time {
                let of_sender = history.entry((message.rank, stamp.source)).or_default();
                of_sender.push(SimulatedMessage { time, stamp, data });
            }
        }
        history
    }
}

impl TopicComparison {
    /// Takes up two messages that take the same place; one of them may be missing.
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
                    // What is not of the schema has no fields; that it differs is told all the same.
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
        // The field in question, and its value.
        let value = |message: Option<&SimulatedMessage<'_>>| match (message, at) {
            (None, _) => None,
            (Some(message), None) => {
                let number = format!("message {}", message.stamp.sequence);
                Some((String::new(), number))
            }
            (Some(message), Some(at)) => {
                let found = field_at(
                    &known::layout(topic).schema.as_ref()?.fields,
                    message.data,
                    at,
                );
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

/// Compares the simulated history in a log with that of the same run done again, up to log time `before`
/// (ns). Of a log that does not reach to the end of its run (`cut`), what is there is compared.
///
/// # Errors
/// [`LogReadError`]: one of them cannot be read, or goes back in time.
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
    let mut comparison = Comparison::default();
    let (mut x, mut y) = (next(&mut a, 0)?, next(&mut b, 0)?);
    loop {
        watch.at(a.at())?;
        let time = match (x.first(), y.first()) {
            (Some(x), Some(y)) => x.time.min(y.time),
            (Some(one), None) => one.time,
            (None, Some(one)) if !cut => one.time,
            (None, _) => break,
        };
        let (mut logged, mut message) = (Vec::new(), Vec::new());
        for (from, to, source) in [
            (&mut x, &mut logged, &mut a),
            (&mut y, &mut message, &mut b),
        ] {
            if from.first().is_some_and(|first| first.time == time) {
                *to = std::mem::replace(from, next(source, time)?);
            }
        }
        // The last tick of a log that was cut may be incomplete.
        comparison.add(&logged, &message, cut && x.is_empty());
    }
    watch.end();
    Ok(comparison)
}

/// Everything of the next time, which is not before this one; nothing at the end.
fn next(source: &mut Source, time: u64) -> Result<Vec<Logged>, LogReadError> {
    let mut messages = Vec::new();
    source.tick(&mut messages)?;
    if messages.first().is_some_and(|first| first.time < time) {
        return Err(LogReadError::NotRepeatable {
            path: source.path().to_owned(),
            reason: "its messages are not in the order of their times".to_owned(),
        });
    }
    Ok(messages)
}

/// The first byte in which two messages differ, clocks apart.
fn first_difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let differ = a
        .iter()
        .zip(b)
        .enumerate()
        .position(|(at, (x, y))| x != y && !CLOCKS.contains(&at));
    differ.or_else(|| (a.len() != b.len()).then(|| a.len().min(b.len())))
}
