//! Words of robots that only drive forwards.

use core::f64::consts::{FRAC_PI_2, TAU};

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Vector2;

use super::formulas::{lrl, lsl, lsr};
use super::{Word, leads_to, relative, word};

/// Angle (rad) that is 0 but for rounding.
const NO_ANGLE: f64 = 1e-9;

/// The Dubins words from one pose to another for a turning radius (m): one of each kind that leads
/// there.
pub fn dubins(from: &Pose2, to: &Pose2, radius: f64) -> Vec<Word> {
    let mut words = Vec::new();
    for mirror in [1.0, -1.0] {
        let [x, y, phi] = relative(from, to, radius);
        let (x, y, phi) = (x, mirror * y, mirror * phi);
        let found = [Some(lsl(x, y, phi)), lsr(x, y, phi), lrl(x, y, phi)];
        for mut pieces in found.into_iter().flatten() {
            for (turn, length) in &mut pieces {
                if *turn != 0.0 {
                    *length = ahead(*length);
                }
                *turn *= mirror;
            }
            words.push(Word::from_pieces(pieces, radius));
        }
    }
    words.retain(|word| leads_to(word, from, to));
    words
}

/// The Dubins words, and those with turns on the spot, from one pose to another for a turning radius
/// (m).
///
/// A robot that only drives forwards is fastest with a turn on the spot where a goal is far to its
/// side or behind: by Pontryagin's principle it turns on the spot until it is across the direction of
/// the line that follows, and then along a quarter circle into that line; and the same from the line to
/// the goal. (Its speed is full or 0 depending on the sign of the progress along one direction, that of
/// the line.)
pub fn forwards(from: &Pose2, to: &Pose2, radius: f64) -> Vec<Word> {
    let mut words = dubins(from, to, radius);
    let offset = (to.position() - from.position()) / radius;
    for (first, last) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        for spins in [[true, false], [false, true], [true, true]] {
            let end = |theta: f64, turn: f64, spins: bool| End { theta, turn, spins };
            let ends = [
                end(from.theta, first, spins[0]),
                end(to.theta, last, spins[1]),
            ];
            words.extend(spinning(offset, ends, radius));
        }
    }
    words.retain(|word| leads_to(word, from, to));
    words
}

/// The word to a place at an offset (radii) with a line and an arc at either end: a quarter circle
/// with a turn on the spot at its other end, or an arc from or to the heading there.
fn spinning(offset: Vector2<f64>, ends: [End; 2], radius: f64) -> Option<Word> {
    let [first, last] = ends;
    // From circle to circle; a quarter circle is replaced by the point one radius before or after the
    // line, on the line of the place.
    let between = offset - first.center() + last.center();
    let aside = last.turn - first.turn;
    let distance = between.norm();
    if aside.abs() > distance {
        return None;
    }
    let line = math::atan2(between.y, between.x) - math::asin(aside / distance);
    let quarters = ends.iter().filter(|end| end.spins).count() as f64;
    let length = (distance * distance - aside * aside).max(0.0).sqrt() - quarters;
    let (spin, arc) = first.split(line - first.theta)?;
    let (last_spin, last_arc) = last.split(last.theta - line)?;
    (length >= 0.0).then(|| Word {
        spins: [spin, last_spin],
        pieces: word([(first.turn, arc), (0.0, length), (last.turn, last_arc)]),
        radius,
    })
}

/// An end of a word with a line.
#[derive(Debug, Clone, Copy)]
struct End {
    /// The heading (rad).
    theta: f64,
    /// The turn of the arc.
    turn: f64,
    /// `true` for a turn on the spot and a quarter circle.
    spins: bool,
}

impl End {
    /// Centre of the arc's circle, relative to the place, if the arc begins or ends there.
    fn center(&self) -> Vector2<f64> {
        let (sin, cos) = math::sincos(self.theta);
        let size = if self.spins { 0.0 } else { self.turn };
        Vector2::new(-sin, cos) * size
    }

    /// The turn on the spot and the arc (rad) of a change of the heading.
    fn split(&self, change: f64) -> Option<(f64, f64)> {
        let angle = ahead(self.turn * change);
        if !self.spins {
            return Some((0.0, angle));
        }
        (angle >= FRAC_PI_2).then_some((self.turn * (angle - FRAC_PI_2), FRAC_PI_2))
    }
}

/// The angle in [0, 2π); 0 instead of a full circle that differs from it by rounding only.
fn ahead(angle: f64) -> f64 {
    let angle = angle.rem_euclid(TAU);
    if angle > TAU - NO_ANGLE { 0.0 } else { angle }
}
