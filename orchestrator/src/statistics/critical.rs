//! Where a chance passes one half.

use super::interval::Interval;
use super::logistic::{Dose, Logistic, LogisticError, chance, ln_likelihood};
use super::normal::Z95;
use super::wilson::wilson_at;

/// Where the chance of a hit passes ½ as a quantity grows: the critical speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Critical {
    /// At a value, by a logistic curve.
    At(Estimate),
    /// Between two values: surely below ½ at the one, surely above it at the other, and no curve fits
    /// what lies between.
    Between(Interval),
    /// Below the lowest value: the chance is above ½ already there.
    Below(f64),
    /// Above the highest value: the chance is below ½ still there.
    Above(f64),
    /// Nowhere: the chance falls as the quantity grows, or does not depend on it.
    Nowhere,
    /// The data do not say.
    Unknown,
}

/// A critical value by a logistic curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower end of its 95 % interval (profile likelihood); `None` if it has none.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Whether the value lies within the range of the data.
    pub inside: bool,
    /// The curve.
    pub curve: Logistic,
}

impl Critical {
    /// The critical value of outcomes at several values.
    ///
    /// The interval is of the profile likelihood, widened by the curve's
    /// [dispersion](Logistic::dispersion): all values that a likelihood-ratio test at 5 % does not
    /// rule out. It is not symmetric, and open where the data put no bound.
    ///
    /// Source: D. A. Williams, *Interval estimation of the median lethal dose*, Biometrics 42 (1986).
    pub fn of(doses: &[Dose]) -> Self {
        match Logistic::fit(doses) {
            // The slope may differ from 0 by rounding only.
            Ok(curve) if curve.slope > 1e-6 => Self::by(curve, doses),
            Ok(_) => Self::Nowhere,
            Err(LogisticError::Separated) => Self::parted(doses),
            Err(_) => Self::Unknown,
        }
    }

    fn by(curve: Logistic, doses: &[Dose]) -> Self {
        let Some(value) = curve.half() else {
            return Self::Unknown;
        };
        let span = span(doses);
        let profile = Profile {
            doses,
            limit: curve.ln_likelihood - 0.5 * Z95 * Z95 * curve.dispersion,
        };
        Self::At(Estimate {
            value,
            low: profile.end(value, -span.width()),
            high: profile.end(value, span.width()),
            inside: span.contains(value),
            curve,
        })
    }

    /// The critical value of outcomes without overlap: between what is surely below ½ and what is
    /// surely above.
    fn parted(doses: &[Dose]) -> Self {
        let mut doses: Vec<&Dose> = doses.iter().filter(|d| d.of > 0.0).collect();
        doses.sort_by(|a, b| a.x.total_cmp(&b.x));
        let (Some(first), Some(last)) = (doses.first(), doses.last()) else {
            return Self::Unknown;
        };
        if first.share() > last.share() {
            return Self::Nowhere;
        }
        let interval = |d: &Dose| wilson_at(d.share(), d.of, Z95);
        let below = doses.iter().rfind(|d| interval(d).high < 0.5);
        let above = doses.iter().find(|d| interval(d).low > 0.5);
        match (below, above) {
            (Some(below), Some(above)) if below.x < above.x => Self::Between(Interval {
                low: below.x,
                high: above.x,
            }),
            (Some(below), None) if below.x >= last.x => Self::Above(last.x),
            (None, Some(above)) if above.x <= first.x => Self::Below(first.x),
            _ => Self::Unknown,
        }
    }

    /// The values that the data leave possible, with infinite ends where they put no bound; `None`
    /// if there is no critical value or nothing is known of it.
    pub fn possible(&self) -> Option<Interval> {
        let (low, high) = match *self {
            Self::At(estimate) => (
                estimate.low.unwrap_or(f64::NEG_INFINITY),
                estimate.high.unwrap_or(f64::INFINITY),
            ),
            Self::Between(interval) => (interval.low, interval.high),
            Self::Below(x) => (f64::NEG_INFINITY, x),
            Self::Above(x) => (x, f64::INFINITY),
            Self::Nowhere | Self::Unknown => return None,
        };
        Some(Interval { low, high })
    }
}

/// The range of the values with outcomes.
fn span(doses: &[Dose]) -> Interval {
    let values = || doses.iter().filter(|d| d.of > 0.0).map(|d| d.x);
    Interval {
        low: values().fold(f64::INFINITY, f64::min),
        high: values().fold(f64::NEG_INFINITY, f64::max),
    }
}

/// The likelihood of the best curve that passes ½ at a given value.
struct Profile<'a> {
    doses: &'a [Dose],
    /// What a value must reach to be possible.
    limit: f64,
}

