//! Critical speeds, as text.

use statistics::Z95;

use super::evidence::Study;
use crate::statistics::Crossings;
use crate::words::{in_table, ratio, ratio_range};

/// Returns the speeds at which the chance of a method crosses one half; `None` without games.
pub(super) fn crossings(study: &Study, method: &str) -> Option<Crossings> {
    let cell = |r: f64| {
        let escapes = study.cell(method, r)?.escapes();
        Some((r, escapes.share()?, escapes.interval(Z95)))
    };
    let points: Vec<_> = study.ratios(method).into_iter().filter_map(cell).collect();
    Crossings::of(&points)
}

/// Returns the rows of the table of critical speeds: method, brackets, range.
pub(super) fn rows(study: &Study) -> String {
    let mut text = String::new();
    for method in &study.methods {
        let (brackets, range) = match crossings(study, &method.name) {
            Some(crossings) => (
                brackets(study, &method.name, &crossings),
                ratio_range(crossings.range),
            ),
            None => ("–".to_owned(), "–".to_owned()),
        };
        text += &format!("| {} | {brackets} | {range} |\n", in_table(&method.title));
    }
    text
}

/// Describes the critical speed of a method.
pub(super) fn words(study: &Study, method: &str) -> Vec<String> {
    let of = |crossings: Crossings| {
        vec![
            format!(
                "Half of the evaders escape: {}",
                brackets(study, method, &crossings)
            ),
            format!("Range by the intervals: {}", ratio_range(crossings.range)),
        ]
    };
    crossings(study, method).map(of).unwrap_or_default()
}

/// Formats the brackets: `1.2× … 1.25×`, and `falls` where the chance does.
pub(super) fn brackets(study: &Study, method: &str, crossings: &Crossings) -> String {
    let speeds = study.ratios(method);
    let half = |r: &f64| {
        let share = study
            .cell(method, *r)
            .and_then(|cell| cell.escapes().share());
        share.is_some_and(|share| share >= 0.5)
    };
    if crossings.brackets.is_empty() {
        return match (speeds.first(), speeds.last()) {
            (Some(first), _) if half(first) => format!("below {}", ratio(*first)),
            (_, Some(last)) => format!("above {}", ratio(*last)),
            _ => "–".to_owned(),
        };
    }
    let words = crossings.brackets.iter().map(|b| {
        let falls = if b.rises { "" } else { "falls " };
        format!("{falls}{} … {}", ratio(b.low), ratio(b.high))
    });
    words.collect::<Vec<_>>().join(", ")
}
