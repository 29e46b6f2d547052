//! Estimate of the state in the middle of a window from the wraps on both sides of it.

use std::collections::VecDeque;

use super::ring::{FRACTION, State};
use super::{CatRecovery, MAX_WINDOW};

/// `φ⁻ʲ/√5` for `j` from −1 on, in units of 2⁻¹²⁰.
///
/// It is `F(180 − j)/L(180)` with Fibonacci and Lucas numbers up to a relative error below 2⁻⁶⁸ at
/// the end of the table and 2⁻²⁴⁰ at its start, which keeps the integers in 128 bits.
static POWERS: [i128; MAX_WINDOW + 4] = powers();

const fn powers() -> [i128; MAX_WINDOW + 4] {
    let mut fibonacci = [0_u128; 182];
    fibonacci[1] = 1;
    let mut i = 2;
    while i < fibonacci.len() {
        fibonacci[i] = fibonacci[i - 1] + fibonacci[i - 2];
        i += 1;
    }
    let lucas = fibonacci[181] + fibonacci[179];
    let mut table = [0; MAX_WINDOW + 4];
    let mut j = 0;
    while j < table.len() {
        // Long division, a bit at a time; the numerator is below the denominator.
        let (mut rest, mut quotient, mut bit) = (fibonacci[181 - j], 0_u128, 0);
        while bit < FRACTION {
            rest *= 2;
            quotient *= 2;
            if rest >= lucas {
                rest -= lucas;
                quotient += 1;
            }
            bit += 1;
        }
        table[j] = quotient as i128;
        j += 1;
    }
    table
}

impl CatRecovery {
    /// Estimates the state at `middle` from the wraps between `first` and `last`, where points were
    /// observed.
    ///
    /// With `U = x + φy` (which the map multiplies by φ²) and `S = φx − y` (by φ⁻²) it is
    /// `x = (U/φ + S)/√5`, `y = (U − S/φ)/√5`, where
    /// `U = Σ φ^(−2m−2) (k + φl) + φ^(−2d) U_last` over the wraps `(k, l)`, `m` steps ahead of the
    /// middle, and `S = φ^(−2c) S_first − Σ φ^(−2m) (φk − l)` over those before it.
    ///
    /// Whole turns do not matter, so that sums may overflow.
    pub(super) fn estimate(
        &self,
        wraps: &VecDeque<[i64; 2]>,
        first: usize,
        middle: usize,
        last: usize,
    ) -> Option<State> {
        let power = |j: usize| POWERS.get(j + 1).copied();
        let minus_one = |j: usize| POWERS.get(j).copied(); // φ^(1−j)/√5
        let tail = |weight: i128, c: f64| (weight as f64 * c) as i128;
        let wrap = |j: usize| wraps.get(j).map(|wrap| wrap.map(i128::from));
        let point = |j: usize| self.window.get(j)?.as_ref().map(|seen| seen.point);
        let (mut x, mut y) = (0_i128, 0_i128);
        let add = |sum: &mut i128, factor: i128, power: i128| {
            *sum = sum.wrapping_add(factor.wrapping_mul(power));
        };
        for j in middle..last {
            let ([k, l], m) = (wrap(j)?, j - middle);
            add(&mut x, k, power(2 * m + 3)?);
            add(&mut x, l, power(2 * m + 2)?);
            add(&mut y, k, power(2 * m + 2)?);
            add(&mut y, l, power(2 * m + 1)?);
        }
        for j in first..middle {
            let ([k, l], m) = (wrap(j)?, middle - 1 - j);
            add(&mut x, l, power(2 * m)?);
            add(&mut x, -k, minus_one(2 * m)?);
            add(&mut y, k, power(2 * m)?);
            add(&mut y, -l, power(2 * m + 1)?);
        }
        let (c, d) = (middle - first, last - middle);
        let [end_x, end_y] = point(last)?;
        let [start_x, start_y] = point(first)?;
        for term in [
            tail(power(2 * d + 1)?, end_x),
            tail(power(2 * d)?, end_y),
            tail(minus_one(2 * c)?, start_x),
            -tail(power(2 * c)?, start_y),
        ] {
            x = x.wrapping_add(term);
        }
        for term in [
            tail(power(2 * d)?, end_x),
            tail(minus_one(2 * d)?, end_y),
            tail(power(2 * c + 1)?, start_y),
            -tail(power(2 * c)?, start_x),
        ] {
            y = y.wrapping_add(term);
        }
        Some(State {
            a: self.modulus.round(x),
            b: self.modulus.round(y),
            modulus: self.modulus,
        })
    }
}
