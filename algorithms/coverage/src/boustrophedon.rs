//! Boustrophedon: parallel lanes to and fro; the most efficient and the most predictable planner.

#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, VecDeque};

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::WaypointKind;
use thiserror::Error;

use crate::counter::Counter;
use crate::decomposition::Decomposition;
use crate::goal::{Goal, GoalSource};
use crate::space::Space;
use crate::workplace::Workplace;

/// Maximum number of lanes.
pub const MAX_LANES: usize = 1_000_000;

/// Subtracted from a number of lanes before rounding up, so that integers stay unchanged.
const WHOLE: f64 = 1e-9;

/// Reason why there are no lanes.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BoustrophedonError {
    /// A robot too small for its workplace.
    #[error(
        "lanes {spacing} m apart would be more than {MAX_LANES}: take a larger robot or a smaller \
         workplace"
    )]
    TooManyLanes {
        /// Distance between lanes (m).
        spacing: f64,
    },
}

/// Lanes at most two radii apart, along the longer side of each rectangle of the decomposition,
/// rectangle by rectangle in the order of a depth-first walk. It ends when all are driven; in a divided
/// workplace it begins anew, so that a robot of a team that stands has failed.
#[derive(Debug, Clone)]
pub struct Boustrophedon {
    space: Space,
    spacing: f64,
    /// Stack of rectangles to drive, the next one last.
    open: Vec<usize>,
    seen: BTreeSet<usize>,
    path: VecDeque<(Point2<f64>, Aabb, WaypointKind)>,
    counter: Counter,
}

impl Boustrophedon {
    /// Creates a planner for the reachable part of a workplace from `start` (m), for a robot that
    /// covers a disc of radius `disc` (m).
    ///
    /// # Errors
    /// [`BoustrophedonError`] if there are too many lanes or their distance is 0.
    pub fn new(
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
        disc: f64,
    ) -> Result<Self, BoustrophedonError> {
        let space = Space::new(workplace, decomposition, start);
        let spacing = 2.0 * disc;
        let lanes: f64 = space.rectangles().map(|r| lane_count(r, spacing)).sum();
        let few = spacing > 0.0 && lanes <= MAX_LANES as f64;
        if !few {
            return Err(BoustrophedonError::TooManyLanes { spacing });
        }
        let home = space.member_at(start);
        Ok(Self {
            space,
            spacing,
            open: vec![home],
            seen: BTreeSet::new(),
            path: VecDeque::new(),
            counter: Counter::default(),
        })
    }

    /// The same planner in a changed workplace, from `start` (m): the walk begins anew and numbers
    /// continue.
    ///
    /// # Errors
    /// [`BoustrophedonError`] if there are too many lanes.
    pub fn moved(
        self,
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
    ) -> Result<Self, BoustrophedonError> {
        let mut other = Self::new(workplace, decomposition, start, 0.5 * self.spacing)?;
        other.counter = self.counter;
        Ok(other)
    }

    /// The next rectangle of the walk.
    fn next_rectangle(&mut self) -> Option<usize> {
        while let Some(rectangle) = self.open.pop() {
            if self.seen.insert(rectangle) {
                let mut next: Vec<usize> = self
                    .space
                    .decomposition()
                    .neighbours(rectangle)
                    .map(|(other, _)| other)
                    .collect();
                next.reverse();
                let decomposition = self.space.decomposition();
                next.sort_by_key(|&other| decomposition.is_own(other));
                self.open.extend(next);
                if decomposition.is_own(rectangle) {
                    return Some(rectangle);
                }
            }
        }
        None
    }

    /// Plans the path to a rectangle and its lanes.
    fn plan(&mut self, from: Point2<f64>, home: usize, rectangle: usize) {
        let Some(&r) = self.space.decomposition().rectangles().get(rectangle) else {
            return;
        };
        let corners = lanes(&r, self.spacing, from);
        let Some(&first) = corners.first() else {
            return;
        };
        let legs = self.space.legs(home, rectangle, first, || 0.5);
        let transit = legs.len().saturating_sub(1);
        let there = legs.into_iter().take(transit);
        self.path
            .extend(there.map(|(to, within)| (to, within, WaypointKind::Transit)));
        let lanes = corners.into_iter().map(|to| (to, r, WaypointKind::SubGoal));
        self.path.extend(lanes);
    }
}

impl GoalSource for Boustrophedon {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        if !(from.x.is_finite() && from.y.is_finite()) {
            return None;
        }
        if !self.space.reaches(from) {
            let to = self.space.nearest(from);
            return Some(self.counter.goal(WaypointKind::Transit, to, None));
        }
        if self.path.is_empty() {
            let home = self.space.member_at(from);
            let mut next = self.next_rectangle();
            if next.is_none() && self.space.decomposition().is_divided() {
                (self.open, self.seen) = (vec![home], BTreeSet::new());
                self.counter.begin_round();
                next = self.next_rectangle();
            }
            let rectangle = next?;
            self.plan(from, home, rectangle);
        }
        let &(to, within, kind) = self.path.front()?;
        if !within.contains(from) {
            // The robot is elsewhere because a goal was skipped: back into the rectangle of this
            // leg.
            let (home, there) = (self.space.member_at(from), self.space.member_at(to));
            let back = self.space.legs(home, there, to, || 0.5);
            self.path.pop_front();
            for (point, rectangle) in back.into_iter().rev() {
                self.path
                    .push_front((point, rectangle, WaypointKind::Transit));
            }
        }
        let (to, within, kind) = self.path.pop_front().unwrap_or((to, within, kind));
        Some(self.counter.goal(kind, to, Some(within)))
    }
}

/// Number of lanes of a rectangle.
fn lane_count(r: &Aabb, spacing: f64) -> f64 {
    let size = r.max - r.min;
    let width = size.x.min(size.y);
    if width <= spacing {
        1.0
    } else {
        (width / spacing - WHOLE).ceil() + 1.0
    }
}

/// The ends of the lanes of a rectangle, in driving order, from the corner nearest to `from`.
fn lanes(r: &Aabb, spacing: f64, from: Point2<f64>) -> Vec<Point2<f64>> {
    let size = r.max - r.min;
    let along = usize::from(size.y > size.x);
    let across = 1 - along;
    let count = lane_count(r, spacing) as usize;
    let middle = r.center();
    let ends = |axis: usize| {
        if from[axis] > middle[axis] {
            [r.max[axis], r.min[axis]]
        } else {
            [r.min[axis], r.max[axis]]
        }
    };
    let (lengthwise, sideways) = (ends(along), ends(across));
    let mut points = Vec::with_capacity(2 * count);
    for lane in 0..count {
        let offset = if count == 1 {
            middle[across]
        } else {
            let part = lane as f64 / (count - 1) as f64;
            (sideways[0] + (sideways[1] - sideways[0]) * part).clamp(r.min[across], r.max[across])
        };
        let there_and_back = if lane % 2 == 0 { [0, 1] } else { [1, 0] };
        for end in there_and_back {
            let mut p = Point2::origin();
            p[along] = lengthwise[end];
            p[across] = offset;
            points.push(p);
        }
    }
    points
}
