//! The problem in scaled units, with the inequalities of every stage.
//!
//! Positions less the start's, in units of the length that the robot drives in the guess's duration;
//! times in units of that duration; speeds in units of their limits. All variables are then near 1.

use core::ops::Range;

use geometry::math;
use nalgebra::{Point2, Vector2};

use crate::motion::Motion;
use crate::problem::{Node, Problem};
use crate::riccati::{Point, STATES, State};
use crate::rows::{Obstacle, Row};
use crate::variables::{OMEGA, P, Q, THETA, TIME, V, X, Y};
use trajectory_problem::{RobotLimits, Wheels};

/// Distance from a node within which its obstacles and bounds are considered.
const REACH: f64 = 0.1;
/// Violation that is more than a coarse search's error.
const VIOLATED: f64 = 1e-3;

/// The scaled problem.
#[derive(Debug, Clone)]
pub struct ScaledProblem {
    /// Position (m) of the origin.
    pub origin: Point2<f64>,
    /// Unit of length (m).
    pub length: f64,
    /// Unit of time (s).
    pub duration: f64,
    /// Unit of V (m/s).
    pub v: f64,
    /// Unit of ω (rad/s).
    pub omega: f64,
    /// Number of stages.
    pub count: usize,
    /// Motion in a stage.
    pub motion: Motion,
    /// Free components of the first state.
    pub free: [bool; STATES],
    /// Prescribed components of the last state.
    pub targets: [Option<f64>; STATES],
    /// Obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Inequalities of all stages in order; those of the last node follow.
    pub rows: Vec<Row>,
    /// Index of the first row of each stage.
    first: Vec<usize>,
    speed_rows: Vec<Row>,
    acceleration_rows: Vec<Row>,
    bounds: [Vector2<f64>; 2],
}

impl ScaledProblem {
    /// Scales a problem for a guess of at least two nodes over a duration (s); the inequalities
    /// follow by [`Self::set_rows`].
    pub fn new(problem: &Problem<'_>, guess: &[Node], duration: f64) -> Self {
        let limits = &problem.limits;
        let v = limits.top_speed();
        let omega = limits.top_turn_rate();
        let length = v * duration;
        let steps = limits.is_without_inertia();
        let free_speed = |k: usize| !steps && problem.start_speeds[k].is_none();
        let goal = (problem.goal - problem.start) / length;
        // Of the goal's headings, the one that is nearest to the guess's.
        let near = guess.last().map_or(0.0, |node| node.theta);
        let heading = |h: f64| near + math::angle_difference(h, near);
        let mut scaled = Self {
            origin: problem.start,
            length,
            duration,
            v,
            omega,
            count: 0,
            motion: Motion {
                steps,
                share: 0.0,
                turn: 0.0,
            },
            free: [false, false, false, free_speed(0), free_speed(1), true],
            targets: [
                Some(goal.x),
                Some(goal.y),
                problem.goal_heading.map(heading),
                problem.goal_speed.filter(|_| !steps).map(|speed| speed / v),
                None,
                None,
            ],
            obstacles: problem
                .obstacles
                .iter()
                .map(|keep| Obstacle::new(keep.shape, keep.distance, problem.start, length))
                .collect(),
            rows: Vec::new(),
            first: Vec::new(),
            speed_rows: Vec::new(),
            acceleration_rows: Vec::new(),
            bounds: [problem.bounds.min, problem.bounds.max].map(|p| (p - problem.start) / length),
        };
        scaled.speed_rows = scaled.speed_limits(limits);
        scaled.set_count(guess.len().saturating_sub(1), limits);
        scaled
    }

    /// Sets the number of stages.
    pub fn set_count(&mut self, count: usize, limits: &RobotLimits) {
        self.count = count;
        self.motion = Motion {
            steps: self.motion.steps,
            share: 1.0 / count as f64,
            turn: self.omega * self.duration / count as f64,
        };
        self.acceleration_rows = self.acceleration_limits(limits);
    }

