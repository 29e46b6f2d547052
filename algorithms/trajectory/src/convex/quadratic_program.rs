//! Convex quadratic programs, built row by row and solved by Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use nalgebra::DMatrix;

use crate::convex::effort::Effort;

/// min ½ zᵀ H z + qᵀ z subject to A z ≤ b.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadraticProgram {
    hessian: DMatrix<f64>,
    linear: Vec<f64>,
    /// Begin and end of each constraint's terms, and its bound.
    rows: Vec<(usize, usize, f64)>,
    /// Variables and coefficients, constraint by constraint.
    terms: Vec<(usize, f64)>,
}

impl QuadraticProgram {
    /// Creates a program with this number of variables, without costs or constraints.
    pub fn new(variables: usize) -> Self {
        Self {
            hessian: DMatrix::zeros(variables, variables),
            linear: vec![0.0; variables],
            rows: Vec::new(),
            terms: Vec::new(),
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
        let begin = self.terms.len();
        self.terms.extend(terms);
        self.rows.push((begin, self.terms.len(), bound));
    }

    /// Solves the program and adds its work to `effort`; `None` if the solver finds no solution.
    pub fn solve(&self, effort: &Effort) -> Option<Vec<f64>> {
        let n = self.linear.len();
        let costs = upper_triangle(&self.hessian);
        let (matrix, bounds) = self.matrix(n);
        let cones = [SupportedConeT::NonnegativeConeT(self.rows.len())];
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

    /// The constraints' matrix and bounds.
    fn matrix(&self, n: usize) -> (CscMatrix<f64>, Vec<f64>) {
        let mut first = vec![0usize; n + 1];
        for (var, _) in &self.terms {
            first[var + 1] += 1;
        }
        for i in 0..n {
            first[i + 1] += first[i];
        }
        let mut next = first.clone();
        let mut rows = vec![0; self.terms.len()];
        let mut values = vec![0.0; self.terms.len()];
        for (row, &(begin, end, _)) in self.rows.iter().enumerate() {
            for &(var, coefficient) in &self.terms[begin..end] {
                rows[next[var]] = row;
                values[next[var]] = coefficient;
                next[var] += 1;
            }
        }
        let bounds: Vec<f64> = self.rows.iter().map(|row| row.2).collect();
        (CscMatrix::new(bounds.len(), n, first, rows, values), bounds)
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
    fn contradictory_constraints_have_no_solution() {
        let mut program = QuadraticProgram::new(1);
        program.add_quadratic(0, 0, 1.0);
        program.at_most([(0, 1.0)], -1.0);
        program.at_most([(0, -1.0)], -1.0);
        assert_eq!(program.solve(&Effort::default()), None);
    }
}
