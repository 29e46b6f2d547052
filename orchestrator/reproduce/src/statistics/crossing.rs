//! Brackets of the values at which measured chances cross one half, without interpolation.

use statistics::Interval;

/// Two neighbouring measured values between which the chance crosses one half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bracket {
    /// The lower value.
    pub low: f64,
    /// The higher value.
    pub high: f64,
    /// `true` if the chance rises from below one half to one half or more.
    pub rises: bool,
}

/// Values of a quantity at which measured chances cross one half.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossings {
    /// The brackets, ascending; empty if the chance never crosses one half.
    pub brackets: Vec<Bracket>,
    /// Range outside which the intervals exclude a crossing: from the last value up to which all intervals
    /// lie below one half (−∞ if the first does not) to the first value from which all lie above it (+∞ if
    /// the last does not).
    pub range: Interval,
}

impl Crossings {
    /// Computes the crossings of points (value of the quantity, chance, its interval) in any order.
    /// `None` without points, or if a number is not finite.
    pub fn of(points: &[(f64, f64, Interval)]) -> Option<Self> {
        let finite = |(x, y, i): &(f64, f64, Interval)| {
            [*x, *y, i.low, i.high].iter().all(|v| v.is_finite())
        };
        if points.is_empty() || !points.iter().all(finite) {
            return None;
        }
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_half = |p: &(f64, f64, Interval)| p.1 >= 0.5;
        let brackets = points.iter().zip(points.iter().skip(1));
        let brackets = brackets
            .filter(|(a, b)| is_half(a) != is_half(b))
            .map(|(a, b)| Bracket {
                low: a.0,
                high: b.0,
                rises: is_half(b),
            });
        let below = points.iter().take_while(|p| p.2.high < 0.5).last();
        let above = points.iter().rev().take_while(|p| p.2.low > 0.5).last();
        Some(Self {
            brackets: brackets.collect(),
            range: Interval {
                low: below.map_or(f64::NEG_INFINITY, |p| p.0),
                high: above.map_or(f64::INFINITY, |p| p.0),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::wilson;

    use super::*;

    fn crossings(counts: &[(f64, u64)], of: u64) -> Crossings {
        let point = |&(x, hits): &(f64, u64)| (x, hits as f64 / of as f64, wilson(hits, of));
        let points: Vec<_> = counts.iter().map(point).collect();
        Crossings::of(&points).unwrap()
    }

    fn bracket(low: f64, high: f64, rises: bool) -> Bracket {
        Bracket { low, high, rises }
    }

    #[test]
    fn a_bracket_is_two_neighbours_and_the_range_leaves_out_what_is_sure() {
        let c = crossings(
            &[(1.0, 10), (1.5, 45), (1.25, 12), (2.0, 55), (3.0, 90)],
            100,
        );
        assert_eq!(c.brackets, [bracket(1.5, 2.0, true)]);
        assert_eq!(
            c.range,
            Interval {
                low: 1.25,
                high: 3.0
            }
        );
    }

    #[test]
    fn every_crossing_of_a_chance_that_is_not_monotone_is_listed() {
        let c = crossings(&[(1.45, 100), (1.0, 0), (1.8, 26), (2.25, 73)], 100);
        assert_eq!(
            c.brackets,
            [
                bracket(1.0, 1.45, true),
                bracket(1.45, 1.8, false),
                bracket(1.8, 2.25, true)
            ]
        );
        assert_eq!((c.range.low, c.range.high), (1.0, 2.25));
    }

    #[test]
    fn a_crossing_beyond_the_points_has_an_infinite_range() {
        let never = crossings(&[(1.0, 0), (2.0, 3)], 100);
        assert_eq!(never.brackets, []);
        assert_eq!((never.range.low, never.range.high), (2.0, f64::INFINITY));
        let always = crossings(&[(1.0, 100), (2.0, 100)], 100);
        assert_eq!(
            (always.range.low, always.range.high),
            (f64::NEG_INFINITY, 1.0)
        );
        let unsure = crossings(&[(1.0, 45), (2.0, 55)], 100);
        assert_eq!(unsure.brackets, [bracket(1.0, 2.0, true)]);
        assert_eq!(
            (unsure.range.low, unsure.range.high),
            (f64::NEG_INFINITY, f64::INFINITY)
        );
        assert_eq!(Crossings::of(&[]), None);
    }

    proptest! {
        #[test]
        fn every_bracket_lies_in_the_range(hits in prop::collection::vec(0_u64..=60, 1..8)) {
            let counts: Vec<(f64, u64)> = (0_u32..).map(f64::from).zip(hits).collect();
            let c = crossings(&counts, 60);
            for bracket in &c.brackets {
                prop_assert!(c.range.low <= bracket.low && bracket.high <= c.range.high, "{c:?}");
            }
        }
    }
}
