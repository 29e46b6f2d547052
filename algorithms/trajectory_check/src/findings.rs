//! The worst violation of each kind.

use core::cmp::Ordering;
use core::mem::discriminant;

use crate::violation::{Excess, Violation};

/// Violations found so far, at most one of each kind.
#[derive(Debug, Default)]
pub struct Findings {
    worst: Vec<(f64, Violation)>,
}

impl Findings {
    /// Records a violation that has no measure; the first of its kind stays.
    pub fn fault(&mut self, violation: Violation) {
        self.record(0.0, violation);
    }

    /// Records a violation of `kind` if `value` is above `limit`, or either is NaN.
    pub fn at_most(
        &mut self,
        kind: impl FnOnce(Excess) -> Violation,
        time: f64,
        value: f64,
        limit: f64,
    ) {
        if exceeds(value, limit) {
            self.record(value - limit, kind(Excess { time, value, limit }));
        }
    }

    /// Records a violation of `kind` if a value changes by more than `limit` per second plus
    /// `rounding` in `dt` (s) (> 0). The comparison avoids the division: a tiny `dt` would overflow
    /// both sides.
    pub fn rate_at_most(
        &mut self,
        kind: impl FnOnce(Excess) -> Violation,
        time: f64,
        change: Change,
        limit: f64,
    ) {
        let Change {
            amount,
            dt,
            rounding,
        } = change;
        if exceeds(amount, limit * dt + rounding) {
            let value = amount / dt;
            self.record(value - limit, kind(Excess { time, value, limit }));
        }
    }

    /// Returns `true` if there is no violation.
    pub fn is_empty(&self) -> bool {
        self.worst.is_empty()
    }

    /// The violations, in the order in which their kinds were first found.
    pub fn into_violations(self) -> Vec<Violation> {
        self.worst.into_iter().map(|(_, kind)| kind).collect()
    }

    fn record(&mut self, excess: f64, violation: Violation) {
        // A value that cannot be compared is worse than any that can.
        let excess = if excess.is_nan() {
            f64::INFINITY
        } else {
            excess
        };
        let kind = discriminant(&violation);
        match self.worst.iter_mut().find(|(_, v)| discriminant(v) == kind) {
            None => self.worst.push((excess, violation)),
            Some(known) if excess > known.0 => *known = (excess, violation),
            Some(_) => {}
        }
    }
}

/// Change of a value in a time.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    pub amount: f64,
    pub dt: f64,
    pub rounding: f64,
}

/// Returns `true` unless `value` is known to be at most `limit`: NaN exceeds everything.
fn exceeds(value: f64, limit: f64) -> bool {
    !matches!(
        value.partial_cmp(&limit),
        Some(Ordering::Less | Ordering::Equal)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_worst_of_a_kind_stays() {
        let mut findings = Findings::default();
        for (time, value) in [(0.0, 0.9), (1.0, 1.5), (2.0, 3.0), (3.0, 2.0)] {
            findings.at_most(Violation::Speed, time, value, 1.0);
        }
        findings.at_most(Violation::TurnRate, 4.0, 1.1, 1.0);
        let violations = findings.into_violations();
        let worst = Excess {
            time: 2.0,
            value: 3.0,
            limit: 1.0,
        };
        assert_eq!(violations.len(), 2);
        assert_eq!(violations[0], Violation::Speed(worst));
    }

    #[test]
    fn nan_is_a_violation_on_either_side() {
        assert!(exceeds(f64::NAN, 1.0) && exceeds(1.0, f64::NAN));
        assert!(!exceeds(1.0, 1.0) && exceeds(1.1, 1.0));
    }

    #[test]
    fn rates_over_next_to_no_time_do_not_pass_as_infinite() {
        let mut findings = Findings::default();
        let change = Change {
            amount: 1.0,
            dt: 1e-320,
            rounding: 1e-9,
        };
        findings.rate_at_most(Violation::PoseSpeed, 0.0, change, 1.0);
        assert!(!findings.is_empty());
    }
}
