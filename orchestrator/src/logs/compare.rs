//! Two logs of the same run, message by message.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::rc::Rc;

use ipc_types::stamp::Stamp;
use serde::Serialize;

use super::error::LogsError;
use super::known::{self, ENCAPSULATION};
use super::reader::{Channel, Item, Reader};
use super::ros2::{Schema, field_at};
use super::watch::Watch;

/// Most bytes that the messages of one time may take.
pub(super) const TICK_LIMIT: usize = 512 << 20;
/// The clocks of the stamp, in the bytes of a message.
const CLOCKS: Range<usize> =
    ENCAPSULATION + Stamp::SIMULATED_BYTES..ENCAPSULATION + size_of::<Stamp>();

/// The first difference of a topic.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Tick of the message.
    pub tick: u64,
    /// Time of the tick [s].
    pub time_s: f64,
    /// Index of the process that sent it.
    pub source: u32,
    /// The field, e.g. `robots[2].x`; empty if one of the logs has no such message.
    pub field: String,
    /// Its value in the log; empty if there is none.
    pub logged: String,
    /// Its value in the other; empty if there is none.
    pub again: String,
    /// How many messages of the topic differ, are missing or are too many.
    pub messages: u64,
}

/// How two logs compare.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Messages of the simulated history that are equal in both.
    pub equal: u64,
    /// The first difference of every topic that has one.
    pub differences: BTreeMap<String, Difference>,
    /// Last tick of which the log has a message.
    pub last_tick: u64,
}

impl Comparison {
    /// Where the two part: the earliest difference.
    pub fn first(&self) -> Option<(&String, &Difference)> {
        // Of several at one tick the world's comes last: it is what it was told.
        self.differences
            .iter()
            .min_by_key(|(topic, d)| (d.tick, topic.starts_with("world/")))
    }

    /// Forgets what differs from tick `tick` on.
    pub(super) fn keep_before(&mut self, tick: u64) {
        self.differences.retain(|_, first| first.tick < tick);
        self.last_tick = self.last_tick.min(tick.saturating_sub(1));
    }

    fn differ(&mut self, topic: &str, found: impl FnOnce() -> Difference) {
        match self.differences.get_mut(topic) {
            Some(known) => known.messages += 1,
            None => {
                self.differences.insert(topic.to_owned(), found());
            }
        }
    }
}

/// A message of the simulated history.
struct Said {
    stamp: Stamp,
    data: Vec<u8>,
}

/// What was said at one time, by topic and source.
struct Tick {
    time: u64,
    said: BTreeMap<(String, u32), Vec<Said>>,
}

/// Reads the simulated history of a log by time.
struct History<'w> {
    reader: Reader<'w>,
    channels: BTreeMap<u16, Rc<Channel>>,
    schemas: BTreeMap<String, Schema>,
    /// The first message of the next time.
    ahead: Option<(u64, String, Said)>,
    ended: bool,
}

impl<'w> History<'w> {
    fn open(log: &Path, watch: Option<&'w mut Watch>) -> Result<Self, LogsError> {
        Ok(Self {
            reader: Reader::open(log, watch)?,
            channels: BTreeMap::new(),
            schemas: BTreeMap::new(),
            ahead: None,
            ended: false,
        })
    }

    /// The next message: log time, topic, what it says.
    fn next(&mut self) -> Result<Option<(u64, String, Said)>, LogsError> {
        loop {
            match self.reader.next()? {
                None => return Ok(None),
                Some(Item::Channel(channel)) => {
                    if known::is_stamped(&channel)
                        && known::find(&channel.topic).is_some_and(|known| known.simulated)
                    {
                        let schema = self.reader.schema(channel.schema_id);
                        if let Some(Ok(schema)) = schema.map(|s| Schema::parse(&s.data)) {
                            self.schemas.insert(channel.topic.clone(), schema);
                        }
                        self.channels.insert(channel.id, channel);
                    }
                }
                Some(Item::Message(header, data)) => {
                    let Some(channel) = self.channels.get(&header.channel_id) else {
                        continue;
                    };
                    // Announced for a time that never came: kept in the log at its end.
                    if header.publish_time > header.log_time {
                        continue;
                    }
                    if let Some(stamp) = known::stamp(data) {
                        let data = data.to_vec();
                        let topic = channel.topic.clone();
                        return Ok(Some((header.log_time, topic, Said { stamp, data })));
                    }
                }
                Some(_) => {}
            }
        }
    }

