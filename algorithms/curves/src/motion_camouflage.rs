//! B-splines, alone or as the prey of motion camouflage.
//!
//! Motion camouflage (Eq. 16): r = R + ν (rₚ − R), with the prey rₚ a B-spline (Eq. 19)
//! and the path control parameter ν given by its values at N + 1 Legendre–Gauss–Lobatto nodes
//! (Eq. 20). Without it, ν = 1: the path is the prey's.
//!
//! Variables: the speed r'(0) in the start's heading, if that is prescribed, the same at the goal,
//! the free control points, and μⱼ = (νⱼ − 1) |R − r₀| at the inner nodes. The scale of μ makes a
//! step move the path about equally far for every reference point. ν is 1 at both ends (the paper's
//! PCPs from the boundary conditions), so that the prey begins and ends with the path. The
//! reference point is fixed: with the whole prey free, moving it adds no new paths.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{Curve, Ends, Row, Trace};
use crate::bspline_basis::{Basis, Values};
use crate::lgl_nodes::Lgl;

/// Parameters of motion camouflage.
#[derive(Debug, Clone, PartialEq)]
pub struct Camouflage {
    lgl: Lgl,
    differentiation: DMatrix<f64>,
    reference: Vector2<f64>,
    /// Distance from the start to the reference point, > 0.
    scale: f64,
    /// Derivatives of ν' by the inner nodes' μ at both ends.
    slopes: [Vec<f64>; 2],
}

/// Cost of μ: it regularises the redundancy of the prey and ν.
const COST: f64 = 1e-2;
/// Maximum step of μ (length) for which the linearisation is valid.
const STEP: f64 = 0.5;

impl Camouflage {
    /// Creates camouflage in front of a reference point, seen from the start; `None` if the two are
    /// (nearly) the same.
    pub fn new(nodes: usize, reference: Vector2<f64>, start: Vector2<f64>) -> Option<Self> {
        let scale = (reference - start).norm();
        if !(scale > 1e-3 && scale.is_finite()) {
            return None;
        }
        let lgl = Lgl::new(nodes.max(2));
        let differentiation = lgl.differentiation();
        let slope = |at: f64| {
            let [_, first] = lgl.interpolation(at, &differentiation);
            inner(&first).iter().map(|d| 2.0 * d / scale).collect()
        };
        let slopes = [slope(-1.0), slope(1.0)];
        Some(Self {
            lgl,
            differentiation,
            reference,
            scale,
            slopes,
        })
    }

    fn count(&self) -> usize {
        self.lgl.nodes.len() - 2
    }

    /// Derivatives of ν of orders 0 and 1 at τ by the inner μ.
    fn weights(&self, at: f64, order: usize) -> [Vec<f64>; 2] {
        let at = 2.0 * at - 1.0;
        let scaled = |row: &[f64], factor: f64| -> Vec<f64> {
            inner(row).iter().map(|w| w * factor / self.scale).collect()
        };
        if order == 0 {
            return [scaled(&self.lgl.values(at), 1.0), Vec::new()];
        }
        let [values, first] = self.lgl.interpolation(at, &self.differentiation);
        [scaled(&values, 1.0), scaled(&first, 2.0)]
    }

    /// ν and its first two derivatives with respect to τ, from its values at the nodes.
    fn interpolant(&self, nu: &[f64]) -> impl Fn(f64) -> [f64; 3] + '_ {
        let nu = DVector::from_column_slice(nu);
        // Eq. 20: the derivatives at the nodes, of which the derivatives are interpolants.
        let first = &self.differentiation * &nu * 2.0;
        let second = &self.differentiation * &first * 2.0;
        move |at| {
            let values = self.lgl.values(2.0 * at - 1.0);
            [&nu, &first, &second].map(|row| row.iter().zip(&values).map(|(n, v)| n * v).sum())
        }
    }
}

