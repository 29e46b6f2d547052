//! B-spline basis functions of any degree on a clamped knot vector over [0, 1].
//!
//! Piegl and Tiller, *The NURBS Book* (2nd ed. 1997), algorithms A2.1 and A2.3.

/// Maximum degree.
pub const MAX_DEGREE: usize = 8;

/// A clamped knot vector over [0, 1] and a degree.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    degree: usize,
    /// All knots, the first and last `degree + 1` of them 0 and 1.
    knots: Vec<f64>,
}

/// Non-zero values of the basis functions at a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    /// Index of the first of them; there are degree + 1.
    pub first: usize,
    /// By order of derivative, then function.
    pub by_order: [[f64; MAX_DEGREE + 1]; MAX_DEGREE + 1],
}

impl Basis {
    /// Creates the basis of this degree (1…8) with these breaks strictly between 0 and 1,
    /// ascending.
    pub fn new(degree: usize, breaks: &[f64]) -> Self {
        let degree = degree.clamp(1, MAX_DEGREE);
        let mut knots = vec![0.0; degree + 1];
        let mut last = 0.0;
        for &at in breaks {
            // Strictly ascending for every input.
            if at > last && at < 1.0 {
                knots.push(at);
                last = at;
            }
        }
        knots.extend(core::iter::repeat_n(1.0, degree + 1));
        Self { degree, knots }
    }

    /// Creates the basis of this degree with this number of functions (more than the degree) and
    /// even breaks.
    pub fn even(degree: usize, functions: usize) -> Self {
        let spans = functions.saturating_sub(degree).max(1);
        let breaks: Vec<f64> = (1..spans).map(|i| i as f64 / spans as f64).collect();
        Self::new(degree, &breaks)
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of basis functions, > degree.
    pub fn len(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Returns `true` if there are none (never).
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The parameters where polynomials meet, including both ends.
    pub fn breaks(&self) -> &[f64] {
        &self.knots[self.degree..self.knots.len() - self.degree]
    }

    /// End of the support of a function.
    pub fn support_end(&self, function: usize) -> f64 {
        self.knots[(function + self.degree + 1).min(self.knots.len() - 1)]
    }

    /// Index of the span between breaks that contains a parameter of [0, 1].
    pub fn span(&self, at: f64) -> usize {
        let breaks = self.breaks();
        breaks
            .partition_point(|&b| b <= at)
            .clamp(1, breaks.len() - 1)
            - 1
    }

    /// The non-zero functions of a span, and their derivatives up to an order, at a parameter in it
    /// (or beyond: the span's polynomials are extrapolated).
    pub fn values(&self, span: usize, at: f64, order: usize) -> Values {
        let (p, u) = (self.degree, &self.knots);
        let i = span + p;
        // A2.3: triangle of basis functions and knot differences.
        let mut ndu = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        let (mut left, mut right) = ([0.0; MAX_DEGREE + 1], [0.0; MAX_DEGREE + 1]);
        ndu[0][0] = 1.0;
        for j in 1..=p {
            left[j] = at - u[i + 1 - j];
            right[j] = u[i + j] - at;
            let mut saved = 0.0;
            for r in 0..j {
                ndu[j][r] = right[r + 1] + left[j - r];
                let temp = ndu[r][j - 1] / ndu[j][r];
                ndu[r][j] = saved + right[r + 1] * temp;
                saved = left[j - r] * temp;
            }
            ndu[j][j] = saved;
        }
        let mut values = Values {
            first: span,
            by_order: [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1],
        };
        for (value, row) in values.by_order[0].iter_mut().zip(&ndu).take(p + 1) {
            *value = row[p];
        }
        for r in 0..=p {
            let mut a = [[0.0; MAX_DEGREE + 1]; 2];
            a[0][0] = 1.0;
            let (mut s1, mut s2) = (0, 1);
            for k in 1..=order.min(p) {
                let mut d = 0.0;
                let pk = p - k;
                if r >= k {
                    a[s2][0] = a[s1][0] / ndu[pk + 1][r - k];
                    d = a[s2][0] * ndu[r - k][pk];
                }
                let j1 = if r + 1 >= k { 1 } else { k - r };
                let j2 = if r <= pk + 1 { k - 1 } else { p - r };
                for j in j1..=j2 {
                    a[s2][j] = (a[s1][j] - a[s1][j - 1]) / ndu[pk + 1][r + j - k];
                    d += a[s2][j] * ndu[r + j - k][pk];
                }
                if r <= pk {
                    a[s2][k] = -a[s1][k - 1] / ndu[pk + 1][r];
                    d += a[s2][k] * ndu[r][pk];
                }
                values.by_order[k][r] = d;
                core::mem::swap(&mut s1, &mut s2);
            }
        }
        let mut factor = 1.0;
        for k in 1..=order.min(p) {
            factor *= (p + 1 - k) as f64;
            for value in &mut values.by_order[k][..=p] {
                *value *= factor;
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn basis() -> impl Strategy<Value = Basis> {
        let breaks = proptest::collection::vec(0.01..0.99, 0..8);
        (1..=6usize, breaks).prop_map(|(degree, mut breaks)| {
            breaks.sort_by(f64::total_cmp);
            breaks.dedup_by(|a, b| (*a - *b).abs() < 0.01);
            Basis::new(degree, &breaks)
        })
    }

    proptest! {
        #[test]
        fn functions_are_a_partition_of_unity(basis in basis(), at in 0.0..=1.0) {
            let values = basis.values(basis.span(at), at, 3);
            for (order, row) in values.by_order.iter().enumerate().take(4) {
                let sum: f64 = row.iter().sum();
                let size: f64 = 1.0 + row.iter().map(|v| v.abs()).sum::<f64>();
                let want = if order == 0 { 1.0 } else { 0.0 };
                prop_assert!((sum - want).abs() < 1e-11 * size);
            }
            prop_assert!(values.first + basis.degree() < basis.len());
        }

        #[test]
        fn derivatives_are_limits_of_differences(basis in basis(), at in 0.001..0.999) {
            let span = basis.span(at);
            let h = 1e-5;
            let (low, high) = (basis.values(span, at - h, 2), basis.values(span, at + h, 2));
            let middle = basis.values(span, at, 3);
            for order in 0..2 {
                for i in 0..=basis.degree() {
                    let found = (high.by_order[order][i] - low.by_order[order][i]) / (2.0 * h);
                    let exact = middle.by_order[order + 1][i];
                    let size = 1.0 + middle.by_order[3][i].abs() + exact.abs();
                    prop_assert!((found - exact).abs() < 1e-4 * size, "{found} {exact}");
                }
            }
        }
    }

    #[test]
    fn ends_are_clamped() {
        let basis = Basis::even(3, 8);
        assert_eq!(basis.len(), 8);
        assert_eq!(basis.values(basis.span(0.0), 0.0, 0).by_order[0][0], 1.0);
        let end = basis.values(basis.span(1.0), 1.0, 0);
        assert_eq!((end.first, end.by_order[0][3]), (4, 1.0));
    }
}
