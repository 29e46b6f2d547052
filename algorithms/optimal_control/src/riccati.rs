//! Linear-quadratic problem by a Riccati recursion.
//!
//! `min Σₖ ½ wₖᵀ Hₖ wₖ + gₖᵀ wₖ + ½ s_Nᵀ H_N s_N + g_Nᵀ s_N` with wₖ = (sₖ, uₖ), subject to
//! sₖ₊₁ = Mₖ wₖ + cₖ; components of s₀ are zero or free.

use nalgebra::{SMatrix, SVector};

/// Number of states: x, y, θ, v, ω, T.
pub const STATES: usize = 6;
/// Number of controls.
pub const CONTROLS: usize = 2;
/// Both.
pub const BOTH: usize = STATES + CONTROLS;

/// State of a node.
pub type State = SVector<f64, STATES>;
/// Control of a stage.
pub type Control = SVector<f64, CONTROLS>;
/// State and control.
pub type Point = SVector<f64, BOTH>;

/// One stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// H.
    pub hessian: SMatrix<f64, BOTH, BOTH>,
    /// g.
    pub gradient: Point,
    /// M.
    pub motion: SMatrix<f64, STATES, BOTH>,
    /// c.
    pub defect: State,
}

impl Default for Stage {
    fn default() -> Self {
        Self {
            hessian: SMatrix::zeros(),
            gradient: Point::zeros(),
            motion: SMatrix::zeros(),
            defect: State::zeros(),
        }
    }
}

/// Feedback of a stage: u = `gain` s + `offset`, with the cost to go ½ sᵀ `cost` s + `slope`ᵀ s
/// of its first node.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Feedback {
    gain: SMatrix<f64, CONTROLS, STATES>,
    offset: Control,
    cost: SMatrix<f64, STATES, STATES>,
    slope: State,
}

/// Memory of the recursion.
#[derive(Debug, Clone)]
pub struct Riccati {
    feedback: Vec<Feedback>,
}

/// Costs of the last node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Its H.
    pub hessian: SMatrix<f64, STATES, STATES>,
    /// Its g.
    pub gradient: State,
}

/// Solution: the memory that a recursion fills.
pub struct Unknowns<'a> {
    /// States of all nodes.
    pub states: &'a mut [State],
    /// Controls of all stages.
    pub controls: &'a mut [Control],
    /// Costates of all nodes: the gradient of the cost to go.
    pub costates: &'a mut [State],
}

/// A problem whose reduced Hessian is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Indefinite;

impl Riccati {
    /// Memory for a number of stages.
    pub fn new(stages: usize) -> Self {
        let feedback = Feedback {
            gain: SMatrix::zeros(),
            offset: Control::zeros(),
            cost: SMatrix::zeros(),
            slope: State::zeros(),
        };
        Self {
            feedback: vec![feedback; stages],
        }
    }

    /// Computes the solution. `shift` is added to the diagonals of all Hessians.
    ///
    /// # Errors
    /// [`Indefinite`] if the solution is not a minimum.
    pub fn solve(
        &mut self,
        stages: &[Stage],
        end: &End,
        free: [bool; STATES],
        shift: f64,
        to: &mut Unknowns<'_>,
    ) -> Result<(), Indefinite> {
        let mut cost = end.hessian;
        for i in 0..STATES {
            cost[(i, i)] += shift;
        }
        let end_cost = cost;
        let mut slope = end.gradient;
        for (stage, feedback) in stages.iter().zip(&mut self.feedback).rev() {
            backward(stage, shift, &mut cost, &mut slope, feedback)?;
        }
        let first = initial(&cost, &slope, free)?;
        let Some(slot) = to.states.first_mut() else {
            return Ok(());
        };
        *slot = first;
        for (k, (stage, feedback)) in stages.iter().zip(&self.feedback).enumerate() {
            let state = to.states[k];
            let control = feedback.gain * state + feedback.offset;
            to.controls[k] = control;
            to.costates[k] = feedback.cost * state + feedback.slope;
            let mut point = Point::zeros();
            point.fixed_rows_mut::<STATES>(0).copy_from(&state);
            point.fixed_rows_mut::<CONTROLS>(STATES).copy_from(&control);
            to.states[k + 1] = stage.motion * point + stage.defect;
        }
        let last = stages.len();
        to.costates[last] = end_cost * to.states[last] + end.gradient;
        Ok(())
    }
}

