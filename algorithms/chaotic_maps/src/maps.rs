//! Chaotic maps of other coverage papers, as drop-in sources for comparison: logistic and
//! standard map (Chirikov–Taylor), both in `f64`.
//!
//! Arnold's map is [`crate::CatP`]. Like every map in `f64`, these eventually enter a cycle; they
//! serve measurements, not protection.

use core::f64::consts::{FRAC_2_PI, TAU};

use crate::chebyshev::Emission;
use crate::error::KeyError;
use crate::source::Source;

/// Distance within which a value counts as degenerate.
const TOLERANCE: f64 = 1e-9;

fn require(
    ok: bool,
    kind: &str,
    name: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<(), KeyError> {
    if ok {
        Ok(())
    } else {
        Err(KeyError::OutOfRange {
            kind: kind.to_owned(),
            name,
            value: value.to_string(),
            expected,
        })
    }
}

/// One logistic map `x' = 4x(1 − x)` per axis (Volos et al. 2013; Li et al. 2013).
///
/// Its distribution is the arcsine law on [0, 1]; the transform to uniform points is
/// `2·asin(√x)/π`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logistic {
    x: f64,
    y: f64,
    emission: Emission,
}

impl Logistic {
    /// Starts from a point of the unit square.
    ///
    /// # Errors
    /// [`KeyError`] when a value is not in (0, 1), when it is within 1e-9 of 0, 1/4, 1/2, 3/4 or 1
    /// (at a fixed point after two steps), or when `y` is `x` or `1 − x`.
    pub fn new(x: f64, y: f64, emission: Emission) -> Result<Self, KeyError> {
        let kind = emission.kind_of("logistic");
        for (name, value) in [("x", x), ("y", y)] {
            require(
                (0.0..=1.0).contains(&value),
                &kind,
                name,
                value,
                "above 0 and below 1",
            )?;
            if [0.0, 0.25, 0.5, 0.75, 1.0]
                .iter()
                .any(|special| (value - special).abs() <= TOLERANCE)
            {
                return Err(KeyError::FixedPoint {
                    kind,
                    name,
                    value,
                    values: "0, 1/4, 1/2, 3/4 and 1",
                });
            }
        }
        if (x - y).abs() <= TOLERANCE || (x + y - 1.0).abs() <= TOLERANCE {
            return Err(KeyError::Linked {
                kind,
                x: x.to_string(),
                y: y.to_string(),
            });
        }
        Ok(Self { x, y, emission })
    }
}

impl Source for Logistic {
    fn next_unit(&mut self) -> [f64; 2] {
        for c in [&mut self.x, &mut self.y] {
            *c = 4.0 * *c * (1.0 - *c);
        }
        [self.x, self.y].map(|c| match self.emission {
            Emission::Raw => c,
            Emission::Arcsine => FRAC_2_PI * libm::asin(c.sqrt()),
        })
    }
}

/// The standard map `p' = p + K·sin θ`, `θ' = θ + p'` modulo 2π (Martins-Filho and Macau 2007; Li
/// et al. 2015). The point is `(θ, p)/2π`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standard {
    theta: f64,
    p: f64,
    k: f64,
}

impl Standard {
    /// The parameter `K` of the published robots.
    pub const K: f64 = 7.0;

    /// Starts from a point of the unit square, `θ = 2πx`, `p = 2πy`.
    ///
    /// # Errors
    /// [`KeyError`] when a value is not in [0, 1), when the point is within 1e-9 of a fixed point
    /// (`x` 0 or 1/2 and `y` 0), or when `k` is not between 1 and 1000: below 0.9716 curves that
    /// no orbit crosses divide the square, above 1000 rounding takes the digits.
    pub fn new(x: f64, y: f64, k: f64) -> Result<Self, KeyError> {
        for (name, value) in [("x", x), ("y", y)] {
            require(
                (0.0..1.0).contains(&value),
                "standard",
                name,
                value,
                "at least 0 and below 1",
            )?;
        }
        require(
            (1.0..=1000.0).contains(&k),
            "standard",
            "k",
            k,
            "between 1 and 1000 (7 is usual)",
        )?;
        let near = |value: f64, special: f64| (value - special).abs() <= TOLERANCE;
        if (near(y, 0.0) || near(y, 1.0)) && [0.0, 0.5, 1.0].iter().any(|&s| near(x, s)) {
            return Err(KeyError::FixedPoint {
                kind: "standard".to_owned(),
                name: "x",
                value: x,
                values: "0 and 1/2 where y is 0",
            });
        }
        Ok(Self {
            theta: TAU * x,
            p: TAU * y,
            k,
        })
    }
}

/// `angle` in [0, 2π).
fn wrap(angle: f64) -> f64 {
    let wrapped = angle - TAU * (angle / TAU).floor();
    // Rounding may give either end.
    if (0.0..TAU).contains(&wrapped) {
        wrapped
    } else {
        0.0
    }
}

impl Source for Standard {
    fn next_unit(&mut self) -> [f64; 2] {
        self.p = wrap(self.p + self.k * libm::sin(self.theta));
        self.theta = wrap(self.theta + self.p);
        [self.theta / TAU, self.p / TAU]
    }
}

#[cfg(test)]
mod tests;
