//! Claims about critical speeds.

use statistics::Interval;

use super::super::crossing::{crossings, words};
use super::super::evidence::Study;
use super::super::published::{FIELD, LINE};
use super::{Finding, Verdict};

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
    Finding {
        verdict,
        numbers: words(study, method),
    }
}
