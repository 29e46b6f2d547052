//! Verdicts on missions: functions of their results alone.

use recorder::EventEntry;
use statistics::{Interval, Mean, Sample, Z95};
use sweep::Row;
use tables::Cell;

use crate::expectation::{Check, ColumnLimit};
use crate::limit::number;
use crate::report::Verdict;

/// Returns what a mission has in place of the expected; `None` if the expectation holds, or is about others.
pub fn of_mission(check: &Check, seed: u64, row: &Row, events: &[EventEntry]) -> Option<String> {
    match check {
        Check::Digest { seed: of, digest } => {
            let hint = if digest.is_empty() {
                " (`--update` writes it)"
            } else {
                ""
            };
            (*of == seed && row.digest != *digest).then(|| format!("{}{hint}", row.digest))
        }
        Check::NoContact => {
            let mut touching = row.robots.iter().filter(|robot| robot.contacts > 0);
            let (first, contacts) = (&touching.next()?.name, row.contacts);
            let others = touching.count();
            Some(format!(
                "{contacts} contacts, of {first} and {others} others"
            ))
        }
        Check::Events(expected) => missing_event(expected, row, events),
        Check::Value(limited) => limited.other(row).map(|cell| match cell {
            Cell::Empty => "no value".to_owned(),
            cell => cell.to_string(),
        }),
        Check::Share { .. } | Check::Mean { .. } => None,
    }
}

/// Returns the first expected event that does not follow those before it.
fn missing_event(expected: &[Vec<String>], row: &Row, events: &[EventEntry]) -> Option<String> {
    let mut rest = events.iter();
    let mut before = String::new();
    for words in expected {
        let Some(event) = rest.find(|event| words.iter().all(|word| has_word(event, word, row)))
        else {
            return Some(format!("no `{}`{before}", words.join(" ")));
        };
        before = format!(" after `{}` at {} s", words.join(" "), event.time_s);
    }
    None
}

fn has_word(event: &EventEntry, word: &str, row: &Row) -> bool {
    // The other one of an event of an obstacle is no robot.
    let other = event
        .other
        .filter(|_| event.kind != "obstacle" && event.kind != "escaped");
    let other = other.and_then(|index| row.robots.get(index as usize));
    event.kind == word
        || event.robot.as_deref() == Some(word)
        || event.obstacle.as_deref() == Some(word)
        || other.is_some_and(|robot| robot.name == word)
}

/// Returns verdict and value of an expectation of several missions; `None` if it is about single ones.
pub fn of_all(check: &Check, rows: &[&Row]) -> Option<(Verdict, String)> {
    let (over, within, value, interval) = match check {
        Check::Share {
            members,
            over,
            within,
        } => {
            let hits = |row: &&Row| {
                let holds =
                    |limits: &&Vec<_>| limits.iter().all(|l: &ColumnLimit| l.other(row).is_none());
                members.iter().filter(holds).count() as u32
            };
            let groups = rows.iter().take(*over);
            let sample: Sample = groups
                .map(|row| (hits(row), members.len() as u32))
                .collect();
            (over, within, sample.share(), sample.interval(Z95))
        }
        Check::Mean {
            value,
            over,
            within,
        } => {
            let values = rows.iter().take(*over);
            let values: Vec<f64> = values.filter_map(|row| number(&value(row))).collect();
            let mean = Mean::from_values(&values);
            let everything = Interval {
                low: f64::NEG_INFINITY,
                high: f64::INFINITY,
            };
            let interval = mean.map_or(everything, |mean| mean.interval());
            (over, within, mean.map(|mean| mean.value), interval)
        }
        _ => return None,
    };
    let verdict = if within.low <= interval.low && interval.high <= within.high {
        Verdict::Pass
    } else if interval.high < within.low || within.high < interval.low {
        Verdict::Fail
    } else {
        Verdict::Inconclusive
    };
    let value = value.map_or_else(|| "no value".to_owned(), |value| format!("{value:.4}"));
    let missions = rows.len().min(*over);
    let (low, high) = (interval.low, interval.high);
    Some((
        verdict,
        format!("{value}, 95 % interval {low:.4} to {high:.4} of {missions} missions"),
    ))
}
