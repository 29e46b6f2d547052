//! Motion of the robot in one stage, with first and second derivatives.
//!
//! In scaled units (`scaled`) a stage of the total time T has the displacement T/N ∫ v(s) (cos φ, sin φ) ds
//! over 0 ≤ s ≤ 1, with φ(s) = θ + κ T ∫ ω ds, by Gauss's quadrature. Both speeds change linearly in time,
//! v(s) = v + s p and ω(s) = ω + s q: states v and ω, controls p and q. Where speeds step they are constant,
//! v(s) = p and ω(s) = q, and the states v and ω only keep the last stage's speeds.

use nalgebra::{SMatrix, Vector2};

use crate::problem::Node;
use crate::riccati::{Point, Stage, State, TURNED, Transition};
use crate::sincos::sincos;
use crate::variables::{OMEGA, P, Q, THETA, TIME, V, X, Y};

/// Nodes and weights of Gauss's quadrature on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Their number.
const PARTS: usize = GAUSS.len();

/// Sines and cosines of the headings at Gauss's nodes.
pub type Headings = [[f64; PARTS]; 2];

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

/// Speeds in a stage: V and ω at its start, and their changes.
struct Speeds {
    v: f64,
    omega: f64,
    p: f64,
    q: f64,
}

/// Sums over Gauss's nodes of their weight, a function of φ and the powers of s.
#[derive(Clone, Copy, Default)]
struct Moments {
    /// Without the speed.
    plain: [f64; 4],
    /// Times v(s).
    driven: [f64; 5],
}

impl Moments {
    fn from_function(function: &[f64; PARTS], speeds: &Speeds) -> Self {
        let mut sums = Self::default();
        for ((s, weight), value) in GAUSS.into_iter().zip(function) {
            let powers = [1.0, s, s * s, s * s * s, s * s * s * s].map(|power| weight * power);
            let driven = value * (speeds.v + s * speeds.p);
            for (sum, power) in sums.plain.iter_mut().zip(powers) {
                *sum += power * value;
            }
            for (sum, power) in sums.driven.iter_mut().zip(powers) {
                *sum += power * driven;
            }
        }
        sums
    }

    /// a A + b B.
    fn mix([a, b]: [f64; 2], [first, second]: [&Self; 2]) -> Self {
        Self {
            plain: core::array::from_fn(|i| a * first.plain[i] + b * second.plain[i]),
            driven: core::array::from_fn(|i| a * first.driven[i] + b * second.driven[i]),
        }
    }
}

impl Motion {
    fn speeds(&self, w: &Point) -> Speeds {
        let [v, omega, p, q] = if self.steps {
            [w[P], w[Q], 0.0, 0.0]
        } else {
            [w[V], w[OMEGA], w[P], w[Q]]
        };
        Speeds { v, omega, p, q }
    }

    /// Sines and cosines of the headings in a stage.
    pub fn headings(&self, w: &Point) -> Headings {
        let Speeds { omega, q, .. } = self.speeds(w);
        let turn = self.turn * w[TIME];
        // A fourth lane fills the machine's pairs.
        let mut angles = [w[THETA]; PARTS + 1];
        for (angle, (s, _)) in angles.iter_mut().zip(GAUSS) {
            *angle += turn * (omega * s + q * (0.5 * s * s));
        }
        sincos(angles).map(|[a, b, c, _]| [a, b, c])
    }

    /// State at the end of a stage with these headings.
    pub fn next(&self, w: &Point, [sin, cos]: &Headings) -> State {
        let speeds = self.speeds(w);
        let (mut x, mut y) = (0.0, 0.0);
        for (i, (s, weight)) in GAUSS.into_iter().enumerate() {
            let speed = weight * (speeds.v + s * speeds.p);
            x += speed * cos[i];
            y += speed * sin[i];
        }
        let length = w[TIME] * self.share;
        self.moved(w, x * length, y * length)
    }

    fn moved(&self, w: &Point, x: f64, y: f64) -> State {
        let kept = if self.steps { 0.0 } else { 1.0 };
        let Speeds { omega, q, .. } = self.speeds(w);
        State::from([
            w[X] + x,
            w[Y] + y,
            w[THETA] + self.turn * w[TIME] * (omega + 0.5 * q),
            kept * w[V] + w[P],
            kept * w[OMEGA] + w[Q],
            w[TIME],
        ])
    }

