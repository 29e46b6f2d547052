//! Local pursuit: the path always heads for a virtual prey.
//!
//! r' = ν̂ (rₚ − r) (Eq. 1–2 with Δ = 0, over τ = t / tf, so that ν̂ = ν tf has no dimension and
//! tf drops out of the map), with the prey rₚ a B-spline of degree d and control points Pᵢ
//! (Eq. 9). Instead of the nodes of Eq. 6–8 it is solved exactly: where the prey is a polynomial,
//!
//! r = Σₖ (−1)^k rₚ^(k) / ν̂^k + A e^(−ν̂ τ),
//!
//! with A from continuity. So r = r₀ e^(−ν̂ τ) + Σᵢ φᵢ(τ) Pᵢ, linear in the control points. A φᵢ is
//! a bump with a tail that decays like e^(−ν̂ τ); ψᵢ = φᵢ + cᵢ φᵢ₊₁ with the cᵢ that cancels the
//! tails is 0 beyond the supports of both, which keeps the programs sparse. This is only another
//! basis of the same curves: r = … + Σᵢ ψᵢ Qᵢ with Pᵢ = Qᵢ + cᵢ₋₁ Qᵢ₋₁.
//!
//! Boundary conditions: r'(0) = ν̂ (P₀ − r₀), so P₀ is on the ray of the start's heading (Eq. 13);
//! r(1) is the goal, which determines the last control point. A prescribed heading at the goal puts
//! the last one on its ray; then r(1) determines the last but one.

use geometry::math;
use nalgebra::Vector2;

use super::{Curve, Ends, Row, Trace};
use crate::bspline_basis::{Basis, MAX_DEGREE, Values};

/// ν̂. With larger values the path is nearly the prey's own; with smaller ones the prey runs far
/// ahead.
pub const PURSUIT_RATE: f64 = 60.0;

/// Curves that pursue a prey; see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Pursuit {
    basis: Basis,
    ends: Ends,
    /// cᵢ.
    mix: Vec<f64>,
    /// By span: amplitudes of the exponentials of the ψᵢ that have one there.
    tails: Vec<Vec<(usize, f64)>>,
    /// ψᵢ(1) / ψₑ(1), where not 0, e being the control point that the goal determines.
    shares: Vec<(usize, f64)>,
    determined: usize,
    /// ψₑ(1).
    at_end: f64,
    /// Variables that are not coordinates of control points.
    rays: usize,
}

/// Share of a bump below which amplitudes count as 0.
const NOTHING: f64 = 1e-13;

impl Pursuit {
    /// Creates the curves that pursue preys over a basis of degree 2 or more; `None` if it has too
    /// few functions for the boundary conditions.
    pub fn new(basis: Basis, ends: Ends) -> Option<Self> {
        let n = basis.len();
        let determined = n - 1 - usize::from(ends.goal_heading.is_some());
        let rays =
            usize::from(ends.start_heading.is_some()) + usize::from(ends.goal_heading.is_some());
        if n < 2 + rays || basis.degree() < 2 {
            return None;
        }
        let mut pursuit = Self {
            mix: vec![0.0; n],
            tails: Vec::new(),
            shares: Vec::new(),
            determined,
            at_end: 1.0,
            rays,
            basis,
            ends,
        };
        pursuit.solve();
        let mut end = Vec::new();
        pursuit.bumps(1.0, 0, &mut end);
        let at_end = end.iter().find(|(i, _)| *i == determined)?.1;
        // A prey whose last leg is far too short for the pursuit.
        if at_end.abs() < 1e-3 {
            return None;
        }
        pursuit.at_end = at_end;
        end.retain(|&(i, value)| i != determined && value.abs() > NOTHING);
        pursuit.shares = end
            .into_iter()
            .map(|(i, value)| (i, value / at_end))
            .collect();
        Some(pursuit)
    }