/// Returns the row without its two ends.
fn inner(row: &[f64]) -> &[f64] {
    row.get(1..row.len() - 1).unwrap_or(&[])
}

/// B-spline curves; see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    basis: Basis,
    ends: Ends,
    camouflage: Option<Camouflage>,
    /// The first variable of the free control points.
    first_point: usize,
    /// The first free control point, and one beyond the last.
    free: [usize; 2],
}

impl Spline {
    /// Creates the curves over a basis; `None` if it has fewer functions than there are boundary
    /// conditions.
    pub fn new(basis: Basis, ends: Ends, camouflage: Option<Camouflage>) -> Option<Self> {
        let low = 1 + usize::from(ends.start_heading.is_some());
        let high = basis.len() - 1 - usize::from(ends.goal_heading.is_some());
        let conditions =
            usize::from(ends.start_heading.is_some()) + usize::from(ends.goal_heading.is_some());
        (low <= high).then_some(Self {
            basis,
            ends,
            camouflage,
            first_point: conditions,
            free: [low, high],
        })
    }

    /// The variables of this curve that come nearest to those of the same spline without
    /// camouflage: the same path.
    pub fn hidden(&self, z: &[f64]) -> Vec<f64> {
        let mut all = z.to_vec();
        all.resize(self.variables(), 0.0);
        all
    }

    /// ν at the N + 1 nodes; empty without camouflage.
    pub fn path_control(&self, z: &[f64]) -> Vec<f64> {
        let Some(camouflage) = &self.camouflage else {
            return Vec::new();
        };
        let inner = z[self.first_mu()..]
            .iter()
            .map(|mu| 1.0 + mu / camouflage.scale);
        core::iter::once(1.0).chain(inner).chain([1.0]).collect()
    }

    /// The control points of the prey (without camouflage, of the path itself).
    pub fn prey_points(&self, z: &[f64]) -> Vec<Vector2<f64>> {
        let mut row = Row::default();
        let point = |i: usize| {
            row.clear();
            self.add(i, 1.0, z, &mut row);
            row.value
        };
        (0..self.basis.len()).map(point).collect()
    }

    fn first_mu(&self) -> usize {
        self.first_point + 2 * (self.free[1] - self.free[0])
    }

    /// Speed per distance between the first two control points, and between the last two.
    fn end_rates(&self) -> [f64; 2] {
        let breaks = self.basis.breaks();
        let p = self.basis.degree() as f64;
        let n = breaks.len();
        [
            p / (breaks[1] - breaks[0]),
            p / (breaks[n - 1] - breaks[n - 2]),
        ]
    }

    /// Adds c Pᵢ for a control point to value and terms.
    fn add(&self, i: usize, c: f64, z: &[f64], row: &mut Row) {
        let last = self.basis.len() - 1;
        let Ends { start, goal, .. } = self.ends;
        let mut put = |var: usize, term: Vector2<f64>| {
            row.value += term * z[var];
            row.terms.push((var, term));
        };
        if i >= self.free[0] && i < self.free[1] {
            let var = self.first_point + 2 * (i - self.free[0]);
            put(var, Vector2::new(c, 0.0));
            put(var + 1, Vector2::new(0.0, c));
            return;
        }
        let [first_rate, last_rate] = self.end_rates();
        // r'(0) = ν'(0) (P₀ − R) + rate (P₁ − P₀) must be a·heading, and likewise at the goal.
        let (end, heading, rate, var, side) = match i {
            0 => (start, None, 0.0, 0, 0),
            _ if i == last => (goal, None, 0.0, 0, 0),
            1 if self.ends.start_heading.is_some() => {
                (start, self.ends.start_heading, first_rate, 0, 0)
            }
            _ => {
                let var = usize::from(self.ends.start_heading.is_some());
                (goal, self.ends.goal_heading, -last_rate, var, 1)
            }
        };
        if let Some(heading) = heading {
            put(var, heading * (c / rate));
            if let Some(camouflage) = &self.camouflage {
                let arm = (end - camouflage.reference) * (-c / rate);
                let first = self.first_mu();
                for (j, slope) in camouflage.slopes[side].iter().enumerate() {
                    put(first + j, arm * *slope);
                }
            }
        }
        row.value += end * c;
    }

