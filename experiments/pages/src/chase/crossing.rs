//! Critical speeds, as text.

use statistics::{Interval, Z95};

use super::evidence::Study;
use crate::statistics::Crossing;
use crate::words::{hundredths, in_table, ratio};

/// Returns the speed from which half of a method's evaders escape; `None` without games.
pub(super) fn crossing(study: &Study, method: &str) -> Option<Crossing> {
    let cell = |r: f64| {
        let escapes = study.cell(method, r)?.escapes;
        Some((r, escapes.share()?, escapes.interval(Z95)))
    };
    let points: Vec<_> = study.ratios(method).into_iter().filter_map(cell).collect();
    Crossing::of(&points)
}

/// Returns the rows of the table of critical speeds: method, speed, interval.
pub(super) fn rows(study: &Study) -> String {
    let mut text = String::new();
    for method in &study.methods {
        let (value, interval) = match crossing(study, &method.name) {
            Some(crossing) => {
                let speeds = study.ratios(&method.name);
                (
                    speed(crossing.value, &speeds),
                    range(crossing.range(), &speeds),
                )
            }
            None => ("–".to_owned(), "–".to_owned()),
        };
        text += &format!("| {} | {value} | {interval} |\n", in_table(&method.title));
    }
    text
}

/// Describes the critical speed of a method.
pub(super) fn words(study: &Study, method: &str) -> Vec<String> {
    let speeds = study.ratios(method);
    let of = |crossing: Crossing| {
        format!(
            "Half escape from {} on ({})",
            speed(crossing.value, &speeds),
            range(crossing.range(), &speeds)
        )
    };
    crossing(study, method).map(of).into_iter().collect()
}

/// Formats a critical speed within the tested speeds.
fn speed(value: f64, tried: &[f64]) -> String {
    match (tried.first(), tried.last()) {
        (Some(&first), _) if value == f64::NEG_INFINITY => format!("below {}", ratio(first)),
        (_, Some(&last)) if value == f64::INFINITY => format!("above {}", ratio(last)),
        _ => format!("{}×", hundredths(value)),
    }
}

fn range(interval: Interval, tried: &[f64]) -> String {
    let (low, high) = (speed(interval.low, tried), speed(interval.high, tried));
    if low == high {
        low
    } else {
        format!("{low} … {high}")
    }
}
