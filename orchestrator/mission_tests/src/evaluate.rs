//! Verdicts on missions: functions of their results alone.

use recorder::{EventEntry, RobotOutcome};
use statistics::{Interval, Mean, Sample, Z95};
use sweep::{Part, Row};
use tables::Cell;

use crate::expectation::{Check, Limited, ShareOf};
use crate::limit::number;
use crate::report::Verdict;

/// Returns what a mission has in place of the expected; `None` if the expectation holds, or is about others.
pub(crate) fn of_mission(
    check: &Check,
    seed: u64,
    row: &Row,
    events: &[EventEntry],
) -> Option<String> {
    let robot = |name: &str| row.robots.iter().find(|robot| robot.name == name);
    let unless = |holds: bool, found: String| (!holds).then_some(found);
    match check {
        Check::Digest { seed: of, digest } => {
            let hint = if digest.is_empty() {
                " (`--update` writes it)"
            } else {
                ""
            };
            let found = format!("{}{hint}", row.digest);
            unless(*of != seed || row.digest == *digest, found)
        }
        Check::Outcome(outcome) => {
            let found = row.outcome.name();
            unless(found == outcome, found.to_owned())
        }
        Check::RobotOutcome {
            robot: name,
            outcome,
        } => {
            let found = robot(name).map_or("no such robot", |robot| robot.outcome.as_str());
            unless(found == outcome, found.to_owned())
        }
        Check::NoContact => {
            let mut touching = row.robots.iter().filter(|robot| robot.contacts > 0);
            let first = touching.next()?;
            Some(format!(
                "{} contacts, of {} and {} others",
                row.contacts,
                first.name,
                touching.count()
            ))
        }
        Check::Events(expected) => missing_event(expected, row, events),
        Check::Column(column) => column_value(column, row),
        Check::RobotColumn {
            robot: name,
            column,
        } => match robot(name) {
            Some(robot) => column_value::<RobotOutcome>(column, robot),
            None => Some("no such robot".to_owned()),
        },
        Check::Share { .. } | Check::Mean { .. } => None,
    }
}

fn column_value<P: Part<Row>>(limited: &Limited<P>, part: &P) -> Option<String> {
    let cell = limited.column.cell(part);
    (!limited.limit.contains(&cell)).then(|| shown(&cell))
}

fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Bool(v) => v.to_string(),
        Cell::Text(v) => v.clone(),
        Cell::Empty => "no value".to_owned(),
        cell => number(cell).map_or_else(String::new, |v| v.to_string()),
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
pub(crate) fn of_all(check: &Check, rows: &[&Row]) -> Option<(Verdict, String)> {
    let (over, within, value, interval) = match check {
        Check::Share { of, over, within } => {
            let groups = rows.iter().take(*over).map(|row| group(of, row));
            let sample: Sample = groups.collect();
            (over, within, sample.share(), sample.interval(Z95))
        }
        Check::Mean {
            column,
            over,
            within,
        } => {
            let values = rows.iter().take(*over);
            let values: Vec<f64> = values.filter_map(|row| number(&column.cell(row))).collect();
            let mean = Mean::of(&values);
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

/// Returns hits and members of a share in one mission.
fn group(of: &ShareOf, row: &Row) -> (u32, u32) {
    match of {
        ShareOf::Missions(outcome) => (u32::from(row.outcome.name() == outcome), 1),
        ShareOf::Robots { robots, outcome } => {
            let members = row
                .robots
                .iter()
                .filter(|robot| robots.contains(&robot.name));
            let hits = members.filter(|robot| robot.outcome == *outcome);
            (hits.count() as u32, robots.len() as u32)
        }
        ShareOf::Columns(columns) => {
            let holds = columns
                .iter()
                .all(|c| c.limit.contains(&c.column.cell(row)));
            (u32::from(holds), 1)
        }
    }
}
