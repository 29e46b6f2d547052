//! Critical speeds, in words.

use super::evidence::Study;
use super::words::{hundredths, in_table, ratio};
use crate::statistics::{Critical, Crossing, Interval, Z95};

/// Where half of a method's evaders first escape, by its cells; `None` without games.
pub(super) fn crossing(study: &Study, method: &str) -> Option<Crossing> {
    let cell = |r: f64| {
        let escapes = study.cell(method, r)?.escapes;
        Some((r, escapes.share()?, escapes.interval(Z95)))
    };
    let points: Vec<_> = study.ratios(method).into_iter().filter_map(cell).collect();
    Crossing::of(&points)
}

/// The same by a logistic curve.
pub(super) fn curve(study: &Study, method: &str) -> Critical {
    Critical::of(&study.doses(method))
}

/// A table of the critical speeds of all methods.
pub(super) fn table(study: &Study) -> String {
    let mut text =
        "| | half escape from | 95 % interval | by a logistic curve | spread about the curve |\n\
                    |---|---|---|---|---|\n"
            .to_owned();
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
        let curve = curve(study, &method.name);
        let spread = match curve {
            Critical::At(e) => hundredths(e.curve.dispersion),
            _ => "–".to_owned(),
        };
        text += &format!(
            "| {} | {value} | {interval} | {} | {spread} |\n",
            in_table(&method.title),
            by_curve(&curve)
        );
    }
    text
}

/// The critical speed of a method in words, by its cells and by a curve.
pub(super) fn words(study: &Study, method: &str) -> Vec<String> {
    let speeds = study.ratios(method);
    let mut words = Vec::new();
    if let Some(crossing) = crossing(study, method) {
        words.push(format!(
            "Half escape from {} on ({})",
            speed(crossing.value, &speeds),
            range(crossing.range(), &speeds)
        ));
    }
    let curve = curve(study, method);
    let spread = match curve {
        Critical::At(e) => {
            format!(
                "; its points spread {} times as much as chance would",
                hundredths(e.curve.dispersion)
            )
        }
        _ => String::new(),
    };
    words.push(format!("By a logistic curve: {}{spread}", by_curve(&curve)));
    words
}

fn by_curve(critical: &Critical) -> String {
    match critical {
        Critical::At(e) => {
            let end = |v: Option<f64>| v.map_or_else(|| "open".to_owned(), times);
            format!("{} ({} … {})", times(e.value), end(e.low), end(e.high))
        }
        Critical::Between(i) => format!("between {} and {}", ratio(i.low), ratio(i.high)),
        Critical::Below(x) => format!("below {}", ratio(*x)),
        Critical::Above(x) => format!("above {}", ratio(*x)),
        Critical::Nowhere => "none, chances do not grow with speed".to_owned(),
        Critical::Unknown => "not known".to_owned(),
    }
}

fn times(value: f64) -> String {
    format!("{}×", hundredths(value))
}

/// A speed at which something happens, of those that were tried.
fn speed(value: f64, tried: &[f64]) -> String {
    match (tried.first(), tried.last()) {
        (Some(&first), _) if value == f64::NEG_INFINITY => format!("below {}", ratio(first)),
        (_, Some(&last)) if value == f64::INFINITY => format!("above {}", ratio(last)),
        _ => times(value),
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
