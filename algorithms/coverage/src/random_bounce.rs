//! Random bounce: straight to the next wall, then in a random direction, as cleaning robots do.

#[cfg(test)]
mod tests;

use core::f64::consts::TAU;

use geometry::math::sincos;
use nalgebra::{Point2, Vector2};

use crate::goal::Goal;
use crate::space::point_in;
use crate::wander::{Rule, Wander, Wanderer};

/// Legs shorter than this (m) would end at the wall where the robot stands.
const MIN_LEG: f64 = 0.01;

/// Number of headings that are tried before a place counts as too narrow.
const ATTEMPTS: u32 = 256;

/// Sub-goals on walls and obstacles; the headings are uniform among those that lead away from them
/// and come from a `ChaCha20` stream.
///
/// A baseline without memory: it does not guarantee that narrow passages are found.
pub type RandomBounce = Wanderer<BounceRule>;

/// The rule: straight to the next wall.
#[derive(Debug, Clone)]
pub struct BounceRule;

impl Rule for BounceRule {
    fn choose(wander: &mut Wander, from: Point2<f64>) -> Option<Goal> {
        for _ in 0..ATTEMPTS {
            let (sin, cos) = sincos(wander.draws.unit() * TAU);
            let to = wander.space.ray_end(from, Vector2::new(cos, sin));
            if (to - from).norm() >= MIN_LEG && wander.space.contains(to) {
                return Some(wander.sub_goal(to, None));
            }
        }
        // A place hardly larger than a point: any position in it.
        let home = wander.space.member_at(from);
        let within = *wander.space.decomposition().rectangles().get(home)?;
        let to = point_in(&within, [wander.draws.unit(), wander.draws.unit()]);
        Some(wander.sub_goal(to, Some(within)))
    }
}
