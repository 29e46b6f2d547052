//! Claims about the knowledge of the Police.

use statistics::Z95;

use super::super::evidence::Study;
use super::super::published::{EXACT, FILTER, KNOWLEDGE_RATIOS};
use super::compare::{Order, family, least};
use crate::claim::{Finding, Measured, Unit, Verdict};
use crate::statistics::{Difference, difference_of_differences};
use crate::words::{point_range, points, ratio, ratios};

/// Claim (f), first part.
pub(super) fn raises(study: &Study) -> Finding {
    let mut pairs = Vec::new();
    let mut reversed = Vec::new();
    for r in KNOWLEDGE_RATIOS {
        let (Some(a), Some(b)) = (study.cell(FILTER, r), study.cell(EXACT, r)) else {
            return Finding::missing(&format!("both kinds of knowledge at {}", ratio(r)));
        };
        let label = format!(
            "{} less {} at {}",
            study.title(FILTER),
            study.title(EXACT),
            ratio(r)
        );
        pairs.push((label, &a.games, &b.games));
        reversed.push((String::new(), &b.games, &a.games));
    }
    let (Some(comparisons), Some(reversed)) = (family(&pairs), family(&reversed)) else {
        return Finding::missing("games in every cell");
    };
    let is = |order: Order| comparisons.iter().filter(|c| c.order == order).count();
    let none_rises = reversed
        .iter()
        .all(|c| matches!(c.order, Order::NotLower | Order::Higher));
    let verdict = if is(Order::Lower) > 0 || none_rises {
        Verdict::Refuted
    } else if is(Order::Higher) == comparisons.len() {
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

/// Claim (f), second part: a conjecture of the paper.
pub(super) fn fades(study: &Study) -> Finding {
    let high = [2.0, 2.5, 3.0];
    let rises = || {
        let of =
            |speeds: &[f64]| Some([study.pooled(FILTER, speeds)?, study.pooled(EXACT, speeds)?]);
        let ([a, b], [c, d]) = (of(&KNOWLEDGE_RATIOS)?, of(&high)?);
        let less = difference_of_differences([&a, &b, &c, &d])?;
        Some((Difference::of(&a, &b)?, Difference::of(&c, &d)?, less))
    };
    let Some((slow, fast, less)) = rises() else {
        return Finding::missing("both kinds of knowledge at 0.8× to 1.0× and at 2.0× to 3.0×");
    };
    let interval = less.interval();
    let rise = |at: &[f64], d: &Difference| {
        let range = point_range(d.interval(Z95));
        format!(
            "Rise at {}: {} points ({range})",
            ratios(at),
            points(d.value)
        )
    };
    let seeds = (less.count as u64, "seeds");
    Finding {
        verdict: Verdict::above(interval, 0.0),
        ours: Measured::number(less.value, interval, Unit::Points, seeds),
        numbers: vec![
            rise(&KNOWLEDGE_RATIOS, &slow),
            rise(&high, &fast),
            format!(
                "Less by {} points ({})",
                points(less.value),
                point_range(interval)
            ),
        ],
    }
}