/// Eliminates the control of a stage; replaces the cost to go of its end by that of its first node.
fn backward(
    stage: &Stage,
    shift: f64,
    cost: &mut SMatrix<f64, STATES, STATES>,
    slope: &mut State,
    feedback: &mut Feedback,
) -> Result<(), Indefinite> {
    let motion = &stage.motion;
    let weighed = *cost * motion;
    let mut whole = stage.hessian + motion.tr_mul(&weighed);
    for i in 0..BOTH {
        whole[(i, i)] += shift;
    }
    let linear = stage.gradient + motion.tr_mul(&(*slope + *cost * stage.defect));
    let (a, b, d) = (whole[(6, 6)], whole[(7, 6)], whole[(7, 7)]);
    let determinant = a * d - b * b;
    if !(a > 0.0 && determinant > 1e-14 * a * d.abs()) {
        return Err(Indefinite);
    }
    let inverse = SMatrix::<f64, 2, 2>::new(d, -b, -b, a) / determinant;
    let cross = whole.fixed_view::<CONTROLS, STATES>(STATES, 0);
    let gain = -(inverse * cross);
    let offset = -(inverse * linear.fixed_rows::<CONTROLS>(STATES));
    let mut next = whole.fixed_view::<STATES, STATES>(0, 0) + cross.tr_mul(&gain);
    // Rounding must not let the two halves drift apart.
    for i in 0..STATES {
        for j in 0..i {
            let mean = 0.5 * (next[(i, j)] + next[(j, i)]);
            next[(i, j)] = mean;
            next[(j, i)] = mean;
        }
    }
    *slope = linear.fixed_rows::<STATES>(0) + cross.tr_mul(&offset);
    *cost = next;
    *feedback = Feedback {
        gain,
        offset,
        cost: next,
        slope: *slope,
    };
    Ok(())
}

