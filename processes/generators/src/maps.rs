//! Chaotic maps of other coverage papers, as drop-in sources for comparison: logistic, standard
//! (Chirikov–Taylor) and Hénon map, all in `f64`.
//!
//! Arnold's map is [`crate::CatP`]. Like every map in `f64`, these end in a cycle some day; they
//! serve measurements, not protection.

use core::f64::consts::{FRAC_2_PI, TAU};

use crate::chebyshev::Emission;
use crate::error::KeyError;
use crate::source::{Source, symmetric_to_unit};

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
/// Its law is the arcsine law on [0, 1]; the transform to uniform points is `2·asin(√x)/π`.
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
        let kind = crate::KeyKind::Logistic(emission).to_string();
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
            Emission::Arccosine => FRAC_2_PI * libm::acos(c.sqrt()),
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
    // Rounding may leave either end.
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

/// The Hénon map `x' = 1 − 1.4x² + y`, `y' = 0.3x` (Curiac and Volosencu 2014).
///
/// Its points lie on the strange attractor, which the affine map of its bounding box spreads over
/// the square: coverage of the square is not to be expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Henon {
    x: f64,
    y: f64,
}

/// Bounds of `x` on the attractor; `y` is 0.3 times the one before.
const HENON_X: [f64; 2] = [-1.285, 1.273];

/// Steps that tell whether a start lies in the basin: outside, squares grow beyond any bound in a
/// few dozen.
const BASIN_STEPS: u32 = 10_000;

impl Henon {
    /// Starts from a point in the basin of the attractor.
    ///
    /// # Errors
    /// [`KeyError`] when the orbit escapes to infinity or the point is within 1e-9 of the fixed
    /// point (0.6313544770895…, 0.1894063431268…).
    pub fn new(x: f64, y: f64) -> Result<Self, KeyError> {
        for (name, value) in [("x", x), ("y", y)] {
            require(value.is_finite(), "henon", name, value, "a finite number")?;
        }
        let fixed = (609.0_f64.sqrt() - 7.0) / 28.0;
        if (x - fixed).abs() <= TOLERANCE && (y - 0.3 * fixed).abs() <= TOLERANCE {
            return Err(KeyError::FixedPoint {
                kind: "henon".to_owned(),
                name: "x",
                value: x,
                values: "0.63135447709 with y = 0.18940634313",
            });
        }
        let start = Self { x, y };
        let mut ahead = start;
        for _ in 0..BASIN_STEPS {
            ahead.step();
            if ahead.x.is_nan() || ahead.x.abs() > 1e3 {
                return Err(KeyError::Escapes { x, y });
            }
        }
        Ok(start)
    }

    fn step(&mut self) {
        (self.x, self.y) = (1.0 - 1.4 * self.x * self.x + self.y, 0.3 * self.x);
    }
}

impl Source for Henon {
    fn next_unit(&mut self) -> [f64; 2] {
        symmetric_to_unit(self.next_symmetric())
    }

    fn next_symmetric(&mut self) -> [f64; 2] {
        self.step();
        let [low, high] = HENON_X;
        // A start off the attractor may reach it from outside the box.
        [self.x, self.y / 0.3].map(|c| (2.0 * (c - low) / (high - low) - 1.0).clamp(-1.0, 1.0))
    }
}

#[cfg(test)]
mod tests;
