//! Linear-quadratic problem by a Riccati recursion.
//!
//! `min Σₖ ½ wₖᵀ Hₖ wₖ + gₖᵀ wₖ + ½ s_Nᵀ H_N s_N + g_Nᵀ s_N` with wₖ = (sₖ, uₖ), subject to
//! sₖ₊₁ = Mₖ wₖ + cₖ; components of s₀ are zero or free. Mₖ has the robot's structure ([`Transition`]).

use nalgebra::{SMatrix, SVector};

use crate::variables::{OMEGA, P, Q, THETA, TIME, V, X, Y};

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

/// Number of components of w from θ on.
pub const TURNED: usize = BOTH - THETA;

/// M: the linear motion of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Transition {
    /// Derivatives of the next x, y and θ by the components of w from θ on. Those of x and y by
    /// themselves are 1.
    pub pose: [[f64; TURNED]; 3],
    /// Factor of v and ω in the next, to which their changes are added. T stays.
    pub kept: f64,
}

/// One stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stage {
    /// H.
    pub hessian: SMatrix<f64, BOTH, BOTH>,
    /// g.
    pub gradient: Point,
    /// M.
    pub motion: Transition,
    /// c.
    pub defect: State,
}

impl Transition {
    /// M w.
    pub fn apply(&self, state: &State, control: &Control) -> State {
        let turned = [
            state[THETA],
            state[V],
            state[OMEGA],
            state[TIME],
            control[0],
            control[1],
        ];
        let [x, y, theta] = self.pose.map(|slopes| {
            let products: [f64; TURNED] = core::array::from_fn(|i| slopes[i] * turned[i]);
            let [a, b, c, d, e, f] = products;
            (a + b) + (c + d) + (e + f)
        });
        State::from([
            state[X] + x,
            state[Y] + y,
            theta,
            self.kept * state[V] + control[0],
            self.kept * state[OMEGA] + control[1],
            state[TIME],
        ])
    }

    /// Mᵀ s; also a column of Mᵀ P M, of the column of P M.
    pub fn transposed(&self, s: &[f64; STATES]) -> [f64; BOTH] {
        let [x, y, theta] = &self.pose;
        let [v, omega] = [s[V], s[OMEGA]];
        let mut sums = [0.0, self.kept * v, self.kept * omega, s[TIME], v, omega];
        add(&mut sums, s[X], x);
        add(&mut sums, s[Y], y);
        add(&mut sums, s[THETA], theta);
        let [a, b, c, d, e, f] = sums;
        [s[X], s[Y], a, b, c, d, e, f]
    }
}

/// Adds a multiple.
fn add<const N: usize>(to: &mut [f64; N], factor: f64, by: &[f64; N]) {
    for (to, by) in to.iter_mut().zip(by) {
        *to += factor * by;
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
        let mut end_cost = end.hessian;
        for i in 0..STATES {
            end_cost[(i, i)] += shift;
        }
        let mut after = (&end_cost, &end.gradient);
        for (stage, feedback) in stages.iter().zip(&mut self.feedback).rev() {
            backward(stage, shift, after, feedback)?;
            after = (&feedback.cost, &feedback.slope);
        }
        let first = initial(after.0, after.1, free)?;
        let Some(slot) = to.states.first_mut() else {
            return Ok(());
        };
        *slot = first;
        for (k, (stage, feedback)) in stages.iter().zip(&self.feedback).enumerate() {
            let state = to.states[k];
            let control = feedback.gain * state + feedback.offset;
            to.controls[k] = control;
            to.costates[k] = feedback.cost * state + feedback.slope;
            to.states[k + 1] = stage.motion.apply(&state, &control) + stage.defect;
        }
        let last = stages.len();
        to.costates[last] = end_cost * to.states[last] + end.gradient;
        Ok(())
    }
}

