//! The robot's motion between two samples.

use core::f64::consts::FRAC_PI_2;

use nalgebra::{Point2, Vector2};

use crate::sample::Sample;

/// Turn (rad) over which three Gauss points integrate the path to 10⁻⁶ of its length, even where
/// the controls change sharply: 20 nm in the 2 cm between two samples.
const TURN_PER_STEP: f64 = 0.25;

/// Maximum number of steps of an integration. Only controls far beyond any limit need more, and
/// their trajectory is invalid in any case.
const MAX_STEPS: f64 = 64.0;

/// Nodes and weights of Gauss's three-point rule on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// A unicycle whose speed and turning rate change linearly in time.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Position at the start (m).
    pub start: Point2<f64>,
    /// Heading at the start (rad).
    pub heading: f64,
    /// Forward speed at the start and at the end (m/s).
    pub speed: [f64; 2],
    /// Turning rate at the start and at the end (rad/s).
    pub rate: [f64; 2],
    /// Duration (s) (≥ 0).
    pub dt: f64,
}

impl Piece {
    /// The motion that two samples claim between them.
    pub fn between(a: &Sample, b: &Sample) -> Self {
        Self {
            start: a.position(),
            heading: a.theta,
            speed: [a.v, b.v],
            rate: [a.omega, b.omega],
            dt: b.t - a.t,
        }
    }

    /// A straight line between two samples, regardless of their controls.
    pub fn chord(a: &Sample, b: &Sample) -> Self {
        Self {
            speed: [0.0; 2],
            rate: [0.0; 2],
            ..Self::between(a, b)
        }
    }

    /// Change of the heading (rad).
    pub fn turn(&self) -> f64 {
        self.dt * (self.rate[0] + self.rate[1]) / 2.0
    }

    /// Length of the path (m), forwards and backwards alike.
    pub fn length(&self) -> f64 {
        let [a, b] = self.speed;
        if self.reverses() {
            // Two triangles, before and after the reversal.
            self.dt * (a * a + b * b) / (2.0 * (b - a).abs())
        } else {
            self.dt * (a + b).abs() / 2.0
        }
    }

    /// Displacement (m) in the frame of the start: x ahead, y to the left.
    pub fn displacement(&self) -> Vector2<f64> {
        let steps = (self.most_turn() / TURN_PER_STEP)
            .ceil()
            .clamp(1.0, MAX_STEPS);
        let change = (self.rate[1] - self.rate[0]) / 2.0;
        let mut sum = Vector2::zeros();
        for step in 0..steps as u32 {
            for (node, weight) in GAUSS {
                let s = (f64::from(step) + node) / steps;
                let turned = self.dt * s * (self.rate[0] + change * s);
                let (sin, cos) = libm::sincos(turned);
                let speed = self.speed[0] + (self.speed[1] - self.speed[0]) * s;
                sum += weight * speed * Vector2::new(cos, sin);
            }
        }
        sum * (self.dt / steps)
    }

    /// Position at the end (m), by the controls.
    pub fn end(&self) -> Point2<f64> {
        self.start + rotated(self.displacement(), self.heading)
    }

    /// The same motion in two halves of time.
    pub fn halves(&self) -> [Self; 2] {
        let speed = f64::midpoint(self.speed[0], self.speed[1]);
        let rate = f64::midpoint(self.rate[0], self.rate[1]);
        let first = Self {
            speed: [self.speed[0], speed],
            rate: [self.rate[0], rate],
            dt: self.dt / 2.0,
            ..*self
        };
        let second = Self {
            start: first.end(),
            heading: self.heading + first.turn(),
            speed: [speed, self.speed[1]],
            rate: [rate, self.rate[1]],
            dt: self.dt / 2.0,
        };
        [first, second]
    }

