//! Planners that draw their sub-goals one by one from a keyed stream.

use std::collections::VecDeque;

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::WaypointKind;

use crate::counter::Counter;
use crate::decomposition::Decomposition;
use crate::draws::Draws;
use crate::goal::{Goal, GoalSource};
use crate::space::Space;
use crate::workplace::Workplace;

/// Common state of these planners: the free space, the stream, the numbers of the sub-goals and the
/// remaining legs of the current path.
#[derive(Debug, Clone)]
pub struct Wander {
    pub(crate) space: Space,
    pub(crate) draws: Draws,
    pub(crate) counter: Counter,
    /// Remaining legs, each with the rectangle that contains it.
    path: VecDeque<(Point2<f64>, Aabb)>,
}

/// Consequence of the robot's position, before any draw.
pub(crate) enum PositionRule {
    /// The position is not finite: no plan is possible.
    Nowhere,
    /// The robot is outside its space: back to the nearest place inside.
    Outside(Goal),
    /// The robot is on a path that was started before: its next leg.
    OnTheWay(Goal),
    /// None: the planner may choose.
    Free,
}

impl Wander {
    /// Creates the state for the reachable part of a workplace from `start` (m), with the key of the
    /// stream.
    pub(crate) fn new(space: Space, key: [u8; 32]) -> Self {
        Self {
            space,
            draws: Draws::new(key),
            counter: Counter::default(),
            path: VecDeque::new(),
        }
    }

    /// The same in another space: stream and numbers continue.
    pub(crate) fn moved(self, space: Space) -> Self {
        Self {
            space,
            path: VecDeque::new(),
            ..self
        }
    }

    /// The same with the stream of another key from here on.
    pub(crate) fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.draws = Draws::new(key);
        other.path.clear();
        other
    }

    /// Returns the consequence of the robot's position.
    pub(crate) fn standing(&mut self, from: Point2<f64>) -> PositionRule {
        if !(from.x.is_finite() && from.y.is_finite()) {
            return PositionRule::Nowhere;
        }
        if let Some(goal) = self.next_leg(from) {
            return PositionRule::OnTheWay(goal);
        }
        if self.space.contains(from) {
            return PositionRule::Free;
        }
        if self.space.reaches(from) {
            // In a part that others cover.
            let to = self.space.nearest_to_cover(from);
            let last = self.space.member_at(to);
            if let Some(goal) = self.set_out(from, last, to) {
                return PositionRule::OnTheWay(goal);
            }
        }
        let to = self.space.nearest(from);
        PositionRule::Outside(self.counter.goal(WaypointKind::Transit, to, None))
    }

    /// Starts the path through free rectangles to a point of the rectangle `last`; returns its first
    /// leg.
    pub(crate) fn set_out(
        &mut self,
        from: Point2<f64>,
        last: usize,
        to: Point2<f64>,
    ) -> Option<Goal> {
        let first = self.space.member_at(from);
        let draws = &mut self.draws;
        self.path = self.space.legs(first, last, to, || draws.unit()).into();
        self.next_leg(from)
    }

    /// A sub-goal at the end of a straight leg.
    pub(crate) fn sub_goal(&mut self, to: Point2<f64>, within: Option<Aabb>) -> Goal {
        self.counter.goal(WaypointKind::SubGoal, to, within)
    }

    fn next_leg(&mut self, from: Point2<f64>) -> Option<Goal> {
        let (to, within) = self.path.pop_front()?;
        if !within.contains(from) {
            // The robot is elsewhere because a goal was skipped.
            self.path.clear();
            return None;
        }
        let kind = if self.path.is_empty() {
            WaypointKind::SubGoal
        } else {
            WaypointKind::Transit
        };
        Some(self.counter.goal(kind, to, Some(within)))
    }
}

/// Choice of the next sub-goal by a planner without memory.
pub trait Rule {
    /// The sub-goal after `from` (m), which lies in the planner's space; `None` if there is none.
    fn choose(wander: &mut Wander, from: Point2<f64>) -> Option<Goal>;
}

/// A planner without memory of the covered area.
#[derive(Debug, Clone)]
pub struct Wanderer<R> {
    wander: Wander,
    rule: core::marker::PhantomData<R>,
}

impl<R> Wanderer<R> {
    /// Creates a planner for the reachable part of a workplace from `start` (m).
    pub fn new(
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
        key: [u8; 32],
    ) -> Self {
        let space = Space::new(workplace, decomposition, start);
        Self::from_wander(Wander::new(space, key))
    }

    /// The same planner in a changed workplace, from `start` (m): stream and numbers continue.
    #[must_use]
    pub fn moved(
        self,
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
    ) -> Self {
        let space = Space::new(workplace, decomposition, start);
        Self::from_wander(self.wander.moved(space))
    }

    /// The same planner with another key from here on, for an observer's guesses.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        Self::from_wander(self.wander.with_key(key))
    }

    fn from_wander(wander: Wander) -> Self {
        let rule = core::marker::PhantomData;
        Self { wander, rule }
    }
}

impl<R: Rule> GoalSource for Wanderer<R> {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        match self.wander.standing(from) {
            PositionRule::Nowhere => None,
            PositionRule::Outside(goal) | PositionRule::OnTheWay(goal) => Some(goal),
            PositionRule::Free => R::choose(&mut self.wander, from),
        }
    }
}