/// Eliminates the control of a stage: the cost to go of its first node, from that of its end.
fn backward(
    stage: &Stage,
    shift: f64,
    (cost, slope): (&SMatrix<f64, STATES, STATES>, &State),
    feedback: &mut Feedback,
) -> Result<(), Indefinite> {
    let motion = &stage.motion;
    let before = &cost.data.0;
    // Columns of H + Mᵀ P M from θ on; its first two rows are their first two elements.
    let mut columns = [[0.0; BOTH]; TURNED];
    for (j, column) in columns.iter_mut().enumerate() {
        let mut weighed = [0.0; STATES];
        for (row, slopes) in before.iter().zip(&motion.pose) {
            add(&mut weighed, slopes[j], row);
        }
        match j + THETA {
            V | OMEGA => add(&mut weighed, motion.kept, &before[j + THETA]),
            TIME => add(&mut weighed, 1.0, &before[TIME]),
            P => add(&mut weighed, 1.0, &before[V]),
            Q => add(&mut weighed, 1.0, &before[OMEGA]),
            _ => {}
        }
        *column = motion.transposed(&weighed);
        add(column, 1.0, &stage.hessian.data.0[j + THETA]);
        column[j + THETA] += shift;
    }
    let mut whole = [[0.0; STATES]; STATES];
    for (j, column) in whole.iter_mut().enumerate() {
        if j < THETA {
            for i in 0..THETA {
                column[i] = before[j][i] + stage.hessian[(i, j)];
            }
            column[j] += shift;
            for i in THETA..STATES {
                column[i] = columns[i - THETA][j];
            }
        } else {
            column.copy_from_slice(&columns[j - THETA][..STATES]);
        }
    }
    let [.., by_p, by_q] = &columns;
    let (a, b, d) = (by_p[P], by_p[Q], by_q[Q]);
    let determinant = a * d - b * b;
    if !(a > 0.0 && determinant > 1e-14 * a * d.abs()) {
        return Err(Indefinite);
    }
    let [a, b, d] = [d / determinant, -b / determinant, a / determinant];
    let gain: [[f64; CONTROLS]; STATES] =
        core::array::from_fn(|i| [-(a * by_p[i] + b * by_q[i]), -(b * by_p[i] + d * by_q[i])]);
    let cross = [by_p, by_q].map(|column| core::array::from_fn(|i| column[i]));
    for (column, [p, q]) in whole.iter_mut().zip(gain) {
        add(column, p, &cross[0]);
        add(column, q, &cross[1]);
    }
    // Rounding must not let the two halves drift apart.
    feedback.cost = SMatrix::from_fn(|i, j| whole[i.max(j)][i.min(j)]);
    let mut linear = slope.data.0[0];
    for (column, defect) in before.iter().zip(stage.defect.iter()) {
        add(&mut linear, *defect, column);
    }
    let mut linear = motion.transposed(&linear);
    add(&mut linear, 1.0, &stage.gradient.data.0[0]);
    let [.., p, q] = linear;
    let offset = [-(a * p + b * q), -(b * p + d * q)];
    let mut first: [f64; STATES] = core::array::from_fn(|i| linear[i]);
    add(&mut first, offset[0], &cross[0]);
    add(&mut first, offset[1], &cross[1]);
    feedback.slope = State::from(first);
    feedback.gain = SMatrix::from(gain);
    feedback.offset = Control::from(offset);
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
                motion: Transition {
                    pose: [(); 3].map(|()| [(); TURNED].map(|()| next())),
                    kept: next().round().abs(),
                },
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
                let motion = &stage.motion;
                match row {
                    X | Y | THETA => {
                        for (i, slope) in motion.pose[row].iter().enumerate() {
                            add(place(k, THETA + i), *slope);
                        }
                        add(place(k, row), f64::from(u8::from(row != THETA)));
                    }
                    TIME => add(place(k, TIME), 1.0),
                    _ => {
                        add(place(k, row), motion.kept);
                        add(place(k, row + P - V), 1.0);
                    }
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
