//! Convex quadratic programs, built row by row and solved by Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use nalgebra::DMatrix;

use crate::convex::effort::Effort;

/// min ½ zᵀ H z + qᵀ z subject to A z ≤ b and C z = d.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadraticProgram {
    hessian: DMatrix<f64>,
    linear: Vec<f64>,
    equal: Rows,
    at_most: Rows,
}

/// Linear constraints.
#[derive(Debug, Clone, PartialEq, Default)]
struct Rows {
    /// Begin and end of each row's terms, and its right side.
    rows: Vec<(usize, usize, f64)>,
    /// Variables and coefficients, row by row.
    terms: Vec<(usize, f64)>,
}

impl Rows {
    fn push(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        let begin = self.terms.len();
        self.terms.extend(terms);
        self.rows.push((begin, self.terms.len(), right));
    }
}

impl QuadraticProgram {
    /// Creates a program with this number of variables, without costs or constraints.
    pub fn new(variables: usize) -> Self {
        Self {
            hessian: DMatrix::zeros(variables, variables),
            linear: vec![0.0; variables],
            equal: Rows::default(),
            at_most: Rows::default(),
        }
    }

    /// Adds to an element of the Hessian's upper triangle (and, by symmetry, below).
    #[inline]
    pub fn add_quadratic(&mut self, i: usize, j: usize, value: f64) {
        let (low, high) = if i <= j { (i, j) } else { (j, i) };
        self.hessian[(low, high)] += value;
    }

    /// Adds to the linear cost of a variable.
    #[inline]
    pub fn add_linear(&mut self, i: usize, value: f64) {
        self.linear[i] += value;
    }

    /// Adds the constraint Σ terms ≤ `bound`; every variable at most once.
    pub fn at_most(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        self.at_most.push(terms, bound);
    }

    /// Adds the constraint Σ terms = `value`; every variable at most once.
    pub fn equal(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, value: f64) {
        self.equal.push(terms, value);
    }

    /// Solves the program and adds its work to `effort`; `None` if the solver finds no solution.
    pub fn solve(&self, effort: &Effort) -> Option<Vec<f64>> {
        let n = self.linear.len();
        let costs = upper_triangle(&self.hessian);
        let (matrix, bounds) = self.matrix(n);
        let cones = [
            SupportedConeT::ZeroConeT(self.equal.rows.len()),
            SupportedConeT::NonnegativeConeT(self.at_most.rows.len()),
        ];
        let coefficients = matrix.nzval.len() + costs.nzval.len();
        let mut steps = 0;
        let mut found = None;
        // These programs are well scaled: Clarabel's equilibration would cost a third of the time.
        for careful in [false, true] {
            let mut solver = DefaultSolver::new(
                &costs,
                &self.linear,
                &matrix,
                &bounds,
                &cones,
                settings(careful)?,
            )
            .ok()?;
            solver.solve();
            steps += solver.solution.iterations;
            let z = &solver.solution.x;
            let solved = matches!(solver.solution.status, SolverStatus::Solved)
                || careful && matches!(solver.solution.status, SolverStatus::AlmostSolved);
            if solved && z.iter().all(|v| v.is_finite()) {
                found = Some(z.clone());
                break;
            }
        }
        effort.add(steps, coefficients);
        found
    }

    /// All rows, equalities first, and their right sides.
    fn matrix(&self, n: usize) -> (CscMatrix<f64>, Vec<f64>) {
        let parts = [&self.equal, &self.at_most];
        let count: usize = parts.iter().map(|part| part.terms.len()).sum();
        let mut first = vec![0usize; n + 1];
        for (var, _) in parts.iter().flat_map(|part| &part.terms) {
            first[var + 1] += 1;
        }
        for i in 0..n {
            first[i + 1] += first[i];
        }
        let mut next = first.clone();
        let mut rows = vec![0; count];
        let mut values = vec![0.0; count];
        let mut right = Vec::new();
        for part in parts {
            for &(begin, end, value) in &part.rows {
                for &(var, coefficient) in &part.terms[begin..end] {
                    rows[next[var]] = right.len();
                    values[next[var]] = coefficient;
                    next[var] += 1;
                }
                right.push(value);
            }
        }
        (CscMatrix::new(right.len(), n, first, rows, values), right)
    }
}

fn upper_triangle(full: &DMatrix<f64>) -> CscMatrix<f64> {
    let n = full.ncols();
    let (mut first, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for col in 0..n {
        for row in 0..=col {
            let value = full[(row, col)];
            if value != 0.0 {
                rows.push(row);
                values.push(value);
            }
        }
        first.push(rows.len());
    }
    CscMatrix::new(n, n, first, rows, values)
}

fn settings(careful: bool) -> Option<DefaultSettings<f64>> {
    DefaultSettingsBuilder::default()
        .verbose(false)
        .max_iter(60)
        .max_threads(1)
        .tol_gap_abs(1e-7)
        .tol_gap_rel(1e-7)
        .tol_feas(1e-8)
        .presolve_enable(false)
        .iterative_refinement_enable(careful)
        .equilibrate_enable(careful)
        .build()
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_program_is_solved() {
        // min ½(x² + y²) − x − 2y with x + y ≤ 1: the projection of (1, 2) onto the line.
        let mut program = QuadraticProgram::new(2);
        for (i, target) in [(0, 1.0), (1, 2.0)] {
            program.add_quadratic(i, i, 1.0);
            program.add_linear(i, -target);
        }
        program.at_most([(0, 1.0), (1, 1.0)], 1.0);
        let z = program.solve(&Effort::default()).unwrap();
        assert!(
            (z[0] - 0.0).abs() < 1e-6 && (z[1] - 1.0).abs() < 1e-6,
            "{z:?}"
        );
    }

    #[test]
    fn equalities_hold() {
        // The point of the line x + y = 1 nearest to the origin.
        let mut program = QuadraticProgram::new(2);
        program.add_quadratic(0, 0, 1.0);
        program.add_quadratic(1, 1, 1.0);
        program.equal([(0, 1.0), (1, 1.0)], 1.0);
        let z = program.solve(&Effort::default()).unwrap();
        assert!(
            (z[0] - 0.5).abs() < 1e-6 && (z[1] - 0.5).abs() < 1e-6,
            "{z:?}"
        );
    }

    #[test]
    fn contradictory_constraints_have_no_solution() {
        let mut program = QuadraticProgram::new(1);
        program.add_quadratic(0, 0, 1.0);
        program.at_most([(0, 1.0)], -1.0);
        program.at_most([(0, -1.0)], -1.0);
        assert_eq!(program.solve(&Effort::default()), None);
    }
}
