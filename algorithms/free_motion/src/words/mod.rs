//! The fastest motions between two poses in free space, as sequences of arcs, straight lines and turns
//! on the spot. At full speed and full turning rate the robot drives arcs of one radius.
//!
//! Forwards only, without turns on the spot: L. E. Dubins, *On Curves of Minimal Length with a Constraint on Average Curvature*,
//! American Journal of Mathematics 79 (1957): at most three pieces, CSC or CCC (C an arc of the
//! minimum radius, S a straight line). Also backwards: J. A. Reeds and L. A. Shepp, *Optimal Paths for
//! a Car That Goes Both Forwards and Backwards*, Pacific Journal of Mathematics 145 (1990): at most five
//! pieces, by the formulas (8.1) to (8.11) of its section 8 and their symmetries. Every word is
//! followed to its end, and left out if that is not the goal.

mod formulas;
mod forwards;
mod reeds_shepp;

pub use forwards::{dubins, forwards};
pub use reeds_shepp::reeds_shepp;

use core::f64::consts::TAU;

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;

use crate::motion::Motion;

/// Maximum distance of a word's end from the goal, in radii and radians.
const AT_GOAL: f64 = 1e-6;
/// Number of headings at which a free heading is tried, and of bisections around the best.
const HEADINGS: (u32, u32) = (36, 24);

/// A piece of a word on the unit circle: its turn (1 to the left, −1 to the right, 0 straight), and
/// its length, negative backwards.
type Piece = (f64, f64);

/// The pieces of a word; those that it lacks have no length.
type Pieces = [Piece; 5];

/// A sequence of arcs and straight lines, with turns on the spot (rad) before and after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Word {
    spins: [f64; 2],
    pieces: Pieces,
    radius: f64,
}

impl Word {
    fn from_pieces(pieces: Pieces, radius: f64) -> Self {
        Self {
            spins: [0.0; 2],
            pieces,
            radius,
        }
    }

    /// Duration at full speed and full turning rate, as the length (m) driven in it: a turn on the
    /// spot lasts as long as an arc of the same angle.
    pub fn cost(&self) -> f64 {
        let pieces = self.pieces.iter().map(|piece| piece.1.abs());
        let spins = self.spins.iter().map(|spin| spin.abs());
        pieces.chain(spins).sum::<f64>() * self.radius
    }

    /// The pose (m, rad) at its end if it begins at `from`.
    pub fn end(&self, from: &Pose2) -> Pose2 {
        let [first, last] = self.spins;
        let first = Motion::Turn(first).end(from);
        let driven = self.pieces.iter().fold(first, |pose, &(turn, length)| {
            let (length, kappa) = (length * self.radius, turn / self.radius);
            Motion::Drive { length, kappa }.end(&pose)
        });
        Motion::Turn(last).end(&driven)
    }

    /// The word of a robot that is turned around: each piece in the other direction.
    #[must_use]
    pub fn backwards(mut self) -> Self {
        for (turn, length) in &mut self.pieces {
            (*turn, *length) = (-*turn, -*length);
        }
        self
    }

    /// Its motions.
    pub fn motions(&self) -> Vec<Motion> {
        let [first, last] = self.spins.map(Motion::turn);
        let drive =
            |&(turn, length): &Piece| Motion::drive(length * self.radius, turn / self.radius);
        let driven = self.pieces.iter().filter_map(drive);
        first.into_iter().chain(driven).chain(last).collect()
    }
}

/// The words from a pose to a place (m) with any heading: those to the heading with the fastest
/// word.
pub fn to_place(
    from: &Pose2,
    to: Point2<f64>,
    radius: f64,
    words: fn(&Pose2, &Pose2, f64) -> Vec<Word>,
) -> Vec<Word> {
    let at = |theta: f64| words(from, &Pose2::new(to.x, to.y, theta), radius);
    let cost = |theta: f64| {
        let costs = at(theta).into_iter().map(|word| word.cost());
        costs.fold(f64::INFINITY, f64::min)
    };
    let (count, bisections) = HEADINGS;
    let mut step = TAU / f64::from(count);
    let tried = (0..count).map(|i| from.theta + step * f64::from(i));
    let mut best =
        tried
            .map(|theta| (cost(theta), theta))
            .fold(
                (f64::INFINITY, from.theta),
                |a, b| if b.0 < a.0 { b } else { a },
            );
    for _ in 0..bisections {
        step *= 0.5;
        for theta in [best.1 - step, best.1 + step] {
            let found = cost(theta);
            if found < best.0 {
                best = (found, theta);
            }
        }
    }
    at(best.1)
}

/// The goal in the frame of the start, in radii.
fn relative(from: &Pose2, to: &Pose2, radius: f64) -> [f64; 3] {
    let offset = (to.position() - from.position()) / radius;
    let forward = from.forward();
    [
        forward.dot(&offset),
        forward.perp(&offset),
        math::angle_difference(to.theta, from.theta),
    ]
}

fn leads_to(word: &Word, from: &Pose2, to: &Pose2) -> bool {
    let end = word.end(from);
    let off = (end.position() - to.position()).norm() / word.radius;
    let scale = 1.0 + word.cost() / word.radius;
    off <= AT_GOAL * scale && math::angle_difference(end.theta, to.theta).abs() <= AT_GOAL * scale
}

fn word<const N: usize>(pieces: [Piece; N]) -> Pieces {
    let mut all = [(0.0, 0.0); 5];
    for (place, piece) in all.iter_mut().zip(pieces) {
        *place = piece;
    }
    all
}
