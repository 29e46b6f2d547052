//! Motion of the robot in a step in which both speeds change linearly in time.

use geometry::math;
use nalgebra::{Point2, Vector2};

/// Nodes and weights of Gauss's quadrature on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Pose and speeds at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position (m).
    pub at: Point2<f64>,
    /// Heading (rad).
    pub theta: f64,
    /// Forward speed (m/s).
    pub v: f64,
    /// Turning rate (rad/s).
    pub omega: f64,
}

/// The displacement of a step, with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Change of the position (m).
    pub displacement: Vector2<f64>,
    /// Its derivatives by the heading at the beginning, the two speeds, the two turning rates, and
    /// the duration.
    pub by_theta: Vector2<f64>,
    pub by_v: [Vector2<f64>; 2],
    pub by_omega: [Vector2<f64>; 2],
    pub by_time: Vector2<f64>,
    /// Change of the heading (rad).
    pub turn: f64,
}

/// The step from one node's pose and speeds to another's speeds in a time (s).
pub fn step(a: &Node, b: &Node, time: f64) -> Step {
    let mut step = Step {
        displacement: Vector2::zeros(),
        by_theta: Vector2::zeros(),
        by_v: [Vector2::zeros(); 2],
        by_omega: [Vector2::zeros(); 2],
        by_time: Vector2::zeros(),
        turn: 0.5 * (a.omega + b.omega) * time,
    };
    for (s, weight) in GAUSS {
        let v = a.v + (b.v - a.v) * s;
        let turned = a.omega * s + 0.5 * (b.omega - a.omega) * s * s;
        let (sin, cos) = math::sincos(a.theta + turned * time);
        let along = Vector2::new(cos, sin) * weight;
        let across = Vector2::new(-sin, cos) * (weight * v);
        step.displacement += along * (v * time);
        step.by_theta += across * time;
        step.by_v[0] += along * ((1.0 - s) * time);
        step.by_v[1] += along * (s * time);
        step.by_omega[0] += across * (time * time * (s - 0.5 * s * s));
        step.by_omega[1] += across * (time * time * 0.5 * s * s);
        step.by_time += along * v + across * (time * turned);
    }
    step
}

/// The node at a fraction (0…1) of a step.
pub fn within(a: &Node, b: &Node, time: f64, part: f64) -> Node {
    let mut end = *b;
    end.v = a.v + (b.v - a.v) * part;
    end.omega = a.omega + (b.omega - a.omega) * part;
    let step = step(a, &end, time * part);
    end.at = a.at + step.displacement;
    end.theta = a.theta + step.turn;
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(theta: f64, v: f64, omega: f64) -> Node {
        Node {
            at: Point2::new(0.3, -0.2),
            theta,
            v,
            omega,
        }
    }

    #[test]
    fn an_even_turn_is_an_arc() {
        let (a, b) = (node(0.4, 0.5, 1.0), node(0.0, 0.5, 1.0));
        let step = step(&a, &b, 0.5);
        let arc = |angle: f64| Vector2::new(math::sin(angle), -math::cos(angle)) * 0.5;
        assert!((step.displacement - (arc(0.9) - arc(0.4))).norm() < 1e-8);
        assert!((step.turn - 0.5).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let (a, b, time) = (node(0.4, 0.5, -0.7), node(0.0, 0.2, 1.3), 0.3);
        let exact = step(&a, &b, time);
        let h = 1e-6;
        let difference =
            |change: &dyn Fn(f64) -> Vector2<f64>| (change(h) - change(-h)) / (2.0 * h);
        let cases: [(Vector2<f64>, Vector2<f64>); 6] = [
            (
                exact.by_theta,
                difference(&|d| {
                    step(
                        &Node {
                            theta: a.theta + d,
                            ..a
                        },
                        &b,
                        time,
                    )
                    .displacement
                }),
            ),
            (
                exact.by_v[0],
                difference(&|d| step(&Node { v: a.v + d, ..a }, &b, time).displacement),
            ),
            (
                exact.by_v[1],
                difference(&|d| step(&a, &Node { v: b.v + d, ..b }, time).displacement),
            ),
            (
                exact.by_omega[0],
                difference(&|d| {
                    step(
                        &Node {
                            omega: a.omega + d,
                            ..a
                        },
                        &b,
                        time,
                    )
                    .displacement
                }),
            ),
            (
                exact.by_omega[1],
                difference(&|d| {
                    step(
                        &a,
                        &Node {
                            omega: b.omega + d,
                            ..b
                        },
                        time,
                    )
                    .displacement
                }),
            ),
            (
                exact.by_time,
                difference(&|d| step(&a, &b, time + d).displacement),
            ),
        ];
        for (found, want) in cases {
            assert!((found - want).norm() < 1e-8, "{found} {want}");
        }
    }
}