    /// Sets the inequalities of all stages: those that the states may touch.
    pub fn set_rows(&mut self, states: &[State]) {
        self.first.clear();
        self.rows.clear();
        for (k, state) in states.iter().enumerate() {
            self.first.push(self.rows.len());
            let limited = if self.motion.steps {
                k < self.count
            } else {
                k > 0 || self.free[V] || self.free[OMEGA]
            };
            if limited {
                // A bound of a given speed has no unique multiplier.
                let given = |i: usize| {
                    (k == 0 && !self.free[i]) || (k == self.count && self.targets[i].is_some())
                };
                let steps = self.motion.steps;
                let rows = self.speed_rows.iter();
                self.rows
                    .extend(rows.filter(|row| steps || !row.is_of(given)).copied());
            }
            if k < self.count {
                self.rows.extend_from_slice(&self.acceleration_rows);
            }
            // Both ends are given.
            if k > 0 && k < self.count {
                self.add_places(Point2::new(state[X], state[Y]));
            }
        }
        self.first.push(self.rows.len());
    }

    /// Returns `true` if the states violate a place's inequality that they lack: one out of reach when the
    /// inequalities were set.
    pub fn lacks_rows(&self, states: &[State]) -> bool {
        let [low, high] = self.bounds;
        let edges = [X, Y].map(|i| [Row::bound(i, -1.0, -low[i]), Row::bound(i, 1.0, high[i])]);
        (1..self.count).any(|k| {
            let w = Point::from_fn(|i, _| if i < STATES { states[k][i] } else { 0.0 });
            let known = &self.rows[self.stage_rows(k)];
            let contacts = (0..self.obstacles.len()).map(|obstacle| Row::Contact { obstacle });
            contacts.chain(edges.into_iter().flatten()).any(|row| {
                row.value(&w, &self.obstacles) > VIOLATED
                    && !known.iter().any(|own| own.is_like(&row))
            })
        })
    }

    fn add_places(&mut self, at: Point2<f64>) {
        let [low, high] = self.bounds;
        for (i, axis) in [X, Y].into_iter().enumerate() {
            if at[i] < low[i] + REACH {
                self.rows.push(Row::bound(axis, -1.0, -low[i]));
            }
            if at[i] > high[i] - REACH {
                self.rows.push(Row::bound(axis, 1.0, high[i]));
            }
        }
        for (obstacle, shape) in self.obstacles.iter().enumerate() {
            if shape.distance(at) < REACH {
                self.rows.push(Row::Contact { obstacle });
            }
        }
    }

    fn speed_limits(&self, limits: &RobotLimits) -> Vec<Row> {
        let (v, omega) = if self.motion.steps {
            (P, Q)
        } else {
            (V, OMEGA)
        };
        let turn = limits.omega_max / self.omega;
        let mut rows = vec![
            Row::bound(v, -1.0, -limits.v_min / self.v),
            Row::bound(v, 1.0, limits.v_max / self.v),
            Row::bound(omega, -1.0, turn),
            Row::bound(omega, 1.0, turn),
        ];
        if let Some(Wheels { speed, separation }) = limits.wheels {
            let side = 0.5 * separation * self.omega / self.v;
            let signs: &[f64] = if limits.v_min < 0.0 {
                &[1.0, -1.0]
            } else {
                &[1.0]
            };
            for &sign in signs {
                for side in [side, -side] {
                    rows.push(Row::Linear {
                        at: [v, omega],
                        factors: [sign, side],
                        limit: speed / self.v,
                    });
                }
            }
        }
        rows
    }

    /// The changes of speeds in a stage of T/N.
    fn acceleration_limits(&self, limits: &RobotLimits) -> Vec<Row> {
        let per_stage = self.duration / self.count as f64;
        let axes = [
            (P, limits.acceleration, self.v),
            (Q, limits.angular_acceleration, self.omega),
        ];
        let mut rows = Vec::new();
        for (i, limit, unit) in axes {
            let Some(limit) = limit else { continue };
            for sign in [1.0, -1.0] {
                rows.push(Row::Linear {
                    at: [i, TIME],
                    factors: [sign, -limit * per_stage / unit],
                    limit: 0.0,
                });
            }
        }
        rows
    }

    /// Indices of the rows of a stage, or of the last node.
    pub fn stage_rows(&self, k: usize) -> Range<usize> {
        self.first[k]..self.first[k + 1]
    }

    /// Prescribed components of the last state, with their values.
    pub fn prescribed(&self) -> impl Iterator<Item = (usize, f64)> {
        [X, Y, THETA, V]
            .into_iter()
            .filter_map(|i| self.targets[i].map(|target| (i, target)))
    }
}