    /// Upper bound (m) on the distance of a point of the path from the chord, the straight segment
    /// from the path's start to its end.
    ///
    /// Proof. Let r(t) be the path, T its duration, and c(t) the point that moves along the chord
    /// at constant speed. Along any fixed direction u, u·(r − c) vanishes at both ends, so it is at
    /// most T²/8 · max |u·r″|, the error of linear interpolation. With unit vectors e along the
    /// heading and n across it, r″ = v′e + vωn.
    ///
    /// * Always: |r″| ≤ |v′| + |vω|, and c(t) lies on the chord, so the distance to it is at most
    ///   T²/8 · (|v′| + max|v|·max|ω|).
    /// * If the robot does not reverse and turns by no more than Θ ≤ π/2 in all: the end minus the
    ///   start is a sum of headings of one sector of width Θ, hence within that sector, and the
    ///   heading is never more than δ ≤ Θ ≤ π/2 off the chord. Progress along the chord is then
    ///   monotone, each point has its foot on the chord, and only u across the chord counts:
    ///   |u·r″| ≤ |v′| sin δ + |vω| cos δ ≤ |v′|Θ + |vω|. The distance is at most
    ///   T²/8 · (|v′|Θ + max|v|·max|ω|).
    ///
    /// At constant controls the latter is the familiar path² · curvature / 8 = path · turn / 8.
    pub fn deviation(&self) -> f64 {
        let change = (self.speed[1] - self.speed[0]).abs();
        let turn = self.most_turn();
        let along = if !self.reverses() && turn <= FRAC_PI_2 {
            change * turn
        } else {
            change
        };
        let fastest = self.speed[0].abs().max(self.speed[1].abs());
        // T²|v′| is T·|change of v|, and T·max|ω| bounds the turn.
        self.dt * (along + fastest * turn) / 8.0
    }

    /// Bound on the sum of the turns in both directions (rad).
    fn most_turn(&self) -> f64 {
        self.dt * self.rate[0].abs().max(self.rate[1].abs())
    }

    fn reverses(&self) -> bool {
        self.speed[0].min(self.speed[1]) < 0.0 && self.speed[0].max(self.speed[1]) > 0.0
    }
}

/// A vector (of any unit) rotated counter-clockwise by an angle (rad).
pub fn rotated(vector: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(
        cos * vector.x - sin * vector.y,
        sin * vector.x + cos * vector.y,
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn piece(speed: [f64; 2], rate: [f64; 2], dt: f64) -> Piece {
        Piece {
            start: Point2::new(0.4, -0.7),
            heading: 0.6,
            speed,
            rate,
            dt,
        }
    }

    /// The motion cut into 2¹⁰ pieces, each a straight step.
    fn fragments(piece: &Piece) -> Vec<Piece> {
        let mut pieces = vec![*piece];
        for _ in 0..10 {
            pieces = pieces.iter().flat_map(Piece::halves).collect();
        }
        pieces
    }

    #[test]
    fn a_circular_arc_ends_where_geometry_says() {
        let arc = piece([0.2, 0.2], [0.5, 0.5], 3.0);
        let (sin, cos) = libm::sincos(1.5);
        let expected = 0.4 * Vector2::new(sin, 1.0 - cos);
        assert!((arc.displacement() - expected).norm() < 1e-8);
        assert!((arc.deviation() - arc.length() * arc.turn() / 8.0).abs() < 1e-12);
    }

    #[test]
    fn reversing_counts_the_way_both_ways() {
        let there_and_back = piece([0.3, -0.1], [0.0, 0.0], 4.0);
        assert!((there_and_back.length() - 0.5).abs() < 1e-12);
        assert!((there_and_back.displacement().x - 0.4).abs() < 1e-12);
        // It overshoots its end by 5 cm.
        assert!(there_and_back.deviation() >= 0.05);
    }

    proptest! {
        #[test]
        fn the_path_stays_within_its_deviation_of_the_chord(
            v0 in -1.0..1.0_f64, v1 in -1.0..1.0_f64,
            w0 in -4.0..4.0_f64, w1 in -4.0..4.0_f64,
            dt in 0.01..2.0_f64,
        ) {
            let whole = piece([v0, v1], [w0, w1], dt);
            let (a, b) = (whole.start, whole.end());
            let chord = b - a;
            let length = chord.norm();
            for fragment in fragments(&whole) {
                let offset = fragment.start - a;
                let along = (offset.dot(&chord) / (length * length).max(1e-300)).clamp(0.0, 1.0);
                let distance = (offset - chord * along).norm();
                prop_assert!(distance <= whole.deviation() + 1e-7, "{distance}");
            }
        }

        #[test]
        fn a_piece_and_its_fragments_agree(
            v0 in -1.0..1.0_f64, v1 in -1.0..1.0_f64,
            w0 in -4.0..4.0_f64, w1 in -4.0..4.0_f64,
            dt in 0.01..1.0_f64,
        ) {
            let whole = piece([v0, v1], [w0, w1], dt);
            let fragments = fragments(&whole);
            let last = fragments.last().unwrap();
            let fastest = v0.abs().max(v1.abs());
            prop_assert!((last.end() - whole.end()).norm() < 1e-6 * fastest * dt);
            prop_assert!((last.heading + last.turn() - whole.heading - whole.turn()).abs() < 1e-9);
            let length: f64 = fragments.iter().map(Piece::length).sum();
            prop_assert!((length - whole.length()).abs() < 1e-9);
        }
    }
}
