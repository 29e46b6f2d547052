//! Motion of the robot in a part of a stage in which both speeds change linearly in time.

use geometry::math;
use nalgebra::Vector2;
use optimal_control::Node;

/// Nodes and weights of Gauss's quadrature on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// The node at a fraction (0…1) of a stage of this duration (s).
pub fn within(a: &Node, b: &Node, time: f64, part: f64) -> Node {
    let v = a.v + (b.v - a.v) * part;
    let omega = a.omega + (b.omega - a.omega) * part;
    let time = time * part;
    let mut moved = Vector2::zeros();
    for (s, weight) in GAUSS {
        let turned = a.omega * s + 0.5 * (omega - a.omega) * s * s;
        let (sin, cos) = math::sincos(a.theta + turned * time);
        moved += Vector2::new(cos, sin) * (weight * time * (a.v + (v - a.v) * s));
    }
    Node {
        at: a.at + moved,
        theta: a.theta + 0.5 * (a.omega + omega) * time,
        v,
        omega,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn an_even_turn_is_an_arc() {
        let node = |theta: f64| Node {
            at: Point2::new(0.3, -0.2),
            theta,
            v: 0.5,
            omega: 1.0,
        };
        let end = within(&node(0.4), &node(0.9), 1.0, 0.5);
        let arc = |angle: f64| Vector2::new(math::sin(angle), -math::cos(angle)) * 0.5;
        assert!((end.at - node(0.4).at - (arc(0.9) - arc(0.4))).norm() < 1e-8);
        assert!((end.theta - 0.9).abs() < 1e-15);
    }
}