    /// Sets the motion of a stage, its defect before the state `next`, and the Hessian of the
    /// Lagrangian's part with the motion.
    pub fn linearise(
        &self,
        w: &Point,
        [sin, cos]: &Headings,
        costate: &State,
        next: &State,
        stage: &mut Stage,
    ) {
        let speeds = self.speeds(w);
        let Speeds { omega, q, .. } = speeds;
        let (sin, cos) = (
            Moments::from_function(sin, &speeds),
            Moments::from_function(cos, &speeds),
        );
        let (share, kappa) = (self.share, self.turn);
        let (length, turn) = (share * w[TIME], kappa * w[TIME]);
        // Where speeds step, nothing depends on p and q.
        let kept = if self.steps { 0.0 } else { 1.0 };
        let half = 0.5 * kept;
        // Derivatives by θ, v, ω, T, p and q of the displacement with the factor `f` of v, which has
        // the derivative `df` by φ.
        let slopes = |f: &Moments, df: [f64; 5]| {
            [
                length * df[0],
                length * f.plain[0],
                length * turn * df[1],
                share * f.driven[0] + length * kappa * (omega * df[1] + 0.5 * q * df[2]),
                kept * length * f.plain[1],
                half * length * turn * df[2],
            ]
        };
        let whole = omega + 0.5 * q;
        let pose = [
            slopes(&cos, sin.driven.map(|sum| -sum)),
            slopes(&sin, cos.driven),
            [1.0, 0.0, turn, kappa * whole, 0.0, half * turn],
        ];
        stage.motion = Transition {
            pose: pose.map(|slopes| self.placed(slopes)),
            kept,
        };
        stage.defect = self.moved(w, length * cos.driven[0], length * sin.driven[0]) - next;
        // Along the costate, and its derivative by φ: across it.
        let along = Moments::mix([costate[X], costate[Y]], [&cos, &sin]);
        let across = Moments::mix([costate[Y], -costate[X]], [&cos, &sin]);
        let (a, b, c, e) = (along.driven, across.driven, along.plain, across.plain);
        // φ's derivative by T is κ (ω s + q s²/2).
        let turned = |sums: &[f64], power: usize| {
            kappa * (omega * sums[power + 1] + 0.5 * q * sums[power + 2])
        };
        let theta_v = length * e[0];
        let theta_omega = -length * turn * a[1];
        let theta_time = share * b[0] - length * turned(&a, 0);
        let theta_p = kept * length * e[1];
        let theta_q = -half * length * turn * a[2];
        let v_omega = length * turn * e[1];
        let v_time = share * c[0] + length * turned(&e, 0);
        let v_q = half * length * turn * e[2];
        let omega_time =
            length * (2.0 * kappa * b[1] - turn * turned(&a, 1)) + kappa * costate[THETA];
        let omega_p = kept * length * turn * e[2];
        let omega_q = -half * length * turn * turn * a[3];
        let time_p = kept * (share * c[1] + length * turned(&e, 1));
        let time_q =
            half * (length * (2.0 * kappa * b[2] - turn * turned(&a, 2)) + kappa * costate[THETA]);
        let p_q = half * length * turn * e[3];
        let time_time = 2.0 * share * turned(&b, 0)
            - length * kappa * (omega * turned(&a, 1) + 0.5 * q * turned(&a, 2));
        let omega_omega = -length * turn * turn * a[2];
        let q_q = -half * half * length * turn * turn * a[4];
        let bends = [
            [
                -length * a[0],
                theta_v,
                theta_omega,
                theta_time,
                theta_p,
                theta_q,
            ],
            [theta_v, 0.0, v_omega, v_time, 0.0, v_q],
            [
                theta_omega,
                v_omega,
                omega_omega,
                omega_time,
                omega_p,
                omega_q,
            ],
            [theta_time, v_time, omega_time, time_time, time_p, time_q],
            [theta_p, 0.0, omega_p, time_p, 0.0, p_q],
            [theta_q, v_q, omega_q, time_q, p_q, q_q],
        ];
        stage.hessian = SMatrix::zeros();
        for (column, bends) in stage.hessian.data.0[THETA..]
            .iter_mut()
            .zip(self.placed(bends))
        {
            column[THETA..].copy_from_slice(&self.placed(bends));
        }
    }

