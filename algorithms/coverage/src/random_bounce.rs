//! Random bounce: straight to the next wall, then on at a random angle, as cleaning robots do.

#[cfg(test)]
mod tests;

use core::f64::consts::TAU;

use geometry::math::sincos;
use nalgebra::{Point2, Vector2};

use crate::goal::Goal;
use crate::space::point_in;
use crate::wander::{Rule, Wander, Wanderer};

/// Legs shorter than this (m) would run into the wall that the robot stands at.
const MIN_LEG: f64 = 0.01;

/// Headings tried before a place is given up as too narrow.
const ATTEMPTS: u32 = 256;

/// Sub-goals on walls and obstacles; the headings are uniform among those that lead away from them
/// and come from a `ChaCha20` stream.
///
/// A baseline: nothing is remembered, and nothing makes sure that narrow passages are found.
pub type RandomBounce = Wanderer<Bouncing>;

/// On to the next wall.
#[derive(Debug, Clone)]
pub struct Bouncing;

impl Rule for Bouncing {
    fn choose(wander: &mut Wander, from: Point2<f64>) -> Option<Goal> {
        for _ in 0..ATTEMPTS {
            let (sin, cos) = sincos(wander.draws.unit() * TAU);
            let to = wander.space.ray_end(from, Vector2::new(cos, sin));
            if (to - from).norm() >= MIN_LEG && wander.space.contains(to) {
                return Some(wander.sub_goal(to, None));
            }
        }
        // A place hardly larger than a point: anywhere in it.
        let home = wander.space.member_at(from);
        let within = *wander.space.decomposition().rectangles().get(home)?;
        let to = point_in(&within, [wander.draws.unit(), wander.draws.unit()]);
        Some(wander.sub_goal(to, Some(within)))
    }
}