    /// Computes the amplitudes span by span, then the coefficients that cancel the tails.
    fn solve(&mut self) {
        let (n, degree) = (self.basis.len(), self.basis.degree());
        let breaks = self.basis.breaks().to_vec();
        let spans = breaks.len() - 1;
        // φᵢ at the beginning of the span, and amplitudes by span.
        let mut value = vec![0.0; n];
        let mut raw = vec![vec![0.0; n]; spans];
        for span in 0..spans {
            let begin = self.basis.values(span, breaks[span], degree);
            let end = self.basis.values(span, breaks[span + 1], degree);
            let decay = math::exp(-PURSUIT_RATE * (breaks[span + 1] - breaks[span]));
            for i in 0..n {
                let (mut p0, mut p1) = (0.0, 0.0);
                if i >= begin.first && i <= begin.first + degree {
                    p0 = particular(&begin, i - begin.first, 0, degree);
                    p1 = particular(&end, i - begin.first, 0, degree);
                }
                let amplitude = value[i] - p0;
                raw[span][i] = amplitude;
                value[i] = p1 + amplitude * decay;
            }
        }
        for i in 0..n - 1 {
            let end = self.basis.support_end(i + 1);
            if end >= 1.0 {
                continue;
            }
            let span = self.basis.span(end);
            let (tail, next) = (raw[span][i], raw[span][i + 1]);
            if next.abs() > 0.0 {
                self.mix[i] = -tail / next;
            }
        }
        self.tails = (0..spans)
            .map(|span| {
                let after = breaks[span];
                let amplitude = |i: usize| {
                    // Beyond both supports the two cancel, except for rounding.
                    if i + 1 < n && self.mix[i] != 0.0 && self.basis.support_end(i + 1) <= after {
                        return 0.0;
                    }
                    let next = if i + 1 < n { raw[span][i + 1] } else { 0.0 };
                    raw[span][i] + self.mix[i] * next
                };
                (0..n)
                    .map(|i| (i, amplitude(i)))
                    .filter(|(_, a)| a.abs() > NOTHING)
                    .collect()
            })
            .collect();
    }

    /// The non-zero ψᵢ at τ, or their derivatives.
    fn bumps(&self, at: f64, order: usize, found: &mut Vec<(usize, f64)>) {
        found.clear();
        let span = self.basis.span(at);
        let degree = self.basis.degree();
        let values = self.basis.values(span, at, degree);
        let mut add = |i: usize, value: f64| match found.iter_mut().find(|(j, _)| *j == i) {
            Some((_, sum)) => *sum += value,
            None => found.push((i, value)),
        };
        for r in 0..=degree {
            let i = values.first + r;
            let p = particular(&values, r, order, degree);
            add(i, p);
            if i > 0 && self.mix[i - 1] != 0.0 {
                add(i - 1, self.mix[i - 1] * p);
            }
        }
        let begin = self.basis.breaks()[span];
        let decay = math::exp(-PURSUIT_RATE * (at - begin)) * (-PURSUIT_RATE).powi(order as i32);
        for &(i, amplitude) in &self.tails[span] {
            add(i, amplitude * decay);
        }
    }

    /// The control points of the prey for these variables.
    pub fn prey(&self, z: &[f64]) -> Vec<Vector2<f64>> {
        let n = self.basis.len();
        let mut row = Row::default();
        let mut q = vec![Vector2::zeros(); n];
        for (i, point) in q.iter_mut().enumerate() {
            if i != self.determined {
                row.clear();
                self.add(i, 1.0, z, &mut row);
                *point = row.value;
            }
        }
        let others: Vector2<f64> = self.shares.iter().map(|&(i, share)| q[i] * share).sum();
        q[self.determined] = self.goal_pull() - others;
        (0..n)
            .map(|i| {
                let before = if i > 0 {
                    q[i - 1] * self.mix[i - 1]
                } else {
                    Vector2::zeros()
                };
                q[i] + before
            })
            .collect()
    }

    /// The part of the determined Q that does not depend on the others.
    fn goal_pull(&self) -> Vector2<f64> {
        (self.ends.goal - self.ends.start * math::exp(-PURSUIT_RATE)) / self.at_end
    }

