//! Logistic regression on one quantity.

use sim_backend::math::{exp, ln};

use super::sample::Sample;

/// Outcomes at one value of a quantity (a dose, in the language of the trade; here a speed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dose {
    /// The value.
    pub x: f64,
    /// Hits, 0 to `of`; need not be a whole number.
    pub hits: f64,
    /// Independent outcomes, ≥ 0; need not be a whole number.
    pub of: f64,
}

impl Dose {
    /// The outcomes of a sample at a value, as many as there would have to be independent ones.
    pub fn new(x: f64, sample: &Sample) -> Self {
        let of = sample.effective_size();
        Self {
            x,
            hits: of * sample.share().unwrap_or(0.0),
            of,
        }
    }

    /// Share of hits; 0 without outcomes.
    pub fn share(&self) -> f64 {
        if self.of > 0.0 {
            self.hits / self.of
        } else {
            0.0
        }
    }
}

/// Why no curve can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LogisticError {
    /// Too few data.
    #[error("a logistic curve needs outcomes at two different values at least")]
    TooFew,
    /// All outcomes are equal, or one value parts the hits from the rest: the best curve is
    /// infinitely steep.
    #[error("the outcomes are parted without overlap: no finite curve fits them best")]
    Separated,
    /// A number is not finite, or there are more hits than outcomes.
    #[error("a value is not finite, or there are more hits than outcomes")]
    Invalid,
    /// The iteration did not settle.
    #[error("the fit did not settle within 100 steps")]
    Unsettled,
}

/// A fitted curve: the chance at `x` is 1 / (1 + exp(−`slope` · (`x` − `middle`) − `level`)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logistic {
    /// Where the curve's `level` is taken: the mean of the values, weighted by outcomes.
    pub middle: f64,
    /// Log-odds at the middle.
    pub level: f64,
    /// Change of the log-odds per unit of x.
    pub slope: f64,
    /// Standard error of the slope, widened by the [`dispersion`](Self::dispersion).
    pub slope_error: f64,
    /// How much farther the points lie from the curve than chance would put them: deviance per degree
    /// of freedom, at least 1.
    pub dispersion: f64,
    /// Logarithm of the likelihood, but for a constant.
    pub(super) ln_likelihood: f64,
}

/// Most steps of an iteration.
const STEPS: usize = 100;

impl Logistic {
    /// The curve of largest likelihood.
    ///
    /// Iteratively reweighted least squares with halved steps where a whole one goes too far.
    ///
    /// Source: P. McCullagh and J. A. Nelder, *Generalized Linear Models*, §4.4; the dispersion as D.
    /// J. Finney's heterogeneity factor, *Probit Analysis*, §4.6.
    ///
    /// # Errors
    /// [`LogisticError`].
    pub fn fit(doses: &[Dose]) -> Result<Self, LogisticError> {
        let doses = usable(doses)?;
        let total: f64 = doses.iter().map(|d| d.of).sum();
        let middle = doses.iter().map(|d| d.of * d.x).sum::<f64>() / total;
        let (mut level, mut slope) = (0.0, 0.0);
        let mut best = ln_likelihood(&doses, middle, level, slope);
        for _ in 0..STEPS {
            let Some((up, along)) = newton_step(&doses, middle, level, slope) else {
                return Err(LogisticError::Unsettled);
            };
            let mut part = 1.0;
            let (next, value) = loop {
                let next = (level + part * up, slope + part * along);
                let value = ln_likelihood(&doses, middle, next.0, next.1);
                if value >= best || part < 1e-10 {
                    break (next, value);
                }
                part /= 2.0;
            };
            let settled = value - best <= 1e-13 * best.abs().max(1.0);
            if value >= best {
                ((level, slope), best) = (next, value);
            }
            if settled {
                return Ok(Self::finish(&doses, middle, level, slope, best));
            }
        }
        Err(LogisticError::Unsettled)
    }

    fn finish(doses: &[Dose], middle: f64, level: f64, slope: f64, ln_likelihood: f64) -> Self {
        let saturated: f64 = doses.iter().map(|d| term(d, d.share())).sum();
        let deviance = 2.0 * (saturated - ln_likelihood);
        let dispersion = match doses.len() {
            0..=2 => 1.0,
            n => (deviance / (n - 2) as f64).max(1.0),
        };
        let [a, b, c] = information(doses, middle, level, slope);
        let determinant = a * c - b * b;
        let slope_error = if determinant > 0.0 {
            (dispersion * a / determinant).sqrt()
        } else {
            f64::INFINITY
        };
        Self {
            middle,
            level,
            slope,
            slope_error,
            dispersion,
            ln_likelihood,
        }
    }

