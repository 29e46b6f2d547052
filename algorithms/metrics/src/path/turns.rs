//! Headings of a path's legs, and the turns between them.

use core::f64::consts::PI;

use nalgebra::{Point2, Vector2};

/// Legs no longer than this (m) have no heading.
const MIN_LEG: f64 = 1e-12;

/// Headings (rad) in [−π, π] of the legs that are longer than 1e-12 m, in order.
pub fn headings(path: &[Point2<f64>]) -> Vec<f64> {
    legs(path).map(|leg| libm::atan2(leg.y, leg.x)).collect()
}

fn legs(path: &[Point2<f64>]) -> impl Iterator<Item = Vector2<f64>> + '_ {
    path.windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|leg| leg.norm() > MIN_LEG)
}

/// The turns of a path, each wrapped to [−π, π); counter-clockwise is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turns {
    /// Number of turns: one less than legs with a heading.
    pub count: usize,
    /// Mean turn, regardless of its direction (rad), in [0, π] (`MAA`); 0 without turns. A path
    /// with π/4 more than π/2 mostly goes back.
    pub maa: f64,
    /// Mean of min(turn, π − turn), regardless of direction (rad), in [0, π/2] (`MAA_fold`).
    /// Headings taken as slopes give this value; for comparison with the paper.
    pub maa_fold: f64,
    /// Minimum and maximum turn (rad) (`RA`); [0, 0] without turns.
    pub range: [f64; 2],
}

impl Turns {
    /// The turns of a path; legs no longer than 1e-12 m are skipped.
    pub fn from_path(path: &[Point2<f64>]) -> Self {
        let mut before: Option<Vector2<f64>> = None;
        let mut turns = Self {
            count: 0,
            maa: 0.0,
            maa_fold: 0.0,
            range: [0.0; 2],
        };
        for leg in legs(path) {
            if let Some(before) = before.replace(leg) {
                turns.add(turn(before, leg));
            }
        }
        if turns.count > 0 {
            turns.maa /= turns.count as f64;
            turns.maa_fold /= turns.count as f64;
        }
        turns
    }

    fn add(&mut self, turn: f64) {
        let [low, high] = self.range;
        self.range = if self.count == 0 {
            [turn, turn]
        } else {
            [low.min(turn), high.max(turn)]
        };
        self.count += 1;
        self.maa += turn.abs();
        self.maa_fold += turn.abs().min(PI - turn.abs());
    }
}

/// The turn from one leg to the next (rad), in [−π, π).
fn turn(before: Vector2<f64>, after: Vector2<f64>) -> f64 {
    let turn = libm::atan2(before.perp(&after), before.dot(&after));
    if turn >= PI { -PI } else { turn }
}