    /// Everything that was said at the next time.
    fn tick(&mut self) -> Result<Option<Tick>, LogsError> {
        if self.ended {
            return Ok(None);
        }
        let first = match self.ahead.take() {
            Some(first) => Some(first),
            None => self.next()?,
        };
        let Some((time, topic, said)) = first else {
            self.ended = true;
            return Ok(None);
        };
        let mut tick = Tick {
            time,
            said: BTreeMap::new(),
        };
        let mut bytes = said.data.len();
        tick.said.insert((topic, said.stamp.source), vec![said]);
        loop {
            match self.next()? {
                Some((at, topic, said)) if at == time => {
                    bytes += said.data.len();
                    if bytes > TICK_LIMIT {
                        return Err(LogsError::TooLarge {
                            path: self.reader.path().to_owned(),
                            what: "the messages of one tick",
                            limit: TICK_LIMIT,
                        });
                    }
                    let key = (topic, said.stamp.source);
                    tick.said.entry(key).or_default().push(said);
                }
                Some((at, ..)) if at < time => {
                    return Err(LogsError::NotRepeatable {
                        path: self.reader.path().to_owned(),
                        reason: "its messages are not in the order of their times".to_owned(),
                    });
                }
                ahead => {
                    self.ended = ahead.is_none();
                    self.ahead = ahead;
                    return Ok(Some(tick));
                }
            }
        }
    }
}

/// Compares the simulated history in a log with that of the same run done again. Of a log that
/// does not reach to the end of its run (`cut`), what is there is compared.
pub(super) fn compare(
    log: &Path,
    again: &Path,
    cut: bool,
    watch: &mut Watch,
) -> Result<Comparison, LogsError> {
    let mut a = History::open(log, Some(watch))?;
    let mut b = History::open(again, None)?;
    let mut comparison = Comparison::default();
    let (mut left, mut right) = (a.tick()?, b.tick()?);
    loop {
        match (&left, &right) {
            (None, None) => return Ok(comparison),
            (None, Some(_)) if cut => return Ok(comparison),
            (Some(x), Some(y)) if x.time == y.time => {
                // The last tick of a log that was cut may be incomplete.
                let may_lack = cut && a.ahead.is_none() && a.ended;
                compare_ticks(x, y, may_lack, &a.schemas, &mut comparison);
                (left, right) = (a.tick()?, b.tick()?);
            }
            (Some(x), y) if y.as_ref().is_none_or(|y| x.time < y.time) => {
                compare_ticks(x, &nothing(x.time), false, &a.schemas, &mut comparison);
                left = a.tick()?;
            }
            (_, Some(y)) => {
                compare_ticks(&nothing(y.time), y, false, &a.schemas, &mut comparison);
                right = b.tick()?;
            }
            (Some(_), None) => left = a.tick()?,
        }
    }
}

fn nothing(time: u64) -> Tick {
    Tick {
        time,
        said: BTreeMap::new(),
    }
}

fn compare_ticks(
    a: &Tick,
    b: &Tick,
    may_lack: bool,
    schemas: &BTreeMap<String, Schema>,
    comparison: &mut Comparison,
) {
    let time_s = super::seconds(a.time);
    let one_sided = |said: &Said, logged: bool| {
        let there = || format!("message {}", said.stamp.sequence);
        Difference {
            tick: said.stamp.tick,
            time_s,
            source: said.stamp.source,
            field: String::new(),
            logged: if logged { there() } else { String::new() },
            again: if logged { String::new() } else { there() },
            messages: 1,
        }
    };
    for (key, said) in &a.said {
        let others = b.said.get(key).map_or(&[][..], Vec::as_slice);
        for (index, x) in said.iter().enumerate() {
            comparison.last_tick = comparison.last_tick.max(x.stamp.tick);
            let Some(y) = others.get(index) else {
                comparison.differ(&key.0, || one_sided(x, true));
                continue;
            };
            match first_difference(&x.data, &y.data) {
                None => comparison.equal += 1,
                Some(at) => comparison.differ(&key.0, || {
                    let schema = schemas.get(&key.0);
                    let value = |data: &[u8]| {
                        let found = schema.map(|schema| field_at(&schema.fields, data, at));
                        found.and_then(Result::ok).flatten()
                    };
                    let (logged, again) = (value(&x.data), value(&y.data));
                    let field = logged
                        .as_ref()
                        .or(again.as_ref())
                        .map(|(name, _)| name.clone());
                    let text = |value: Option<(String, super::ros2::Cell)>| {
                        value.map(|(_, cell)| cell.to_string()).unwrap_or_default()
                    };
                    Difference {
                        tick: x.stamp.tick,
                        time_s,
                        source: x.stamp.source,
                        field: field.unwrap_or_else(|| format!("byte {at}")),
                        logged: text(logged),
                        again: text(again),
                        messages: 1,
                    }
                }),
            }
        }
    }
    if may_lack {
        return;
    }
    for (key, said) in &b.said {
        let known = a.said.get(key).map_or(0, Vec::len);
        for y in said.iter().skip(known) {
            comparison.differ(&key.0, || one_sided(y, false));
        }
    }
}

/// The first byte in which two messages differ, clocks apart.
pub(super) fn first_difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let differ = a
        .iter()
        .zip(b)
        .enumerate()
        .position(|(at, (x, y))| x != y && !CLOCKS.contains(&at));
    differ.or_else(|| (a.len() != b.len()).then(|| a.len().min(b.len())))
}
