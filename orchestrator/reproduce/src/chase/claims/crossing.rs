//! Claims about critical speeds.

use statistics::Interval;

use super::super::crossing::{brackets, crossings, words};
use super::super::evidence::Study;
use super::super::published::{FIELD, LINE};
use crate::claim::{Finding, Measured, Unit, Verdict};

/// Claim (b).
pub(super) fn field(study: &Study) -> Finding {
    within(
        study,
        FIELD,
        Interval {
            low: 1.75,
            high: 2.25,
        },
    )
}

/// Claim (e).
pub(super) fn rrt(study: &Study) -> Finding {
    within(
        study,
        LINE,
        Interval {
            low: 1.0,
            high: 1.5,
        },
    )
}

fn within(study: &Study, method: &str, claimed: Interval) -> Finding {
    let crossings = crossings(study, method).filter(|_| study.ratios(method).len() > 1);
    let Some(crossings) = crossings else {
        return Finding::missing(&format!("{method} at two speeds or more"));
    };
    let range = crossings.range;
    let verdict = if range.is_within(&claimed) {
        Verdict::Confirmed
    } else if range.low >= claimed.high || range.high <= claimed.low {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    let cells = study
        .ratios(method)
        .into_iter()
        .filter_map(|r| study.cell(method, r));
    let games = cells.map(|cell| cell.escapes().groups()).min();
    Finding {
        verdict,
        ours: Measured {
            text: brackets(study, method, &crossings),
            value: None,
            interval: Some(range),
            unit: Unit::Speed,
            n: games.unwrap_or(0),
            of: "games per speed",
        },
        numbers: words(study, method),
    }
}
