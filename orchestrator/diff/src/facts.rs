//! Keys of scenarios, results and events that differ.

use std::collections::{BTreeMap, BTreeSet};

use recorder::EventEntry;
use serde::Serialize;
use serde_json::Value as Json;

/// A value that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ValueChange {
    /// Its path, e.g. `teams.police.limits.v_max`.
    pub key: String,
    /// Value of the first log; `None` if it has none.
    pub a: Option<String>,
    /// Value of the second log; `None` if it has none.
    pub b: Option<String>,
}

/// An event that only one of the logs has, or that both have at different times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EventChange {
    /// The event in words.
    pub event: String,
    /// Time in the first log (s); `None` if it has none.
    pub a_s: Option<f64>,
    /// Time in the second log (s); `None` if it has none.
    pub b_s: Option<f64>,
}

/// Returns the keys of two scenarios in TOML that differ.
pub fn scenario_changes(a: &str, b: &str) -> Vec<ValueChange> {
    let [a, b] = [a, b].map(|text| flat(&toml::from_str(text).unwrap_or_default()));
    let mut changes = changes(&a, &b);
    // What a log contains does not change the history.
    changes.retain(|change| !change.key.starts_with("log."));
    changes
}

/// Returns the entries of two results that differ, without measured times and digests.
pub fn result_changes(
    a: &BTreeMap<String, String>,
    b: &BTreeMap<String, String>,
) -> Vec<ValueChange> {
    let [a, b] = [a, b].map(|entries| {
        let entries = entries
            .iter()
            .filter(|(key, _)| !matches!(key.as_str(), "latency_us" | "digest" | "run_digest"));
        let values = entries.map(|(key, text)| {
            let value = serde_json::from_str(text);
            (
                key.clone(),
                value.unwrap_or_else(|_| Json::String(text.clone())),
            )
        });
        flat(&Json::Object(values.collect()))
    });
    changes(&a, &b)
}

fn changes(a: &BTreeMap<String, String>, b: &BTreeMap<String, String>) -> Vec<ValueChange> {
    let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let changed = keys.into_iter().filter(|key| a.get(*key) != b.get(*key));
    changed
        .map(|key| ValueChange {
            key: key.clone(),
            a: a.get(key).cloned(),
            b: b.get(key).cloned(),
        })
        .collect()
}

/// Returns all values by path. Elements with a name have it in their path, others their index.
fn flat(value: &Json) -> BTreeMap<String, String> {
    fn add(path: &str, value: &Json, values: &mut BTreeMap<String, String>) {
        let below = |key: &str| match path {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        };
        match value {
            Json::Object(entries) => {
                for (key, value) in entries {
                    add(&below(key), value, values);
                }
            }
            Json::Array(elements) if elements.iter().any(Json::is_object) => {
                for (index, element) in elements.iter().enumerate() {
                    let name = element.get("name").and_then(Json::as_str);
                    let key = name.map_or_else(|| index.to_string(), str::to_owned);
                    add(&below(&key), element, values);
                }
            }
            Json::String(text) => drop(values.insert(path.to_owned(), text.clone())),
            other => drop(values.insert(path.to_owned(), other.to_string())),
        }
    }
    let mut values = BTreeMap::new();
    add("", value, &mut values);
    values
}

/// Returns the events that differ, the n-th of a kind and robot compared with the n-th of the other log.
pub fn event_changes(a: &[EventEntry], b: &[EventEntry]) -> Vec<EventChange> {
    let times = |events: &[EventEntry]| {
        let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for event in events {
            times.entry(words(event)).or_default().push(event.time_s);
        }
        times
    };
    let (a, b) = (times(a), times(b));
    let events: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let mut changes = Vec::new();
    for event in events {
        let of = |times: &BTreeMap<String, Vec<f64>>| times.get(event).cloned().unwrap_or_default();
        let (a, b) = (of(&a), of(&b));
        for at in 0..a.len().max(b.len()) {
            let (a_s, b_s) = (a.get(at).copied(), b.get(at).copied());
            if a_s != b_s {
                changes.push(EventChange {
                    event: event.clone(),
                    a_s,
                    b_s,
                });
            }
        }
    }
    let time = |change: &EventChange| {
        let times = [change.a_s, change.b_s].into_iter().flatten();
        times.fold(f64::INFINITY, f64::min)
    };
    changes.sort_by(|x, y| time(x).total_cmp(&time(y)));
    changes
}

/// Returns kind, robot and obstacle or other robot of an event.
fn words(event: &EventEntry) -> String {
    let other = event.other.map(|other| other.to_string());
    let words = [
        Some(&event.kind),
        event.robot.as_ref(),
        event.obstacle.as_ref().or(other.as_ref()),
    ];
    let words: Vec<&str> = words.into_iter().flatten().map(String::as_str).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_the_names_of_their_elements() {
        let a = "title = \"x\"\n[[robots]]\nname = \"r\"\nstart = [1.0, 2.0]\n[run]\nseed = 1\n";
        let b = "title = \"x\"\n[[robots]]\nname = \"r\"\nstart = [1.0, 3.0]\n[run]\n";
        let changes = scenario_changes(a, b);
        let change = |key: &str, a: &str, b: Option<&str>| ValueChange {
            key: key.to_owned(),
            a: Some(a.to_owned()),
            b: b.map(str::to_owned),
        };
        let expected = [
            change("robots.r.start", "[1.0,2.0]", Some("[1.0,3.0]")),
            change("run.seed", "1", None),
        ];
        assert_eq!(changes, expected);
    }

    #[test]
    fn the_nth_event_of_a_robot_is_compared_with_the_nth() {
        let event = |time_s: f64, kind: &str, robot: &str| EventEntry {
            time_s,
            kind: kind.to_owned(),
            robot: Some(robot.to_owned()),
            obstacle: None,
            other: None,
            x: 0.0,
            y: 0.0,
            value: 0.0,
        };
        let a = [event(1.0, "contact", "r"), event(2.0, "contact", "r")];
        let b = [event(1.0, "contact", "r"), event(1.5, "escaped", "s")];
        let changes = event_changes(&a, &b);
        let found: Vec<_> = changes.iter().map(|c| (&*c.event, c.a_s, c.b_s)).collect();
        let expected = [
            ("escaped s", None, Some(1.5)),
            ("contact r", Some(2.0), None),
        ];
        assert_eq!(found, expected);
    }
}
