//! Claims about critical speeds.

use super::super::critical::{crossing, words};
use super::super::evidence::Study;
use super::super::published::{FIELD, LINE};
use super::{Finding, Verdict};
use crate::statistics::Interval;

/// Claim (b).
pub(super) const FIELD_CLAIM: &str = "On a potential field, the critical speed, from which on half of the evaders escape, is about twice \
     that of the Police.";
pub(super) const FIELD_RULE: &str = "Where the chance first reaches one half, by straight lines from speed \
     to speed; its interval is where the ends of the chances' 95 % intervals do. Confirmed if all of it lies \
     between 1.75× and 2.25× (half a step of Fig. 2 to either side); refuted if none of it does. The logistic \
     curve is for comparison: it fits badly where chances level off below 100 %.";

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
pub(super) const RRT_CLAIM: &str = "With RRT*, the critical speed lies between 1.0× and 1.5×.";
pub(super) const RRT_RULE: &str = "As for (b). Confirmed if all of the interval lies between 1.0× and \
     1.5×; refuted if none of it does.";

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
    let crossing = crossing(study, method).filter(|_| study.ratios(method).len() > 1);
    let Some(crossing) = crossing else {
        return Finding::missing(&format!("{method} at two speeds or more"));
    };
    let range = crossing.range();
    let verdict = if range.is_within(&claimed) {
        Verdict::Confirmed
    } else if !range.meets(&claimed) {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    Finding {
        verdict,
        numbers: words(study, method),
    }
}
