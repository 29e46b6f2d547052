//! Order of the rectangles in a large loop, and the number of sub-goals of each.

use geometry::shape::Aabb;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::decomposition::Decomposition;

/// Order of the rectangles of a large loop.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Route {
    /// A depth-first walk from the start's rectangle through all reachable ones: neighbours by
    /// number, back through the rectangle of entry.
    #[default]
    Walk,
    /// A cycle of these rectangles; the loop begins at the start's rectangle. Neighbours in the
    /// list (and the last and the first) must be joined by a bridge.
    Cycle(Vec<usize>),
}

/// Number of sub-goals of rectangles in a large loop.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Iterations {
    /// This many in total, distributed over the rectangles of the tour by area, at least one each.
    InAll(u32),
    /// This many in each rectangle.
    Each(u32),
    /// One number for each rectangle, in the order of rectangles.
    By(Vec<u32>),
}

/// Reason why there is no tour.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TourError {
    /// An unknown rectangle.
    #[error(
        "route: there is no rectangle {rectangle}; the workplace is divided into rectangles 0 to \
         {last}: use one of these"
    )]
    NoSuchRectangle {
        /// Actual index.
        rectangle: usize,
        /// The largest index.
        last: usize,
    },
    /// A route that does not contain the rectangle of the start.
    #[error(
        "route: the robot starts in rectangle {start}, which the cycle does not visit; add it or \
         start elsewhere"
    )]
    StartNotOnRoute {
        /// The start's rectangle.
        start: usize,
    },
    /// Two consecutive rectangles that do not touch.
    #[error(
        "route: no bridge joins rectangles {from} and {to}; add one to `bridges` or visit a \
         rectangle between them"
    )]
    NotJoined {
        /// The first one.
        from: usize,
        /// The second one.
        to: usize,
    },
    /// A list of iterations of the wrong length.
    #[error("iterations: {found} numbers for {rectangles} rectangles: expected one for each")]
    IterationsMissing {
        /// Actual length.
        found: usize,
        /// Number of rectangles.
        rectangles: usize,
    },
    /// No rectangle gets a sub-goal.
    #[error("iterations: no rectangle of the tour gets a sub-goal: expected at least one")]
    NothingToDo,
}

/// A rectangle of a tour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stop {
    /// The rectangle.
    pub rectangle: usize,
    /// Number of sub-goals in it; 0 to pass through.
    pub iterations: u32,
}

/// A large loop: each stop is joined to the next by a bridge (or is the same rectangle), the last
/// one to the first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tour {
    /// Those on the way to the loop first.
    stops: Vec<Stop>,
    /// Number of stops before the loop.
    lead: usize,
}

impl Tour {
    /// Creates the tour from the rectangle `start`; the loop is that of the rectangles to cover.
    ///
    /// # Errors
    /// [`TourError`] names the mismatch with the decomposition.
    pub fn new(
        decomposition: &Decomposition,
        start: usize,
        route: &Route,
        iterations: &Iterations,
    ) -> Result<Self, TourError> {
        let count = decomposition.rectangles().len();
        let exists = |rectangle: usize| {
            let last = count.saturating_sub(1);
            (rectangle < count)
                .then_some(())
                .ok_or(TourError::NoSuchRectangle { rectangle, last })
        };
        exists(start)?;
        let home = nearest_own(decomposition, start);
        let mut lead = decomposition.path(start, home);
        lead.pop();
        let order = match route {
            Route::Walk => walk(decomposition, home),
            Route::Cycle(cycle) => {
                cycle.iter().try_for_each(|&rectangle| exists(rectangle))?;
                let first = cycle.iter().position(|&r| r == start);
                let first = first.ok_or(TourError::StartNotOnRoute { start })?;
                let (before, after) = cycle.split_at(first);
                [after, before].concat()
            }
        };
        let next = order.iter().skip(1).chain(order.first());
        for (&from, &to) in order.iter().zip(next) {
            if from != to && decomposition.bridge(from, to).is_none() {
                return Err(TourError::NotJoined { from, to });
            }
        }
        let shares = shares(decomposition, &order, iterations)?;
        let mut seen = vec![false; count];
        let toured = order.into_iter().map(|rectangle| {
            let first = seen
                .get_mut(rectangle)
                .is_some_and(|seen| !core::mem::replace(seen, true));
            let share = shares.get(rectangle).copied().unwrap_or(0);
            Stop {
                rectangle,
                iterations: if first && decomposition.is_own(rectangle) {
                    share
                } else {
                    0
                },
            }
        });
        let led = lead.iter().map(|&rectangle| Stop {
            rectangle,
            iterations: 0,
        });
        let stops: Vec<Stop> = led.chain(toured).collect();
        if stops.iter().all(|stop| stop.iterations == 0) {
            return Err(TourError::NothingToDo);
        }
        let lead = lead.len();
        Ok(Self { stops, lead })
    }