    /// The chance at a value, 0 to 1.
    pub fn at(&self, x: f64) -> f64 {
        chance(self.level + self.slope * (x - self.middle))
    }

    /// Where the chance is ½; `None` if the curve is level.
    pub fn half(&self) -> Option<f64> {
        let x = self.middle - self.level / self.slope;
        x.is_finite().then_some(x)
    }
}

/// The doses with outcomes, of one value each; that they can be fitted.
fn usable(doses: &[Dose]) -> Result<Vec<Dose>, LogisticError> {
    let valid = |d: &Dose| {
        d.x.is_finite() && d.of.is_finite() && d.of >= 0.0 && (0.0..=d.of).contains(&d.hits)
    };
    if !doses.iter().all(valid) {
        return Err(LogisticError::Invalid);
    }
    let mut doses: Vec<Dose> = doses.iter().copied().filter(|d| d.of > 0.0).collect();
    doses.sort_by(|a, b| a.x.total_cmp(&b.x));
    let (Some(first), Some(last)) = (doses.first(), doses.last()) else {
        return Err(LogisticError::TooFew);
    };
    if first.x >= last.x {
        return Err(LogisticError::TooFew);
    }
    let hits = |d: &&Dose| d.hits > 0.0;
    let misses = |d: &&Dose| d.hits < d.of;
    let span = |keep: &dyn Fn(&&Dose) -> bool| {
        let (first, last) = (doses.iter().find(keep), doses.iter().rfind(keep));
        first.zip(last).map(|(a, b)| (a.x, b.x))
    };
    match (span(&hits), span(&misses)) {
        // A. Albert and J. A. Anderson, Biometrika 71 (1984): overlap is what makes the fit finite.
        (Some(hits), Some(misses)) if hits.0 < misses.1 && misses.0 < hits.1 => Ok(doses),
        _ => Err(LogisticError::Separated),
    }
}

/// The logistic function.
pub(super) fn chance(log_odds: f64) -> f64 {
    1.0 / (1.0 + exp(-log_odds))
}

/// What a dose adds to the logarithm of the likelihood if the chance is `p`.
fn term(dose: &Dose, p: f64) -> f64 {
    let part = |n: f64, p: f64| if n > 0.0 { n * ln(p.max(1e-300)) } else { 0.0 };
    part(dose.hits, p) + part(dose.of - dose.hits, 1.0 - p)
}

/// Logarithm of the likelihood of a curve.
pub(super) fn ln_likelihood(doses: &[Dose], middle: f64, level: f64, slope: f64) -> f64 {
    let at = |d: &Dose| {
        let log_odds = level + slope * (d.x - middle);
        // ln(1 + e^v) without overflow.
        let softplus = |v: f64| v.max(0.0) + ln(1.0 + exp(-v.abs()));
        d.hits * log_odds - d.of * softplus(log_odds)
    };
    doses.iter().map(at).sum()
}

/// The symmetric information matrix of level and slope: [level², level·slope, slope²].
fn information(doses: &[Dose], middle: f64, level: f64, slope: f64) -> [f64; 3] {
    doses.iter().fold([0.0; 3], |[a, b, c], d| {
        let x = d.x - middle;
        let p = chance(level + slope * x);
        let w = d.of * p * (1.0 - p);
        [a + w, b + w * x, c + w * x * x]
    })
}