    /// The prey's position or derivative.
    fn prey(&self, values: &Values, order: usize, factor: f64, z: &[f64], row: &mut Row) {
        for r in 0..=self.basis.degree() {
            let c = values.by_order[order][r];
            if c != 0.0 {
                self.add(values.first + r, c * factor, z, row);
            }
        }
    }

    /// ν and its derivative.
    fn control(&self, weights: &[Vec<f64>; 2], z: &[f64]) -> [f64; 2] {
        let mu = &z[self.first_mu()..];
        let sum = |row: &Vec<f64>| -> f64 { row.iter().zip(mu).map(|(w, m)| w * m).sum() };
        [1.0 + sum(&weights[0]), sum(&weights[1])]
    }
}

impl Curve for Spline {
    fn degree(&self) -> usize {
        self.basis.degree()
    }

    fn variables(&self) -> usize {
        self.first_mu() + self.camouflage.as_ref().map_or(0, Camouflage::count)
    }

    fn is_linear(&self) -> bool {
        self.camouflage.is_none()
    }

    fn row(&self, at: f64, order: usize, z: &[f64], row: &mut Row) {
        row.clear();
        let values = self.basis.values(self.basis.span(at), at, order);
        let Some(camouflage) = &self.camouflage else {
            return self.prey(&values, order, 1.0, z, row);
        };
        let weights = camouflage.weights(at, order);
        let nu = self.control(&weights, z);
        let mut place = Row::default();
        self.prey(&values, 0, 1.0, z, &mut place);
        let arm = place.value - camouflage.reference;
        let first = self.first_mu();
        if order == 0 {
            self.prey(&values, 0, nu[0], z, row);
            row.value = camouflage.reference + arm * nu[0];
            let own = weights[0].iter().enumerate();
            row.terms.extend(own.map(|(j, w)| (first + j, arm * *w)));
        } else {
            let mut velocity = Row::default();
            self.prey(&values, 1, 1.0, z, &mut velocity);
            self.prey(&values, 1, nu[0], z, row);
            self.prey(&values, 0, nu[1], z, row);
            row.value = arm * nu[1] + velocity.value * nu[0];
            let own = weights[0].iter().zip(&weights[1]).enumerate();
            row.terms
                .extend(own.map(|(j, (w, slope))| (first + j, arm * *slope + velocity.value * *w)));
        }
    }

    fn trace(&self, z: &[f64]) -> Trace<'_> {
        let points = self.prey_points(z);
        let prey = move |at: f64| {
            let values = self.basis.values(self.basis.span(at), at, 2);
            let near = &points[values.first..=values.first + self.basis.degree()];
            [0, 1, 2].map(|order| {
                let terms = near.iter().zip(&values.by_order[order]);
                terms.map(|(p, b)| p * *b).sum::<Vector2<f64>>()
            })
        };
        let Some(camouflage) = &self.camouflage else {
            return Box::new(prey);
        };
        let control = camouflage.interpolant(&self.path_control(z));
        Box::new(move |at| {
            let prey = prey(at);
            let nu = control(at);
            let arm = prey[0] - camouflage.reference;
            [
                camouflage.reference + arm * nu[0],
                arm * nu[1] + prey[1] * nu[0],
                arm * nu[2] + prey[1] * (2.0 * nu[1]) + prey[2] * nu[0],
            ]
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

    fn own_costs(&self) -> Vec<(usize, f64)> {
        (self.first_mu()..self.variables())
            .map(|var| (var, COST))
            .collect()
    }

    fn step_bounds(&self) -> Vec<(usize, f64)> {
        (self.first_mu()..self.variables())
            .map(|var| (var, STEP))
            .collect()
    }
}
