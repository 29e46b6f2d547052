//! Primal and dual variables, and their transfer to other stages.

use nalgebra::Vector2;

use crate::problem::{Node, Problem};
use crate::riccati::{CONTROLS, Control, Point, STATES, State};
use crate::scaled::ScaledProblem;
use crate::variables::{OMEGA, THETA, V, X, Y};

/// Minimum slack of a first guess.
const MIN_SLACK: f64 = 1e-3;
/// Minimum slack, and minimum dual of an active row, of variables that are carried over.
const CARRIED: [f64; 2] = [1e-8, 1e-2];

/// Primal and dual variables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Iterate {
    /// States of the nodes.
    pub states: Vec<State>,
    /// Controls of the stages.
    pub controls: Vec<Control>,
    /// Multipliers of the motion into each node; at the first node of its state.
    pub costates: Vec<State>,
    /// Multipliers of the prescribed components of the last state.
    pub end: State,
    /// Slack of each row, > 0.
    pub slack: Vec<f64>,
    /// Multiplier of each row, > 0.
    pub dual: Vec<f64>,
}

impl Iterate {
    /// Variables without multipliers of a guess.
    pub fn of_guess(scaled: &ScaledProblem, problem: &Problem<'_>, nodes: &[Node]) -> Self {
        let mut states: Vec<State> = nodes
            .iter()
            .map(|node| {
                let at = (node.at - scaled.origin) / scaled.length;
                State::from([
                    at.x,
                    at.y,
                    node.theta,
                    node.v / scaled.v,
                    node.omega / scaled.omega,
                    1.0,
                ])
            })
            .collect();
        let first = &mut states[0];
        (first[X], first[Y], first[THETA]) = (0.0, 0.0, problem.start_heading);
        for (i, speed, unit) in [
            (V, problem.start_speeds[0], scaled.v),
            (OMEGA, problem.start_speeds[1], scaled.omega),
        ] {
            first[i] = speed.map_or(first[i], |speed| speed / unit);
        }
        Self::new(scaled, states)
    }

    /// Variables without multipliers of states.
    fn new(problem: &ScaledProblem, mut states: Vec<State>) -> Self {
        let count = problem.count;
        let mut controls = Vec::with_capacity(count);
        for k in 0..count {
            let (a, b) = (states[k], states[k + 1]);
            controls.push(if problem.motion.steps {
                // The turning rate that the headings need.
                Control::new(
                    0.5 * (a[V] + b[V]),
                    (b[THETA] - a[THETA]) / problem.motion.turn,
                )
            } else {
                Control::new(b[V] - a[V], b[OMEGA] - a[OMEGA])
            });
        }
        if problem.motion.steps {
            // The last stage's speeds are no part of the motion.
            (states[0][V], states[0][OMEGA]) = (0.0, 0.0);
            for (state, control) in states.iter_mut().skip(1).zip(&controls) {
                (state[V], state[OMEGA]) = (control[0], control[1]);
            }
        }
        Self {
            costates: vec![State::zeros(); states.len()],
            states,
            controls,
            ..Self::default()
        }
    }

    /// The state and control of a stage; at the last node the control is 0.
    pub fn point(&self, k: usize) -> Point {
        let mut w = Point::zeros();
        w.fixed_rows_mut::<STATES>(0).copy_from(&self.states[k]);
        if let Some(control) = self.controls.get(k) {
            w.fixed_rows_mut::<CONTROLS>(STATES).copy_from(control);
        }
        w
    }

    /// Slacks and multipliers of the rows near the central path, from the states alone.
    pub fn center(&mut self, problem: &ScaledProblem, barrier: f64) {
        self.slack.resize(problem.rows.len(), 0.0);
        self.dual.resize(problem.rows.len(), 0.0);
        for k in 0..=problem.count {
            let w = self.point(k);
            for i in problem.stage_rows(k) {
                let room = -problem.rows[i].value(&w, &problem.obstacles);
                self.slack[i] = room.max(MIN_SLACK);
                self.dual[i] = barrier / self.slack[i];
            }
        }
    }

    /// Slacks near the central path for multipliers that are carried over.
    pub fn carry(&mut self, problem: &ScaledProblem, barrier: f64) {
        self.slack.resize(problem.rows.len(), 0.0);
        let [least, active] = CARRIED;
        for k in 0..=problem.count {
            let w = self.point(k);
            for i in problem.stage_rows(k) {
                let room = -problem.rows[i].value(&w, &problem.obstacles);
                // The multiplier of an active row gives its slack; the slack of another, its
                // multiplier.
                let slack = room.max(barrier / self.dual[i].max(active)).max(least);
                let central = barrier / slack;
                self.slack[i] = slack;
                self.dual[i] = self.dual[i].clamp(1e-3 * central, 1e4 * central);
            }
        }
    }

    /// The same motion with twice as many stages; `fine` has their motion, not yet their rows.
    pub fn doubled(&self, coarse: &ScaledProblem, fine: &ScaledProblem) -> Self {
        let mut to = Self {
            end: self.end,
            ..Self::default()
        };
        for k in 0..coarse.count {
            let half = if coarse.motion.steps {
                self.controls[k]
            } else {
                self.controls[k] * 0.5
            };
            let mut w = self.point(k);
            w.fixed_rows_mut::<CONTROLS>(STATES).copy_from(&half);
            to.states.extend([
                self.states[k],
                fine.motion.next(&w, &fine.motion.headings(&w)),
            ]);
            let between = (self.costates[k] + self.costates[k + 1]) * 0.5;
            to.costates.extend([self.costates[k], between]);
            to.controls.extend([half, half]);
        }
        to.states.push(self.states[coarse.count]);
        to.costates.push(self.costates[coarse.count]);
        to
    }

    /// Multipliers of the rows of `new` from those of `old`, which has as many stages or half as
    /// many.
    pub fn transfer(&mut self, dual: &[f64], old: &ScaledProblem, new: &ScaledProblem) {
        let ratio = new.count / old.count;
        self.dual.clear();
        for k in 0..=new.count {
            for row in &new.rows[new.stage_rows(k)] {
                let find = |stage: usize| {
                    let mut rows = old.stage_rows(stage.min(old.count));
                    rows.find(|&i| old.rows[i].is_like(row))
                        .map_or(0.0, |i| dual[i])
                };
                // A row of a node stands for the time around it, one of a change for itself.
                let (at, share) = (
                    k / ratio,
                    if row.is_rate() {
                        1.0
                    } else {
                        1.0 / ratio as f64
                    },
                );
                let between = k % ratio != 0 && !old.motion.steps && !row.is_rate();
                let dual = if between {
                    0.5 * (find(at) + find(at + 1))
                } else {
                    find(at)
                };
                self.dual.push(share * dual);
            }
        }
    }

    /// Position of a node.
    pub fn position(&self, k: usize) -> Vector2<f64> {
        self.states[k].fixed_rows::<2>(0).into()
    }
}
