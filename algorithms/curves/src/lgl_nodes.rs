//! Legendre–Gauss–Lobatto nodes of the path control parameter of motion camouflage.
//!
//! Fahroo and Ross, *Costate Estimation by a Legendre Pseudospectral Method* (2001): the N + 1 nodes
//! are ±1 and the zeros of the derivative of the Legendre polynomial of degree N; the
//! differentiation matrix maps values at the nodes to derivatives of their interpolant there.

use nalgebra::DMatrix;

/// Maximum N.
pub const MAX_NODES: usize = 64;

/// The nodes on [−1, 1] with their weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Lgl {
    /// The nodes, ascending.
    pub nodes: Vec<f64>,
    /// Weights of the quadrature, exact for polynomials of degree 2N − 1.
    pub weights: Vec<f64>,
    /// Legendre polynomial of degree N at the nodes.
    legendre: Vec<f64>,
    /// Weights of barycentric interpolation.
    barycentric: Vec<f64>,
}

/// The Legendre polynomial of degree n at x, and the one of degree n − 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = (1.0, x);
    if n == 0 {
        return (1.0, 0.0);
    }
    for k in 1..n {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
    }
    (now, before)
}

/// Weights of barycentric interpolation, 1 / ∏ (xⱼ − xₖ) over k ≠ j, scaled to a largest of 1.
fn barycentric(nodes: &[f64]) -> Vec<f64> {
    let weight = |j: usize| {
        let others = nodes.iter().enumerate().filter(|&(k, _)| k != j);
        // Twice the differences: their product neither over- nor underflows.
        1.0 / others.map(|(_, x)| 2.0 * (nodes[j] - x)).product::<f64>()
    };
    let weights: Vec<f64> = (0..nodes.len()).map(weight).collect();
    let most = weights.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
    weights.iter().map(|w| w / most).collect()
}

impl Lgl {
    /// Computes the N + 1 nodes, N from 1 to [`MAX_NODES`] (other numbers are clamped).
    pub fn new(n: usize) -> Self {
        let n = n.clamp(1, MAX_NODES);
        let nf = n as f64;
        let mut nodes: Vec<f64> = (0..=n)
            .map(|i| {
                // Newton's method from the Chebyshev nodes.
                let mut x = -geometry::math::sincos(
                    core::f64::consts::FRAC_PI_2 - core::f64::consts::PI * i as f64 / nf,
                )
                .0;
                for _ in 0..64 {
                    let (p, before) = legendre(n, x);
                    let step = (x * p - before) / ((nf + 1.0) * p);
                    x -= step;
                    if step.abs() < 1e-16 {
                        break;
                    }
                }
                x
            })
            .collect();
        nodes[0] = -1.0;
        nodes[n] = 1.0;
        // Their symmetry is exact.
        for i in 0..=n / 2 {
            let x = 0.5 * (nodes[n - i] - nodes[i]);
            nodes[i] = -x;
            nodes[n - i] = x;
        }
        let legendre: Vec<f64> = nodes.iter().map(|&x| self::legendre(n, x).0).collect();
        let weights = legendre
            .iter()
            .map(|p| 2.0 / (nf * (nf + 1.0) * p * p))
            .collect();
        let barycentric = barycentric(&nodes);
        Self {
            nodes,
            weights,
            legendre,
            barycentric,
        }
    }

    /// N.
    pub fn order(&self) -> usize {
        self.nodes.len() - 1
    }

    /// The differentiation matrix D on [−1, 1]: (N + 1) × (N + 1).
    pub fn differentiation(&self) -> DMatrix<f64> {
        let n = self.order();
        let corner = (n * (n + 1)) as f64 / 4.0;
        DMatrix::from_fn(n + 1, n + 1, |i, j| {
            if i == j {
                match i {
                    0 => -corner,
                    _ if i == n => corner,
                    _ => 0.0,
                }
            } else {
                self.legendre[i] / (self.legendre[j] * (self.nodes[i] - self.nodes[j]))
            }
        })
    }

    /// The Lagrange polynomials of the nodes at a point of [−1, 1].
    pub fn values(&self, at: f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.nodes.len());
        let mut sum = 0.0;
        for (node, (x, weight)) in self.nodes.iter().zip(&self.barycentric).enumerate() {
            let away = at - x;
            if away.abs() < 1e-14 {
                values.clear();
                values.resize(self.nodes.len(), 0.0);
                values[node] = 1.0;
                return values;
            }
            values.push(weight / away);
            sum += weight / away;
        }
        for value in &mut values {
            *value /= sum;
        }
        values
    }

    /// The Lagrange polynomials of the nodes at a point of [−1, 1], and their derivatives there.
    pub fn interpolation(&self, at: f64, differentiation: &DMatrix<f64>) -> [Vec<f64>; 2] {
        let values = self.values(at);
        // The derivative of a polynomial is the interpolant of its derivatives at the nodes.
        let row = nalgebra::RowDVector::from_row_slice(&values);
        let first = &row * differentiation;
        [values, first.iter().copied().collect()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_weights_are_the_tabulated_ones() {
        // Abramowitz and Stegun, table 25.6, n = 5.
        let lgl = Lgl::new(4);
        let want = [
            -1.0,
            -0.654_653_670_707_977,
            0.0,
            0.654_653_670_707_977,
            1.0,
        ];
        let weights = [0.1, 49.0 / 90.0, 32.0 / 45.0, 49.0 / 90.0, 0.1];
        for i in 0..5 {
            assert!((lgl.nodes[i] - want[i]).abs() < 1e-14);
            assert!((lgl.weights[i] - weights[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn quadrature_differentiation_and_interpolation_are_exact_for_polynomials() {
        for n in [2, 5, 10, 15, 30] {
            let lgl = Lgl::new(n);
            let d = lgl.differentiation();
            let power = |x: f64, k: usize| x.powi(k as i32);
            for k in 0..2 * n {
                let sum: f64 = lgl
                    .nodes
                    .iter()
                    .zip(&lgl.weights)
                    .map(|(x, w)| w * power(*x, k))
                    .sum();
                let exact = if k % 2 == 0 {
                    2.0 / (k + 1) as f64
                } else {
                    0.0
                };
                assert!((sum - exact).abs() < 1e-12, "{n} {k} {sum}");
            }
            for k in 1..=n {
                let at = 0.3;
                let [value, first] = lgl.interpolation(at, &d);
                let apply = |row: &[f64]| -> f64 {
                    row.iter()
                        .zip(&lgl.nodes)
                        .map(|(c, x)| c * power(*x, k))
                        .sum()
                };
                let kf = k as f64;
                let scale = kf * kf * kf * kf;
                assert!((apply(&value) - power(at, k)).abs() < 1e-12);
                assert!((apply(&first) - kf * power(at, k - 1)).abs() < 1e-11 * scale);
            }
        }
    }
}