    /// Parts of θ, v, ω, T, p and q in the order of w.
    fn placed<A>(&self, [theta, v, omega, time, p, q]: [A; TURNED]) -> [A; TURNED] {
        if self.steps {
            [theta, p, q, time, v, omega]
        } else {
            [theta, v, omega, time, p, q]
        }
    }
}

impl Node {
    /// The node at a part (0…1) of a stage of this duration (s) that ends at the node `end`.
    #[must_use]
    pub fn within(&self, end: &Self, time: f64, part: f64) -> Self {
        let v = self.v + (end.v - self.v) * part;
        let omega = self.omega + (end.omega - self.omega) * part;
        let time = time * part;
        // A fourth lane fills the machine's pairs.
        let mut angles = [self.theta; PARTS + 1];
        for (angle, (s, _)) in angles.iter_mut().zip(GAUSS) {
            *angle += (self.omega * s + 0.5 * (omega - self.omega) * s * s) * time;
        }
        let [sin, cos] = sincos(angles);
        let mut moved = Vector2::zeros();
        for (i, (s, weight)) in GAUSS.into_iter().enumerate() {
            let length = weight * time * (self.v + (v - self.v) * s);
            moved += Vector2::new(cos[i], sin[i]) * length;
        }
        Self {
            at: self.at + moved,
            theta: self.theta + 0.5 * (self.omega + omega) * time,
            v,
            omega,
        }
    }
}

#[cfg(test)]
mod tests {
    use geometry::math;

    use super::*;
    use crate::riccati::{BOTH, CONTROLS, Control, STATES};

    fn next(motion: &Motion, w: &Point) -> State {
        motion.next(w, &motion.headings(w))
    }

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
        let curved = next(&motion(false), &w);
        // Length 0.025, turn 0.3 rad.
        let radius = 0.025 / 0.3;
        let x = radius * (math::sin(0.7) - math::sin(0.4));
        let y = radius * (math::cos(0.4) - math::cos(0.7));
        assert!((curved[X] - x).abs() < 1e-11 && (curved[Y] - y).abs() < 1e-11);
        assert!((curved[THETA] - 0.7).abs() < 1e-15);
        let w = Point::from([0.0, 0.0, 0.4, 9.0, 9.0, 1.0, 0.5, 1.0]);
        let stepped = next(&motion(true), &w);
        assert!((stepped.fixed_rows::<3>(0) - curved.fixed_rows::<3>(0)).norm() < 1e-15);
    }

    #[test]
    fn a_part_of_an_even_turn_is_an_arc() {
        let node = |theta: f64| Node {
            at: nalgebra::Point2::new(0.3, -0.2),
            theta,
            v: 0.5,
            omega: 1.0,
        };
        let end = node(0.4).within(&node(0.9), 1.0, 0.5);
        let arc = |angle: f64| Vector2::new(math::sin(angle), -math::cos(angle)) * 0.5;
        assert!((end.at - node(0.4).at - (arc(0.9) - arc(0.4))).norm() < 1e-8);
        assert!((end.theta - 0.9).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let costate = State::from([0.7, -1.3, 0.4, 0.2, -0.6, 0.3]);
        let h = 1e-6;
        for motion in [motion(false), motion(true)] {
            let linearised = |w: &Point| {
                let mut stage = Stage::default();
                let headings = motion.headings(w);
                motion.linearise(w, &headings, &costate, &State::zeros(), &mut stage);
                stage
            };
            let exact = linearised(&point());
            assert!((exact.defect - next(&motion, &point())).norm() < 1e-15);
            for i in 0..BOTH {
                let mut step = Point::zeros();
                step[i] = h;
                let (after, before) = (point() + step, point() - step);
                let slope = (next(&motion, &after) - next(&motion, &before)) / (2.0 * h);
                let mut one = Point::zeros();
                one[i] = 1.0;
                let (state, control) = (
                    one.fixed_rows::<STATES>(0),
                    one.fixed_rows::<CONTROLS>(STATES),
                );
                let moved = exact.motion.apply(&state.into(), &Control::from(control));
                assert!((slope - moved).norm() < 1e-9, "{i}");
                let gradient =
                    |w: &Point| Point::from(linearised(w).motion.transposed(&costate.data.0[0]));
                let bend = (gradient(&after) - gradient(&before)) / (2.0 * h);
                assert!((bend - exact.hessian.column(i)).norm() < 1e-8, "{i}");
            }
        }
    }
}