    /// The stops of a loop; at least one.
    pub fn stops(&self) -> &[Stop] {
        &self.stops[self.lead..]
    }

    /// A stop by its number from the start of the robot.
    pub(crate) fn stop(&self, number: usize) -> Option<Stop> {
        self.stops.get(number).copied()
    }

    /// Number of the stop after another one; not greater than it at the end of a loop.
    pub(crate) fn after(&self, number: usize) -> usize {
        let next = number + 1;
        if next < self.stops.len() {
            next
        } else {
            self.lead
        }
    }

    /// Number of sub-goals of a loop, without transits.
    pub fn iterations(&self) -> u64 {
        self.stops.iter().map(|s| u64::from(s.iterations)).sum()
    }
}

/// The rectangle to cover nearest to another one that is joined to it: itself if it is to be covered.
fn nearest_own(decomposition: &Decomposition, start: usize) -> usize {
    let component = decomposition.component_of(start).into_iter();
    let own = component.flat_map(|component| decomposition.component(component));
    let center = |r: usize| decomposition.rectangles().get(r).map(Aabb::center);
    let distance = |r: usize| {
        center(r)
            .zip(center(start))
            .map_or(f64::MAX, |(a, b)| (a - b).norm())
    };
    own.filter(|&r| decomposition.is_own(r))
        .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(start)
}

/// Depth-first walk over the rectangles to cover of a component, and those between them, including the
/// return to the start; the start itself is not repeated.
fn walk(decomposition: &Decomposition, start: usize) -> Vec<usize> {
    let mut seen = vec![false; decomposition.rectangles().len()];
    let mut order = Vec::new();
    // With the number of entries before its own.
    let mut trunk = vec![(start, 0)];
    while let Some(&(here, before)) = trunk.last() {
        if let Some(seen) = seen.get_mut(here) {
            *seen = true;
        }
        if order.last() != Some(&here) {
            order.push(here);
        }
        let new = |&(to, _): &(usize, _)| seen.get(to) == Some(&false);
        let joined = decomposition.neighbours(here).filter(new);
        if let Some((to, _)) = joined.min_by_key(|&(to, _)| !decomposition.is_own(to)) {
            trunk.push((to, order.len()));
            continue;
        }
        trunk.pop();
        // One that others cover leads to the rectangles behind it only.
        if order.len() == before + 1 && !decomposition.is_own(here) {
            order.pop();
        }
    }
    if order.len() > 1 {
        order.pop();
    }
    order
}

/// Sub-goals by rectangle.
fn shares(
    decomposition: &Decomposition,
    order: &[usize],
    iterations: &Iterations,
) -> Result<Vec<u32>, TourError> {
    let rectangles = decomposition.rectangles().len();
    Ok(match iterations {
        Iterations::Each(each) => vec![*each; rectangles],
        Iterations::By(numbers) if numbers.len() == rectangles => numbers.clone(),
        Iterations::By(numbers) => {
            let found = numbers.len();
            return Err(TourError::IterationsMissing { found, rectangles });
        }
        Iterations::InAll(0) => vec![0; rectangles],
        Iterations::InAll(all) => {
            let toured = (0..rectangles).filter(|r| order.contains(r) && decomposition.is_own(*r));
            let area: f64 = toured.map(|r| decomposition.area_of(r)).sum();
            let share = |r| (f64::from(*all) * decomposition.area_of(r) / area).round();
            (0..rectangles).map(|r| share(r).max(1.0) as u32).collect()
        }
    })
}

#[cfg(test)]
mod tests;