/// The first state: minimum of the cost to go over its free components.
fn initial(
    cost: &SMatrix<f64, STATES, STATES>,
    slope: &State,
    free: [bool; STATES],
) -> Result<State, Indefinite> {
    // Fixed components: the identity's rows.
    let mut matrix = SMatrix::<f64, STATES, STATES>::identity();
    let mut right = State::zeros();
    for i in (0..STATES).filter(|&i| free[i]) {
        right[i] = -slope[i];
        for j in (0..STATES).filter(|&j| free[j]) {
            matrix[(i, j)] = cost[(i, j)];
        }
    }
    Ok(matrix.cholesky().ok_or(Indefinite)?.solve(&right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    const STAGES: usize = 3;
    /// Variables: states of all nodes, then controls.
    const ALL: usize = STATES * (STAGES + 1) + CONTROLS * STAGES;

    fn stages(numbers: &[f64]) -> (Vec<Stage>, End) {
        let mut numbers = numbers.iter().copied().cycle();
        let mut next = || numbers.next().unwrap();
        let mut stages = Vec::new();
        for _ in 0..STAGES {
            let root = SMatrix::<f64, BOTH, BOTH>::from_fn(|_, _| next());
            stages.push(Stage {
                hessian: root.tr_mul(&root) + SMatrix::identity() * 0.1,
                gradient: Point::from_fn(|_, _| next()),
                motion: SMatrix::from_fn(|_, _| next()),
                defect: State::from_fn(|_, _| next()),
            });
        }
        let root = SMatrix::<f64, STATES, STATES>::from_fn(|_, _| next());
        let end = End {
            hessian: root.tr_mul(&root),
            gradient: State::from_fn(|_, _| next()),
        };
        (stages, end)
    }

    /// The conditions of optimality as one dense system.
    fn dense(stages: &[Stage], end: &End, free: [bool; STATES]) -> DVector<f64> {
        let fixed: Vec<usize> = (0..STATES).filter(|&i| !free[i]).collect();
        let size = ALL + STATES * STAGES + fixed.len();
        let (mut matrix, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let place = |k: usize, i: usize| {
            if i < STATES {
                STATES * k + i
            } else {
                STATES * (STAGES + 1) + CONTROLS * k + i - STATES
            }
        };
        for (k, stage) in stages.iter().enumerate() {
            for i in 0..BOTH {
                right[place(k, i)] -= stage.gradient[i];
                for j in 0..BOTH {
                    matrix[(place(k, i), place(k, j))] += stage.hessian[(i, j)];
                }
            }
            for row in 0..STATES {
                let constraint = ALL + STATES * k + row;
                right[constraint] = -stage.defect[row];
                let mut add = |variable: usize, value: f64| {
                    matrix[(constraint, variable)] += value;
                    matrix[(variable, constraint)] += value;
                };
                add(place(k + 1, row), -1.0);
                for i in 0..BOTH {
                    add(place(k, i), stage.motion[(row, i)]);
                }
            }
        }
        for i in 0..STATES {
            right[place(STAGES, i)] -= end.gradient[i];
            for j in 0..STATES {
                matrix[(place(STAGES, i), place(STAGES, j))] += end.hessian[(i, j)];
            }
        }
        for (n, i) in fixed.into_iter().enumerate() {
            let constraint = ALL + STATES * STAGES + n;
            matrix[(constraint, i)] = 1.0;
            matrix[(i, constraint)] = 1.0;
        }
        matrix.lu().solve(&right).unwrap()
    }

    proptest! {
        #[test]
        fn the_recursion_solves_the_dense_system(
            numbers in prop::collection::vec(-1.0..1.0f64, 97),
            free in prop::array::uniform6(any::<bool>()),
        ) {
            let (stages, end) = stages(&numbers);
            let mut states = vec![State::zeros(); STAGES + 1];
            let mut controls = vec![Control::zeros(); STAGES];
            let mut costates = states.clone();
            Riccati::new(STAGES).solve(&stages, &end, free, 0.0, &mut Unknowns { states: &mut states, controls: &mut controls, costates: &mut costates })
                .unwrap();
            let dense = dense(&stages, &end, free);
            let scale = 1.0 + dense.amax();
            for k in 0..=STAGES {
                for i in 0..STATES {
                    prop_assert!((states[k][i] - dense[STATES * k + i]).abs() < 1e-7 * scale);
                }
            }
            for k in 0..STAGES {
                let at = STATES * (STAGES + 1) + CONTROLS * k;
                prop_assert!((controls[k][0] - dense[at]).abs() < 1e-7 * scale);
                for i in 0..STATES {
                    // The multiplier of a motion is the costate of its end.
                    let multiplier = dense[ALL + STATES * k + i];
                    prop_assert!((costates[k + 1][i] - multiplier).abs() < 1e-6 * scale);
                }
            }
        }
    }

    #[test]
    fn an_indefinite_problem_is_refused() {
        let (mut stages, end) = stages(&[0.3, -0.2, 0.7, 0.1, -0.5]);
        stages[1].hessian[(6, 6)] = -1e6;
        let mut states = vec![State::zeros(); STAGES + 1];
        let mut controls = vec![Control::zeros(); STAGES];
        let mut costates = states.clone();
        let solved = Riccati::new(STAGES).solve(
            &stages,
            &end,
            [true; STATES],
            0.0,
            &mut Unknowns {
                states: &mut states,
                controls: &mut controls,
                costates: &mut costates,
            },
        );
        assert_eq!(solved, Err(Indefinite));
    }
}
