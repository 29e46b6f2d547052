//! Claims about chances at given speeds.

use super::super::evidence::Study;
use super::super::published::{BRAITENBERG, FIELD, LINE, SPEED_RATIOS};
use super::compare::{Order, family, least};
use crate::claim::{Finding, Measured, Unit, Verdict};
use crate::statistics::simultaneous_z;
use crate::words::{ratio, ratios, share, shares};

/// Claim (a).
pub(super) fn order(study: &Study) -> Finding {
    let mut pairs = Vec::new();
    for r in SPEED_RATIOS {
        for (first, second) in [(LINE, FIELD), (FIELD, BRAITENBERG)] {
            let (Some(a), Some(b)) = (study.cell(first, r), study.cell(second, r)) else {
                return Finding::missing(&format!("{first} and {second} at {}", ratio(r)));
            };
            let label = format!(
                "{} less {} at {}",
                study.title(first),
                study.title(second),
                ratio(r)
            );
            pairs.push((label, &a.games, &b.games));
        }
    }
    let Some(comparisons) = family(&pairs) else {
        return Finding::missing("games in every cell");
    };
    let is = |order: Order| comparisons.iter().filter(|c| c.order == order).count();
    let verdict = if is(Order::Lower) > 0 {
        Verdict::Refuted
    } else if is(Order::Open) == 0 {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    };
    Finding {
        verdict,
        ours: least(&comparisons),
        numbers: comparisons
            .iter()
            .map(super::compare::Comparison::words)
            .collect(),
    }
}

/// Claim (c).
pub(super) fn drop(study: &Study) -> Finding {
    let faster = [2.5, 3.0];
    let (Some(fast), Some(slow)) = (study.pooled(FIELD, &faster), study.cell(FIELD, 2.0)) else {
        return Finding::missing("the potential field at 2.0×, 2.5× and 3.0×");
    };
    let label = format!("{} less {}", ratios(&faster), ratio(2.0));
    let Some(comparisons) = family(&[(label, &fast, &slow.games)]) else {
        return Finding::missing("games in every cell");
    };
    let verdict = match comparisons.first().map(|c| c.order) {
        Some(Order::Lower) => Verdict::Confirmed,
        Some(Order::Higher | Order::NotLower) => Verdict::Refuted,
        _ => Verdict::Undecided,
    };
    Finding {
        verdict,
        ours: least(&comparisons),
        numbers: comparisons
            .iter()
            .map(super::compare::Comparison::words)
            .collect(),
    }
}

/// Claim (d).
pub(super) fn never(study: &Study) -> Finding {
    let speeds = study.ratios(BRAITENBERG);
    if speeds.is_empty() {
        return Finding::missing("Braitenberg vehicles");
    }
    let z = simultaneous_z(speeds.len());
    let cells = speeds.iter().filter_map(|&r| {
        let cell = study.cell(BRAITENBERG, r)?;
        let escapes = cell.escapes();
        Some((r, escapes.share()?, escapes.interval(z), escapes.groups()))
    });
    let cells: Vec<_> = cells.collect();
    let verdict = if cells.iter().any(|c| c.2.low > 0.5) {
        Verdict::Refuted
    } else if cells.iter().all(|c| c.2.high < 0.5) {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    };
    let highest = cells.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let ours = highest.map(|&(r, value, interval, games)| {
        let mut ours = Measured::number(value, interval, Unit::Share, (games, "games"));
        ours.text += &format!(", the most, at {}", ratio(r));
        ours
    });
    let numbers = cells.iter().map(|(r, value, interval, _)| {
        format!(
            "At {}: {} ({})",
            ratio(*r),
            share(*value),
            shares(*interval)
        )
    });
    Finding {
        verdict,
        ours: ours.unwrap_or_else(Measured::none),
        numbers: numbers.collect(),
    }
}
