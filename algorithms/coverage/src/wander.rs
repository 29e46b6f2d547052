//! Planners that draw their sub-goals from a keyed stream as the robot goes.

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

/// What such planners are made of: where the robot may be, the stream, the numbers of the sub-goals
/// and the legs of a way that is being driven.
#[derive(Debug, Clone)]
pub struct Wander {
    pub(crate) space: Space,
    pub(crate) draws: Draws,
    pub(crate) counter: Counter,
    /// Legs that are still to be driven, each with the rectangle that contains it.
    way: VecDeque<(Point2<f64>, Aabb)>,
}

/// What follows from where the robot stands, before anything is drawn.
pub(crate) enum Standing {
    /// Its place is no number: nothing can be planned.
    Nowhere,
    /// It is outside of its space: back to the nearest place inside.
    Outside(Goal),
    /// It is on a way that was set out on before: its next leg.
    OnTheWay(Goal),
    /// Nothing: the planner may choose.
    Free,
}

impl Wander {
    /// In the part of a workplace that can be reached from `start` (m), with the key of the stream.
    pub(crate) fn new(space: Space, key: [u8; 32]) -> Self {
        Self {
            space,
            draws: Draws::new(key),
            counter: Counter::default(),
            way: VecDeque::new(),
        }
    }

    /// The same in another space: stream and numbers go on.
    pub(crate) fn moved(self, space: Space) -> Self {
        Self {
            space,
            way: VecDeque::new(),
            ..self
        }
    }

    /// The same with the stream of another key from here on.
    pub(crate) fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.draws = Draws::new(key);
        other.way.clear();
        other
    }

    /// What follows from where the robot stands.
    pub(crate) fn standing(&mut self, from: Point2<f64>) -> Standing {
        if !(from.x.is_finite() && from.y.is_finite()) {
            return Standing::Nowhere;
        }
        if !self.space.contains(from) {
            self.way.clear();
            let to = self.space.nearest(from);
            return Standing::Outside(self.counter.goal(WaypointKind::Transit, to, None));
        }
        self.next_leg(from)
            .map_or(Standing::Free, Standing::OnTheWay)
    }

    /// Sets out on the way through free rectangles to a point of the rectangle `last`; the goal is
    /// its first leg.
    pub(crate) fn set_out(
        &mut self,
        from: Point2<f64>,
        last: usize,
        to: Point2<f64>,
    ) -> Option<Goal> {
        let first = self.space.member_at(from);
        let draws = &mut self.draws;
        self.way = self.space.legs(first, last, to, || draws.unit()).into();
        self.next_leg(from)
    }

    /// A sub-goal that a straight leg leads to.
    pub(crate) fn sub_goal(&mut self, to: Point2<f64>, within: Option<Aabb>) -> Goal {
        self.counter.goal(WaypointKind::SubGoal, to, within)
    }

    fn next_leg(&mut self, from: Point2<f64>) -> Option<Goal> {
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

/// How a planner without memory chooses its next sub-goal.
pub trait Rule {
    /// The sub-goal after `from` (m), which lies in the planner's space; `None` if there is none.
    fn choose(wander: &mut Wander, from: Point2<f64>) -> Option<Goal>;
}

/// A planner that remembers nothing of what it has covered.
#[derive(Debug, Clone)]
pub struct Wanderer<R> {
    wander: Wander,
    rule: core::marker::PhantomData<R>,
}

impl<R> Wanderer<R> {
    /// A planner for the part of a workplace that can be reached from `start` (m).
    pub fn new(
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
        key: [u8; 32],
    ) -> Self {
        let space = Space::new(workplace, decomposition, start);
        Self::of(Wander::new(space, key))
    }

    /// The same planner in a workplace that has changed, from `start` (m): stream and numbers go on.
    #[must_use]
    pub fn moved(
        self,
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
    ) -> Self {
        let space = Space::new(workplace, decomposition, start);
        Self::of(self.wander.moved(space))
    }

    /// The same planner with a key of its own from here on, for an observer's guesses.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        Self::of(self.wander.with_key(key))
    }

    fn of(wander: Wander) -> Self {
        let rule = core::marker::PhantomData;
        Self { wander, rule }
    }
}

impl<R: Rule> GoalSource for Wanderer<R> {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        match self.wander.standing(from) {
            Standing::Nowhere => None,
            Standing::Outside(goal) | Standing::OnTheWay(goal) => Some(goal),
            Standing::Free => R::choose(&mut self.wander, from),
        }
    }
}
