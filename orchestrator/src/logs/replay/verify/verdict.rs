//! What a test finds: the same, or where it parts and by how much.

use std::collections::BTreeMap;

use serde::Serialize;

use super::super::super::compare::{Difference, first_difference};
use super::super::super::failures::Left;
use super::super::super::ros2::{Cell, field_at};
use super::super::super::seconds;
use super::super::deviation::Deviation;
use super::super::ears::{Ear, Said};
use super::trial::Moment;

/// How a topic compares.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicVerdict {
    /// Messages in the log.
    pub recorded: u64,
    /// Messages now.
    pub now: u64,
    /// Messages that are the same, clocks apart.
    pub equal: u64,
    /// The first difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<Difference>,
    /// By how much fields differ.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub fields: BTreeMap<String, Deviation>,
}

/// How the processes compare with themselves in the log.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Verified {
    /// The scenario.
    pub scenario: String,
    /// The processes under test.
    pub processes: Vec<String>,
    /// Those that were started too, because what they answer is in no log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub helpers: Vec<String>,
    /// The version that recorded the log, if it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// What was changed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// Ticks that were done.
    pub ticks: u64,
    /// Whether every message is the same.
    pub identical: bool,
    /// Whether the log holds all that was asked for.
    pub whole: bool,
    /// The first of them that failed in the run of the log: only what was said before is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Left>,
    /// The topics on which they spoke, then or now.
    pub topics: BTreeMap<String, TopicVerdict>,
    /// Real time from the first tick to the last [s].
    pub wall_time_s: f64,
    /// What was wrong with the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

impl Verified {
    /// The earliest difference, and its topic.
    pub fn first(&self) -> Option<(&String, &Difference)> {
        let topics = self.topics.iter();
        topics
            .filter_map(|(topic, verdict)| Some((topic, verdict.first.as_ref()?)))
            .min_by_key(|(_, first)| first.tick)
    }
}

impl TopicVerdict {
    /// Takes up what was said then and what is said now in its place; one of them may be missing.
    pub(super) fn compare(
        &mut self,
        ear: &Ear,
        moment: &Moment,
        then: Option<&Said>,
        now: Option<&Said>,
    ) {
        let mut field = String::new();
        let sequence = |said: Option<&Said>| {
            said.map_or_else(String::new, |said| {
                format!("message {}", said.stamp.sequence)
            })
        };
        let (mut logged, mut again) = (sequence(then), sequence(now));
        if let (Some(a), Some(b)) = (then, now) {
            let Some(at) = first_difference(&a.data, &b.data) else {
                self.equal += 1;
                return;
            };
            ear.numbers
                .compare(moment.tick, &a.data, &b.data, &mut self.fields);
            let value = |data: &[u8]| -> Option<(String, Cell)> {
                field_at(&ear.schema.as_ref()?.fields, data, at)
                    .ok()
                    .flatten()
            };
            let (x, y) = (value(&a.data), value(&b.data));
            let name = x.as_ref().or(y.as_ref()).map(|(name, _)| name.clone());
            field = name.unwrap_or_else(|| format!("byte {at}"));
            let text = |value: Option<(String, Cell)>| {
                value.map(|(_, cell)| cell.to_string()).unwrap_or_default()
            };
            (logged, again) = (text(x), text(y));
        }
        match &mut self.first {
            Some(first) => first.messages += 1,
            none => {
                let stamp = then.or(now).map(|said| said.stamp).unwrap_or_default();
                *none = Some(Difference {
                    tick: moment.tick,
                    time_s: seconds(moment.time),
                    source: stamp.source,
                    field,
                    logged,
                    again,
                    messages: 1,
                });
            }
        }
    }
}
