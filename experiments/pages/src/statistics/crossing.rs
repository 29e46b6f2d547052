//! Values at which measured chances first reach one half, without a model.

use statistics::Interval;

/// Value at which chances first reach ½ as a quantity grows, by linear interpolation.
///
/// −∞ if they have reached it at the lowest value, +∞ if they never do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Crossing of the chances.
    pub value: f64,
    /// Crossing of the upper ends of their intervals: a lower bound.
    pub low: f64,
    /// Crossing of the lower ends: an upper bound.
    pub high: f64,
}

impl Crossing {
    /// Computes the crossing of points (value of the quantity, chance, its interval) in any order.
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
        let at = |height: fn(&(f64, f64, Interval)) -> f64| {
            first(points.iter().map(|p| (p.0, height(p))))
        };
        Some(Self {
            value: at(|p| p.1),
            low: at(|p| p.2.high),
            high: at(|p| p.2.low),
        })
    }

    /// Returns all values between [`low`](Self::low) and [`high`](Self::high).
    pub fn range(&self) -> Interval {
        Interval {
            low: self.low,
            high: self.high,
        }
    }
}

/// Returns the value at which points in ascending order first reach ½.
fn first(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut last: Option<(f64, f64)> = None;
    for (x, y) in points {
        if y >= 0.5 {
            return match last {
                None => f64::NEG_INFINITY,
                Some((x0, y0)) => x0 + (x - x0) * (0.5 - y0) / (y - y0),
            };
        }
        last = Some((x, y));
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::wilson;

    use super::*;

    fn crossing(counts: &[(f64, u64)], of: u64) -> Crossing {
        let point = |&(x, hits): &(f64, u64)| (x, hits as f64 / of as f64, wilson(hits, of));
        let points: Vec<_> = counts.iter().map(point).collect();
        Crossing::of(&points).unwrap()
    }

    #[test]
    fn the_crossing_is_interpolated_between_two_points() {
        let c = crossing(&[(1.0, 10), (2.0, 90), (3.0, 40)], 100);
        assert!((c.value - 1.5).abs() < 1e-12);
        assert!(
            1.0 < c.low && c.low < 1.5 && 1.5 < c.high && c.high < 2.0,
            "{c:?}"
        );
        assert!((c.value - c.low - (c.high - c.value)).abs() < 0.01, "{c:?}");
    }

    #[test]
    fn the_crossing_beyond_the_points_is_infinite() {
        let never = crossing(&[(1.0, 0), (2.0, 3)], 100);
        assert_eq!(
            (never.low, never.value, never.high),
            (f64::INFINITY, f64::INFINITY, f64::INFINITY)
        );
        let always = crossing(&[(1.0, 100), (2.0, 100)], 100);
        assert_eq!(
            always.range(),
            Interval {
                low: f64::NEG_INFINITY,
                high: f64::NEG_INFINITY
            }
        );
        let unsure = crossing(&[(1.0, 45), (2.0, 55)], 100);
        assert_eq!(
            (unsure.low, unsure.high),
            (f64::NEG_INFINITY, f64::INFINITY)
        );
        assert!((unsure.value - 1.5).abs() < 1e-12);
        assert_eq!(Crossing::of(&[]), None);
    }

    proptest! {
        #[test]
        fn the_crossing_is_within_its_range(hits in prop::collection::vec(0_u64..=60, 1..8)) {
            let counts: Vec<(f64, u64)> = (0_u32..).map(f64::from).zip(hits).collect();
            let c = crossing(&counts, 60);
            prop_assert!(c.low <= c.value && c.value <= c.high);
        }
    }
}
