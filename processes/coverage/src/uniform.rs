//! Independent uniform sub-goals: nothing to foretell, and no memory of what is covered.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use guidance::waypoint::WaypointKind;
use nalgebra::Point2;
use sim_backend::shape::Aabb;

use crate::counter::Counter;
use crate::decomposition::Decomposition;
use crate::draws::Draws;
use crate::goal::{Goal, GoalSource};
use crate::space::{Space, point_in};
use crate::workplace::Workplace;

/// Sub-goals uniform over the free space that can be reached, from a `ChaCha20` stream. Straight
/// legs where nothing is in the way, else through free rectangles.
#[derive(Debug, Clone)]
pub struct UniformGoals {
    space: Space,
    draws: Draws,
    way: VecDeque<(Point2<f64>, Aabb)>,
    counter: Counter,
}

impl UniformGoals {
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
            way: VecDeque::new(),
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
        self.way.clear();
        self
    }

    /// The same planner with a key of its own from here on, for an observer's guesses.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.draws = Draws::new(key);
        other.way.clear();
        other
    }

    /// A uniform point of the free space and the rectangle it lies in.
    fn draw(&mut self) -> Option<(usize, Point2<f64>)> {
        let all = self.space.decomposition();
        let members = self.space.members();
        let total: f64 = members.iter().map(|&r| all.area_of(r)).sum();
        let mut left = self.draws.unit() * total;
        let mut chosen = *members.last()?;
        for &rectangle in members {
            left -= all.area_of(rectangle);
            if left < 0.0 {
                chosen = rectangle;
                break;
            }
        }
        let unit = [self.draws.unit(), self.draws.unit()];
        Some((chosen, point_in(all.rectangles().get(chosen)?, unit)))
    }

    fn by_way(&mut self, from: Point2<f64>) -> Option<Goal> {
        let (to, within) = self.way.pop_front()?;
        if !within.contains(from) {
            // The robot is elsewhere: a goal was left out.
            self.way.clear();
            return None;
        }
        let kind = if self.way.is_empty() {
            WaypointKind::SubGoal
        } else {
            WaypointKind::Transit
        };
        Some(self.counter.goal(kind, to, Some(within)))
    }
}

impl GoalSource for UniformGoals {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        if !(from.x.is_finite() && from.y.is_finite()) {
            return None;
        }
        if !self.space.contains(from) {
            self.way.clear();
            let to = self.space.nearest(from);
            return Some(self.counter.goal(WaypointKind::Transit, to, None));
        }
        if let Some(goal) = self.by_way(from) {
            return Some(goal);
        }
        let (rectangle, to) = self.draw()?;
        if self.space.is_clear(from, to) {
            return Some(self.counter.goal(WaypointKind::SubGoal, to, None));
        }
        let draws = &mut self.draws;
        let home = self.space.member_at(from);
        self.way = self.space.legs(home, rectangle, to, || draws.unit()).into();
        self.by_way(from)
    }
}