    fn add(&self, i: usize, c: f64, z: &[f64], row: &mut Row) {
        let n = self.basis.len();
        let mut put = |var: usize, term: Vector2<f64>| {
            row.value += term * z[var];
            row.terms.push((var, term));
        };
        let started = usize::from(self.ends.start_heading.is_some());
        match (i, self.ends.start_heading, self.ends.goal_heading) {
            // The speed itself is the variable: r'(0) = ν̂ (P₀ − r₀) = a·heading.
            (0, Some(heading), _) => {
                put(0, heading * (c / PURSUIT_RATE));
                row.value += self.ends.start * c;
            }
            (_, _, Some(heading)) if i == n - 1 => {
                put(started, heading * (c / PURSUIT_RATE));
                row.value += self.ends.goal * c;
            }
            _ => {
                // Position among the free ones: all except the ray at the start and the determined
                // one.
                let skipped = started + usize::from(i > self.determined);
                let var = self.rays + 2 * (i - skipped);
                put(var, Vector2::new(c, 0.0));
                put(var + 1, Vector2::new(0.0, c));
            }
        }
    }

    fn combine(&self, at: f64, order: usize, z: &[f64], row: &mut Row) {
        let mut bumps = Vec::with_capacity(2 * MAX_DEGREE);
        self.bumps(at, order, &mut bumps);
        let own = bumps
            .iter()
            .find(|(i, _)| *i == self.determined)
            .map_or(0.0, |(_, value)| *value);
        if own != 0.0 {
            for &(i, share) in &self.shares {
                match bumps.iter_mut().find(|(j, _)| *j == i) {
                    Some((_, value)) => *value -= own * share,
                    None => bumps.push((i, -own * share)),
                }
            }
        }
        row.clear();
        for &(i, value) in &bumps {
            if i != self.determined && value != 0.0 {
                self.add(i, value, z, row);
            }
        }
        let decay = math::exp(-PURSUIT_RATE * at) * (-PURSUIT_RATE).powi(order as i32);
        row.value += self.goal_pull() * own + self.ends.start * decay;
    }
}

/// Σₖ (−1)^k B^(k + order) / ν̂^k of one function.
fn particular(values: &Values, r: usize, order: usize, degree: usize) -> f64 {
    let mut sum = 0.0;
    let mut factor = 1.0;
    for k in order..=degree {
        sum += factor * values.by_order[k][r];
        factor /= -PURSUIT_RATE;
    }
    sum
}

impl Curve for Pursuit {
    fn degree(&self) -> usize {
        self.basis.degree()
    }

    fn variables(&self) -> usize {
        self.rays + 2 * (self.basis.len() - 1 - self.rays)
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn row(&self, at: f64, order: usize, z: &[f64], row: &mut Row) {
        self.combine(at, order, z, row);
    }

    fn trace(&self, z: &[f64]) -> Trace<'_> {
        let prey = self.prey(z);
        let degree = self.basis.degree();
        let breaks = self.basis.breaks();
        let follow = move |span: usize, at: f64, prey: &[Vector2<f64>]| {
            let values = self.basis.values(span, at, degree);
            let near = prey[values.first..=values.first + degree]
                .iter()
                .enumerate();
            near.fold([Vector2::zeros(); 3], |mut sums, (r, p)| {
                for (order, sum) in sums.iter_mut().enumerate() {
                    *sum += p * particular(&values, r, order, degree);
                }
                sums
            })
        };
        // The rest of the initial value of each span, which decays along it.
        let mut at = self.ends.start;
        let mut left = Vec::with_capacity(breaks.len() - 1);
        for (span, pair) in breaks.windows(2).enumerate() {
            let amplitude = at - follow(span, pair[0], &prey)[0];
            let decay = math::exp(-PURSUIT_RATE * (pair[1] - pair[0]));
            at = follow(span, pair[1], &prey)[0] + amplitude * decay;
            left.push(amplitude);
        }
        Box::new(move |at| {
            let span = self.basis.span(at);
            let mut decay = math::exp(-PURSUIT_RATE * (at - breaks[span]));
            follow(span, at, &prey).map(|value| {
                let value = value + left[span] * decay;
                decay *= -PURSUIT_RATE;
                value
            })
        })
    }

    fn ends(&self) -> &Ends {
        &self.ends
    }

    fn breaks(&self) -> &[f64] {
        self.basis.breaks()
    }

    fn control_points(&self) -> usize {
        self.basis.len()
    }
}
