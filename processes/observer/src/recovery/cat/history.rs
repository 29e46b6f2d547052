//! Histories of the wraps between points: all that are likely enough.

use core::ops::RangeInclusive;
use std::collections::VecDeque;

use super::{MAX_STEPS, MAX_WINDOW};

/// Maximum squared deviation from the prediction (variances): one in eight thousand is larger.
const GATE: f64 = 18.0;

/// Maximum deviation of an observed coordinate from a recovered orbit (standard deviations).
const TOLERANCE: f64 = 6.0;

/// Bound beyond which wraps are invalid; those of [`MAX_STEPS`] are far fewer.
const MAX_WRAP: f64 = 1e6;

/// Observed point.
#[derive(Debug, Clone, Copy)]
pub struct ObservedPoint {
    pub(super) point: [f64; 2],
    /// Standard deviation of each coordinate.
    pub(super) sd: f64,
}

impl ObservedPoint {
    /// Returns `true` if a point of the torus is within the tolerance, by coordinate.
    pub(super) fn close(&self, other: [f64; 2]) -> bool {
        self.point.iter().zip(other).all(|(a, b)| {
            let difference = a - b;
            (difference - difference.round()).abs() <= TOLERANCE * self.sd
        })
    }
}

/// Wraps between the points of the window, and the current state of the orbit.
#[derive(Debug, Clone)]
pub struct History {
    /// One per step; those of steps without a point are part of the next one's.
    pub(super) wraps: VecDeque<[i64; 2]>,
    /// Estimate of the last point, and its covariance: xx, xy, yy.
    z: [f64; 2],
    p: [f64; 3],
    /// Cost of its points: minus the logarithm of their likelihood against that of points anywhere
    /// in the square.
    pub(super) cost: f64,
}

impl History {
    pub(super) fn new(seen: &ObservedPoint) -> Self {
        let variance = seen.sd * seen.sd;
        Self {
            wraps: VecDeque::new(),
            z: seen.point,
            p: [variance, 0.0, variance],
            cost: 0.0,
        }
    }

    /// Appends every possible continuation with the next point, `steps` on, to `into`.
    pub(super) fn extend<'a>(&'a self, steps: u32, seen: &ObservedPoint, into: &mut Vec<Next<'a>>) {
        // M to the power of the steps: ((p, q), (q, p + q)).
        let (mut p, mut q) = (1.0, 1.0);
        for _ in 1..steps {
            (p, q) = (p + q, p + 2.0 * q);
        }
        let r = p + q;
        let [x, y] = self.z;
        let [xx, xy, yy] = self.p;
        let ahead = [p * x + q * y, q * x + r * y];
        // M P Mᵀ, and the sum with the noise of the point.
        let [a, b, c] = [
            p * p * xx + 2.0 * p * q * xy + q * q * yy,
            p * q * xx + (p * r + q * q) * xy + q * r * yy,
            q * q * xx + 2.0 * q * r * xy + r * r * yy,
        ];
        let noise = seen.sd * seen.sd;
        let (sa, sc) = (a + noise, c + noise);
        let determinant = sa * sc - b * b;
        if !(determinant > 0.0 && determinant.is_finite()) {
            return;
        }
        let off = [ahead[0] - seen.point[0], ahead[1] - seen.point[1]];
        // One row of wraps after the other: the second given the first lies in a narrow range.
        for first in whole_numbers(off[0], (GATE * sa).sqrt()) {
            let dx = off[0] - first as f64;
            let rest = GATE - dx * dx / sa;
            let spread = (rest.max(0.0) * determinant / sa).sqrt();
            for second in whole_numbers(off[1] - dx * b / sa, spread) {
                let dy = off[1] - second as f64;
                let (u, v) = (
                    (sc * dx - b * dy) / determinant,
                    (sa * dy - b * dx) / determinant,
                );
                into.push(Next {
                    history: self,
                    wraps: [first, second],
                    z: [seen.point[0] + noise * u, seen.point[1] + noise * v],
                    // R − R S⁻¹ R.
                    p: [
                        noise - noise * noise * sc / determinant,
                        noise * noise * b / determinant,
                        noise - noise * noise * sa / determinant,
                    ],
                    cost: self.cost
                        + 0.5 * (dx * u + dy * v)
                        + 0.5 * libm::log(determinant)
                        + libm::log(core::f64::consts::TAU),
                });
            }
        }
    }
}

/// Possible continuation of a history.
pub struct Next<'a> {
    history: &'a History,
    wraps: [i64; 2],
    z: [f64; 2],
    p: [f64; 3],
    pub(super) cost: f64,
}

impl Next<'_> {
    pub(super) fn history(&self, steps: u32) -> History {
        let mut wraps = VecDeque::with_capacity(MAX_WINDOW + MAX_STEPS as usize);
        wraps.extend(&self.history.wraps);
        wraps.extend((1..steps).map(|_| [0, 0]));
        wraps.push_back(self.wraps);
        History {
            wraps,
            z: self.z,
            p: self.p,
            cost: self.cost,
        }
    }
}

/// Returns the integers within `spread` of a number; none where they could not be counted.
fn whole_numbers(center: f64, spread: f64) -> RangeInclusive<i64> {
    let (low, high) = ((center - spread).ceil(), (center + spread).floor());
    if low.abs().max(high.abs()) < MAX_WRAP {
        low as i64..=high as i64
    } else {
        RangeInclusive::new(1, 0)
    }
}
