//! Motion of the robot in one stage, with first and second derivatives.
//!
//! In scaled units (`scaled`) a stage of the total time T has the displacement T/N ∫ v(s) (cos φ, sin φ) ds
//! over 0 ≤ s ≤ 1, with φ(s) = θ + κ T ∫ ω ds, by Gauss's quadrature. Both speeds change linearly in time,
//! v(s) = v + s p and ω(s) = ω + s q: states v and ω, controls p and q. Where speeds step they are constant,
//! v(s) = p and ω(s) = q, and the states v and ω only keep the last stage's speeds.

use geometry::math;
use nalgebra::{SMatrix, SVector};

use crate::riccati::{Point, Stage, State};
use crate::rows::{OMEGA, P, Q, THETA, TIME, V, X, Y};

/// Nodes and weights of Gauss's quadrature on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Number of components of w on which the motion depends: all from θ on.
const ARGUMENTS: usize = 6;
/// Their first index.
const FIRST: usize = THETA;

/// Motion in a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// `true` if speeds are constant in a stage and step between stages.
    pub steps: bool,
    /// 1/N: displacement at speed 1 in a stage of the total time 1.
    pub share: f64,
    /// κ: turn (rad) at turning rate 1 in a stage of the total time 1.
    pub turn: f64,
}

/// Factors of the states and controls of speeds.
struct Factors {
    /// Of v and p in v(s).
    v: [f64; 2],
    /// Of ω and q in the integral of ω up to s.
    turned: [f64; 2],
}

impl Motion {
    fn factors(&self, s: f64) -> Factors {
        if self.steps {
            Factors {
                v: [0.0, 1.0],
                turned: [0.0, s],
            }
        } else {
            Factors {
                v: [1.0, s],
                turned: [s, 0.5 * s * s],
            }
        }
    }

    /// State at the end of a stage.
    pub fn next(&self, w: &Point) -> State {
        let (mut x, mut y) = (0.0, 0.0);
        for (s, weight) in GAUSS {
            let Factors { v, turned } = self.factors(s);
            let turned = turned[0] * w[OMEGA] + turned[1] * w[Q];
            let (sin, cos) = math::sincos(w[THETA] + self.turn * w[TIME] * turned);
            let speed = weight * (v[0] * w[V] + v[1] * w[P]);
            x += speed * cos;
            y += speed * sin;
        }
        let length = w[TIME] * self.share;
        self.moved(w, x * length, y * length)
    }

    fn moved(&self, w: &Point, x: f64, y: f64) -> State {
        let kept = if self.steps { 0.0 } else { 1.0 };
        let [omega, q] = self.factors(1.0).turned;
        State::from([
            w[X] + x,
            w[Y] + y,
            w[THETA] + self.turn * w[TIME] * (omega * w[OMEGA] + q * w[Q]),
            kept * w[V] + w[P],
            kept * w[OMEGA] + w[Q],
            w[TIME],
        ])
    }