/// The step of Newton's method; `None` if the information is singular.
fn newton_step(doses: &[Dose], middle: f64, level: f64, slope: f64) -> Option<(f64, f64)> {
    let (mut g0, mut g1) = (0.0, 0.0);
    for d in doses {
        let x = d.x - middle;
        let rest = d.hits - d.of * chance(level + slope * x);
        g0 += rest;
        g1 += rest * x;
    }
    let [a, b, c] = information(doses, middle, level, slope);
    let determinant = a * c - b * b;
    let step = (
        (c * g0 - b * g1) / determinant,
        (a * g1 - b * g0) / determinant,
    );
    (determinant > 0.0 && step.0.is_finite() && step.1.is_finite()).then_some(step)
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    pub fn doses(points: &[(f64, f64, f64)]) -> Vec<Dose> {
        let dose = |&(x, hits, of)| Dose { x, hits, of };
        points.iter().map(dose).collect()
    }

    #[test]
    fn the_beetles_of_bliss_die_as_they_do_in_every_textbook() {
        // C. I. Bliss (1935), beetles killed by carbon disulphide; A. J. Dobson, *An Introduction to
        // Generalized Linear Models*, §7.3.1: β₁ = −60.72, β₂ = 34.27 (error 2.912), deviance 11.23.
        let beetles = doses(&[
            (1.6907, 6.0, 59.0),
            (1.7242, 13.0, 60.0),
            (1.7552, 18.0, 62.0),
            (1.7842, 28.0, 56.0),
            (1.8113, 52.0, 63.0),
            (1.8369, 53.0, 59.0),
            (1.8610, 61.0, 62.0),
            (1.8839, 60.0, 60.0),
        ]);
        let curve = Logistic::fit(&beetles).unwrap();
        assert!((curve.slope - 34.27).abs() < 0.01, "{curve:?}");
        let intercept = curve.level - curve.slope * curve.middle;
        assert!((intercept + 60.72).abs() < 0.01, "{intercept}");
        assert!((curve.dispersion - 11.23 / 6.0).abs() < 0.01, "{curve:?}");
        let error = curve.slope_error / curve.dispersion.sqrt();
        assert!((error - 2.912).abs() < 0.005, "{error}");
        assert!((curve.half().unwrap() - 60.72 / 34.27).abs() < 1e-3);
    }

    #[test]
    fn what_no_curve_fits_is_said() {
        let fit = |points: &[(f64, f64, f64)]| Logistic::fit(&doses(points)).unwrap_err();
        assert_eq!(fit(&[]), LogisticError::TooFew);
        assert_eq!(
            fit(&[(1.0, 3.0, 10.0), (2.0, 0.0, 0.0)]),
            LogisticError::TooFew
        );
        assert_eq!(
            fit(&[(1.0, 3.0, 10.0), (1.0, 5.0, 10.0)]),
            LogisticError::TooFew
        );
        assert_eq!(
            fit(&[(1.0, 0.0, 9.0), (2.0, 0.0, 9.0)]),
            LogisticError::Separated
        );
        assert_eq!(
            fit(&[(1.0, 9.0, 9.0), (2.0, 9.0, 9.0)]),
            LogisticError::Separated
        );
        assert_eq!(
            fit(&[(1.0, 0.0, 9.0), (2.0, 9.0, 9.0)]),
            LogisticError::Separated
        );
        assert_eq!(
            fit(&[(1.0, 0.0, 9.0), (2.0, 4.0, 9.0), (3.0, 9.0, 9.0)]),
            LogisticError::Separated
        );
        assert_eq!(
            fit(&[(1.0, 9.0, 9.0), (2.0, 0.0, 9.0)]),
            LogisticError::Separated
        );
        assert_eq!(
            fit(&[(1.0, 10.0, 9.0), (2.0, 0.0, 9.0)]),
            LogisticError::Invalid
        );
        assert_eq!(
            fit(&[(f64::NAN, 1.0, 9.0), (2.0, 0.0, 9.0)]),
            LogisticError::Invalid
        );
    }

    #[test]
    fn a_level_curve_has_no_middle() {
        let curve = Logistic::fit(&doses(&[(1.0, 3.0, 10.0), (2.0, 3.0, 10.0)])).unwrap();
        assert!(curve.slope.abs() < 1e-9);
        assert!((curve.at(5.0) - 0.3).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn the_fit_is_where_the_likelihood_is_largest(
            shares in prop::collection::vec(0.05_f64..0.95, 2..8), of in 5.0_f64..300.0,
        ) {
            let points: Vec<Dose> = (0_u32..).zip(&shares)
                .map(|(i, share)| Dose { x: 0.8 + 0.3 * f64::from(i), hits: share * of, of })
                .collect();
            let curve = Logistic::fit(&points).unwrap();
            for (dl, ds) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)] {
                let other = ln_likelihood(&points, curve.middle, curve.level + dl, curve.slope + ds);
                prop_assert!(other < curve.ln_likelihood);
            }
            // The fitted hits sum up to the hits: the first likelihood equation.
            let fitted: f64 = points.iter().map(|d| d.of * curve.at(d.x)).sum();
            let hits: f64 = points.iter().map(|d| d.hits).sum();
            prop_assert!((fitted - hits).abs() < 1e-5 * hits);
        }
    }
}