impl Profile<'_> {
    /// The end of the possible values on one side; `step` has the direction's sign.
    fn end(&self, best: f64, step: f64) -> Option<f64> {
        let (mut inside, mut outside) = (best, best + step);
        let mut tries = 0;
        while self.possible(outside) {
            // The likelihood levels off far away: what is possible there is so everywhere beyond.
            tries += 1;
            if tries > 12 {
                return None;
            }
            inside = outside;
            outside = best + 2.0 * (outside - best);
        }
        for _ in 0..100 {
            let middle = f64::midpoint(inside, outside);
            if self.possible(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Some(f64::midpoint(inside, outside))
    }

    fn possible(&self, value: f64) -> bool {
        // From the level curve on, where the likelihood bends most: Newton's steps are safe there.
        let mut slope = 0.0;
        let mut best = ln_likelihood(self.doses, value, 0.0, slope);
        for _ in 0..100 {
            let (mut gradient, mut curvature) = (0.0, 0.0);
            for d in self.doses {
                let x = d.x - value;
                let p = chance(slope * x);
                gradient += x * (d.hits - d.of * p);
                curvature += x * x * d.of * p * (1.0 - p);
            }
            let mut step = gradient / curvature.max(1e-300);
            let before = best;
            // Concave in the slope: a step that is halved often enough goes up.
            for _ in 0..60 {
                let likelihood = ln_likelihood(self.doses, value, 0.0, slope + step);
                if likelihood > best {
                    (slope, best) = (slope + step, likelihood);
                    break;
                }
                step /= 2.0;
            }
            if best >= self.limit {
                return true;
            }
            if best - before <= 1e-12 * best.abs() {
                return false;
            }
        }
        best >= self.limit
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::logistic::tests::doses;
    use super::*;

    fn estimate(points: &[(f64, f64, f64)]) -> Estimate {
        match Critical::of(&doses(points)) {
            Critical::At(estimate) => estimate,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_symmetric_curve_passes_one_half_in_its_middle() {
        let e = estimate(&[
            (1.0, 20.0, 200.0),
            (1.5, 60.0, 200.0),
            (2.0, 140.0, 200.0),
            (2.5, 180.0, 200.0),
        ]);
        assert!((e.value - 1.75).abs() < 1e-6 && e.inside, "{e:?}");
        let (low, high) = (e.low.unwrap(), e.high.unwrap());
        assert!((e.value - low - (high - e.value)).abs() < 1e-6, "{e:?}");
        // Near the delta method with that much data: error of −level/slope.
        assert!((0.05..0.12).contains(&(high - e.value)), "{e:?}");
    }

    #[test]
    fn few_data_put_no_bound() {
        let e = estimate(&[(1.0, 4.0, 10.0), (2.0, 5.0, 10.0)]);
        assert!((e.value - 2.0).abs() < 1e-6, "{e:?}");
        assert_eq!((e.low, e.high), (None, None));
        let possible = Critical::At(e).possible().unwrap();
        assert_eq!(
            (possible.low, possible.high),
            (f64::NEG_INFINITY, f64::INFINITY)
        );
    }

    #[test]
    fn beyond_the_data_is_said() {
        let e = estimate(&[(1.0, 2.0, 200.0), (2.0, 10.0, 200.0), (3.0, 30.0, 200.0)]);
        assert!(e.value > 3.0 && !e.inside, "{e:?}");
        assert!(e.low.unwrap() > 3.0, "{e:?}");
    }

    #[test]
    fn parted_outcomes_have_bounds() {
        let of = |points: &[(f64, f64, f64)]| Critical::of(&doses(points));
        assert_eq!(
            of(&[(1.0, 0.0, 50.0), (3.0, 0.0, 50.0)]),
            Critical::Above(3.0)
        );
        assert_eq!(
            of(&[(1.0, 50.0, 50.0), (3.0, 50.0, 50.0)]),
            Critical::Below(1.0)
        );
        let between = Interval {
            low: 1.0,
            high: 2.0,
        };
        assert_eq!(
            of(&[(1.0, 0.0, 9.0), (2.0, 9.0, 9.0)]),
            Critical::Between(between)
        );
        // One value with both, as parted as it is.
        let between = Interval {
            low: 1.0,
            high: 3.0,
        };
        assert_eq!(
            of(&[(1.0, 0.0, 9.0), (2.0, 4.0, 9.0), (3.0, 9.0, 9.0)]),
            Critical::Between(between)
        );
        assert_eq!(of(&[(1.0, 0.0, 2.0), (3.0, 0.0, 2.0)]), Critical::Unknown);
        assert_eq!(of(&[(1.0, 9.0, 9.0), (2.0, 0.0, 9.0)]), Critical::Nowhere);
        assert_eq!(of(&[(1.0, 0.0, 9.0), (2.0, 4.0, 9.0)]), Critical::Unknown);
        assert_eq!(
            of(&[(1.0, 0.0, 90.0), (2.0, 4.0, 90.0)]),
            Critical::Above(2.0)
        );
        assert_eq!(of(&[(1.0, 8.0, 9.0), (2.0, 2.0, 9.0)]), Critical::Nowhere);
        assert_eq!(of(&[(1.0, 3.0, 9.0)]), Critical::Unknown);
        assert_eq!(Critical::Nowhere.possible(), None);
    }

    proptest! {
        #[test]
        fn the_interval_holds_the_estimate_and_shrinks_with_data(
            shares in prop::collection::vec(0.02_f64..0.98, 3..7), of in 20.0_f64..100.0,
        ) {
            let points = |of: f64| -> Vec<Dose> {
                (0_u32..).zip(&shares)
                    .map(|(i, share)| Dose { x: 1.0 + 0.5 * f64::from(i), hits: share * of, of })
                    .collect()
            };
            let (few, many) = (Critical::of(&points(of)), Critical::of(&points(10.0 * of)));
            if let (Critical::At(few), Critical::At(many)) = (few, many) {
                prop_assert!(few.low.is_none_or(|low| low <= few.value));
                prop_assert!(few.high.is_none_or(|high| few.value <= high));
                let scale = 1e-6 * few.value.abs().max(1.0);
                prop_assert!((few.value - many.value).abs() < 1e3 * scale);
                // Ten times the data narrow it, unless the points are that far off the curve.
                if many.curve.dispersion <= 1.0 {
                    for (f, m) in [(few.low, many.low), (many.high, few.high)] {
                        if let (Some(f), Some(m)) = (f, m) {
                            prop_assert!(f <= m + scale);
                        }
                    }
                }
            }
        }
    }
}
