//! Allowed values of a column.

use scenario::expect::{Bound, RangeSpec, Within};
use statistics::Interval;
use tables::{Cell, Type};

/// Relative tolerance of a number without a range.
const ROUNDING: f64 = 1e-9;

/// Values that meet an expectation.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    Bool(bool),
    Text(String),
    Range(Interval),
}

impl Limit {
    /// Form of a range, for errors.
    pub const FORM: &'static str = "`at_least`, `at_most`, `within = [low, high]` with low <= high, or a `value` with a tolerance `within` >= 0";

    /// Returns the limit of a bound; `None` if no value can meet it.
    pub fn from_bound(bound: &Bound) -> Option<Self> {
        Some(match bound {
            Bound::Bool(value) => Self::Bool(*value),
            Bound::Text(text) => Self::Text(text.clone()),
            Bound::Number(value) => Self::Range(around(*value, ROUNDING * value.abs())),
            Bound::Range(range) => Self::Range(interval(range)?),
        })
    }

    /// Returns `true` if columns of a type can meet it.
    pub fn fits(&self, kind: Type) -> bool {
        match self {
            Self::Bool(_) => kind == Type::Bool,
            Self::Text(_) => kind == Type::Text,
            Self::Range(_) => !matches!(kind, Type::Bool | Type::Text),
        }
    }

    /// Returns `true` if a value meets it; a missing value meets none.
    pub fn contains(&self, cell: &Cell) -> bool {
        match (self, cell) {
            (Self::Bool(expected), Cell::Bool(found)) => expected == found,
            (Self::Text(expected), Cell::Text(found)) => expected == found,
            (Self::Range(range), cell) => number(cell).is_some_and(|v| range.contains(v)),
            _ => false,
        }
    }
}

fn around(value: f64, tolerance: f64) -> Interval {
    Interval {
        low: value - tolerance,
        high: value + tolerance,
    }
}

fn interval(range: &RangeSpec) -> Option<Interval> {
    if *range == RangeSpec::default() {
        return None;
    }
    let mut found = Interval {
        low: range.at_least.unwrap_or(f64::NEG_INFINITY),
        high: range.at_most.unwrap_or(f64::INFINITY),
    };
    let within = match (range.value, range.within) {
        (None, None) => found,
        (Some(value), Some(Within::Tolerance(tolerance))) => around(value, tolerance),
        (None, Some(Within::Ends([low, high]))) => Interval { low, high },
        _ => return None,
    };
    found.low = found.low.max(within.low);
    found.high = found.high.min(within.high);
    (found.low <= found.high).then_some(found)
}

/// Returns a value as a number, if it is one.
pub fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Int(v) => Some(*v as f64),
        Cell::F64(v) => Some(*v),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(range: RangeSpec) -> Option<Limit> {
        Limit::from_bound(&Bound::Range(range))
    }

    #[test]
    fn numbers_hold_up_to_rounding_errors_and_other_values_exactly() {
        let third = Limit::from_bound(&Bound::Number(1.0 / 3.0)).unwrap();
        assert!(third.contains(&Cell::F64(1.0 / 3.0 + 1e-12)));
        assert!(!third.contains(&Cell::F64(0.3334)));
        assert!(!third.contains(&Cell::Empty));
        let zero = Limit::from_bound(&Bound::Number(0.0)).unwrap();
        assert!(zero.contains(&Cell::Int(0)) && !zero.contains(&Cell::Int(1)));
        let text = Limit::from_bound(&Bound::Text("ended".into())).unwrap();
        assert!(text.fits(Type::Text) && !text.fits(Type::F64));
        assert!(text.contains(&Cell::Text("ended".into())));
    }

    #[test]
    fn ranges_are_closed_and_impossible_ones_are_none() {
        let tolerance = limit(RangeSpec {
            value: Some(3.0),
            within: Some(Within::Tolerance(0.5)),
            at_most: Some(3.2),
            ..RangeSpec::default()
        });
        let tolerance = tolerance.unwrap();
        for (value, holds) in [(2.5, true), (3.2, true), (3.3, false), (2.4, false)] {
            assert_eq!(tolerance.contains(&Cell::F64(value)), holds, "{value}");
        }
        let ends = |within, value| RangeSpec {
            within: Some(within),
            value,
            ..RangeSpec::default()
        };
        for impossible in [
            RangeSpec::default(),
            ends(Within::Ends([2.0, 1.0]), None),
            ends(Within::Ends([1.0, 2.0]), Some(1.0)),
            ends(Within::Tolerance(1.0), None),
            ends(Within::Tolerance(-1.0), Some(1.0)),
        ] {
            assert_eq!(limit(impossible.clone()), None, "{impossible:?}");
        }
    }
}