    /// Sets the motion of a stage, its defect before the state `next`, and the Hessian of the
    /// Lagrangian's part with the motion.
    pub fn linearise(&self, w: &Point, costate: &State, next: &State, stage: &mut Stage) {
        let mut moved = [0.0; 2];
        let mut slopes = SMatrix::<f64, 3, ARGUMENTS>::zeros();
        let mut bends = SMatrix::<f64, ARGUMENTS, ARGUMENTS>::zeros();
        let [v, omega, time, p, q] = [V, OMEGA, TIME, P, Q].map(|i| i - FIRST);
        let turn = self.turn * w[TIME];
        for (s, weight) in GAUSS {
            let factors = self.factors(s);
            let turned = factors.turned[0] * w[OMEGA] + factors.turned[1] * w[Q];
            let (sin, cos) = math::sincos(w[THETA] + turn * turned);
            let speed = factors.v[0] * w[V] + factors.v[1] * w[P];
            let weight = weight * self.share;
            let length = weight * w[TIME];
            let driven = length * speed;
            moved[0] += driven * cos;
            moved[1] += driven * sin;
            // Derivatives of φ, and of the length T v.
            let mut by_phi = SVector::<f64, ARGUMENTS>::zeros();
            by_phi[0] = 1.0;
            by_phi[omega] = turn * factors.turned[0];
            by_phi[q] = turn * factors.turned[1];
            by_phi[time] = self.turn * turned;
            let mut by_length = SVector::<f64, ARGUMENTS>::zeros();
            by_length[v] = length * factors.v[0];
            by_length[p] = length * factors.v[1];
            by_length[time] = weight * speed;
            for i in 0..ARGUMENTS {
                slopes[(0, i)] += by_length[i] * cos - driven * sin * by_phi[i];
                slopes[(1, i)] += by_length[i] * sin + driven * cos * by_phi[i];
            }
            // Along and across the costate.
            let along = costate[X] * cos + costate[Y] * sin;
            let across = costate[Y] * cos - costate[X] * sin;
            for j in 0..ARGUMENTS {
                for i in j..ARGUMENTS {
                    bends[(i, j)] += across * (by_length[i] * by_phi[j] + by_length[j] * by_phi[i])
                        - driven * along * by_phi[i] * by_phi[j];
                }
            }
            // Mixed second derivatives of the length and of φ; the indices are in order.
            bends[(time, v)] += weight * factors.v[0] * along;
            bends[(p, time)] += weight * factors.v[1] * along;
            bends[(time, omega)] += driven * across * self.turn * factors.turned[0];
            bends[(q, time)] += driven * across * self.turn * factors.turned[1];
        }
        let whole = self.factors(1.0).turned;
        slopes[(2, omega)] = turn * whole[0];
        slopes[(2, q)] = turn * whole[1];
        slopes[(2, time)] = self.turn * (whole[0] * w[OMEGA] + whole[1] * w[Q]);
        bends[(time, omega)] += costate[THETA] * self.turn * whole[0];
        bends[(q, time)] += costate[THETA] * self.turn * whole[1];
        for j in 0..ARGUMENTS {
            for i in 0..j {
                bends[(i, j)] = bends[(j, i)];
            }
        }
        stage.defect = self.moved(w, moved[0], moved[1]) - next;
        stage.hessian.fill(0.0);
        let at = (FIRST, FIRST);
        stage
            .hessian
            .fixed_view_mut::<ARGUMENTS, ARGUMENTS>(at.0, at.1)
            .copy_from(&bends);
        stage.motion.fill(0.0);
        stage
            .motion
            .fixed_view_mut::<3, ARGUMENTS>(0, FIRST)
            .copy_from(&slopes);
        for i in [X, Y, THETA, TIME] {
            stage.motion[(i, i)] += 1.0;
        }
        for (state, control) in [(V, P), (OMEGA, Q)] {
            stage.motion[(state, state)] = if self.steps { 0.0 } else { 1.0 };
            stage.motion[(state, control)] = 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::riccati::BOTH;

    fn motion(steps: bool) -> Motion {
        Motion {
            steps,
            share: 0.05,
            turn: 0.3,
        }
    }

    fn point() -> Point {
        Point::from([0.1, -0.2, 0.4, 0.8, 0.6, 1.1, -0.3, 0.5])
    }

    #[test]
    fn an_even_turn_is_an_arc() {
        let w = Point::from([0.0, 0.0, 0.4, 0.5, 1.0, 1.0, 0.0, 0.0]);
        let next = motion(false).next(&w);
        // Length 0.025, turn 0.3 rad.
        let radius = 0.025 / 0.3;
        let x = radius * (math::sin(0.7) - math::sin(0.4));
        let y = radius * (math::cos(0.4) - math::cos(0.7));
        assert!((next[X] - x).abs() < 1e-11 && (next[Y] - y).abs() < 1e-11);
        assert!((next[THETA] - 0.7).abs() < 1e-15);
        let w = Point::from([0.0, 0.0, 0.4, 9.0, 9.0, 1.0, 0.5, 1.0]);
        let stepped = motion(true).next(&w);
        assert!((stepped.fixed_rows::<3>(0) - next.fixed_rows::<3>(0)).norm() < 1e-15);
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let costate = State::from([0.7, -1.3, 0.4, 0.2, -0.6, 0.3]);
        let h = 1e-6;
        for motion in [motion(false), motion(true)] {
            let linearised = |w: &Point| {
                let mut stage = Stage::default();
                motion.linearise(w, &costate, &State::zeros(), &mut stage);
                stage
            };
            let exact = linearised(&point());
            assert!((exact.defect - motion.next(&point())).norm() < 1e-15);
            for i in 0..BOTH {
                let mut step = Point::zeros();
                step[i] = h;
                let (after, before) = (point() + step, point() - step);
                let slope = (motion.next(&after) - motion.next(&before)) / (2.0 * h);
                assert!((slope - exact.motion.column(i)).norm() < 1e-9, "{i}");
                let gradient = |w: &Point| linearised(w).motion.tr_mul(&costate);
                let bend = (gradient(&after) - gradient(&before)) / (2.0 * h);
                assert!((bend - exact.hessian.column(i)).norm() < 1e-8, "{i}");
            }
        }
    }
}
