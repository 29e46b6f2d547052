//! Random bounce: straight to the next wall, then on at a random angle, as cleaning robots do.

#[cfg(test)]
mod tests;

use core::f64::consts::TAU;

use guidance::waypoint::WaypointKind;
use nalgebra::{Point2, Vector2};
use sim_backend::math::sincos;

use crate::counter::Counter;
use crate::decomposition::Decomposition;
use crate::draws::Draws;
use crate::goal::{Goal, GoalSource};
use crate::space::{Space, point_in};
use crate::workplace::Workplace;

/// Legs shorter than this [m] would run into the wall that the robot stands at.
const SHORTEST_LEG: f64 = 0.01;

/// Headings tried before a place is given up as too narrow.
const ATTEMPTS: u32 = 256;

/// Sub-goals on walls and obstacles; the headings are uniform among those that lead away from them
/// and come from a `ChaCha20` stream.
///
/// A baseline: nothing is remembered, and nothing makes sure that narrow passages are found.
#[derive(Debug, Clone)]
pub struct RandomBounce {
    space: Space,
    draws: Draws,
    counter: Counter,
}

impl RandomBounce {
    /// A planner for the part of a workplace that can be reached from `start` [m].
    pub fn new(
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
        key: [u8; 32],
    ) -> Self {
        Self {
            space: Space::new(workplace, decomposition, start),
            draws: Draws::new(key),
            counter: Counter::default(),
        }
    }

    /// The same planner in a workplace that has changed, from `start` [m]: stream and numbers go on.
    #[must_use]
    pub fn moved(
        mut self,
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
    ) -> Self {
        self.space = Space::new(workplace, decomposition, start);
        self
    }

    /// The same planner with a key of its own from here on, for an observer's guesses.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.draws = Draws::new(key);
        other
    }
}

impl GoalSource for RandomBounce {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        if !(from.x.is_finite() && from.y.is_finite()) {
            return None;
        }
        if !self.space.contains(from) {
            let to = self.space.nearest(from);
            return Some(self.counter.goal(WaypointKind::Transit, to, None));
        }
        for _ in 0..ATTEMPTS {
            let (sin, cos) = sincos(self.draws.unit() * TAU);
            let to = self.space.ray_end(from, Vector2::new(cos, sin));
            if (to - from).norm() >= SHORTEST_LEG && self.space.contains(to) {
                return Some(self.counter.goal(WaypointKind::SubGoal, to, None));
            }
        }
        // A place hardly larger than a point: anywhere in it.
        let home = self.space.member_at(from);
        let within = *self.space.decomposition().rectangles().get(home)?;
        let to = point_in(&within, [self.draws.unit(), self.draws.unit()]);
        Some(self.counter.goal(WaypointKind::SubGoal, to, Some(within)))
    }
}
