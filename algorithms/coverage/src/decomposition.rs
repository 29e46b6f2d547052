//! The free space of a workplace as disjoint rectangles, and the connections between them.
//!
//! After the Chebyshev coverage paper, §5.1, with three corrections without which it stalls:
//!
//! - a *corner cell* is a cell that lacks a neighbour along x and one along y, so that there always
//!   is one (the printed extremes of coordinates may all be blocked);
//! - of all corner cells' largest rectangles the largest is taken, ties by position, so that the
//!   result does not depend on the order of the search;
//! - merged rectangles are disjoint, so that a transition rectangle is a *bridge* across the shared
//!   border rather than an overlap.

mod bridge;
mod cells;
mod merge;
mod strips;
#[cfg(test)]
mod tests;

pub use bridge::{Bridge, BridgeError};
pub use strips::Place;

use core::ops::Range;
use std::collections::VecDeque;

use geometry::shape::Aabb;
use nalgebra::Point2;
use thiserror::Error;

use crate::workplace::Workplace;
use cells::Cells;

/// Distance (m) below which lines coincide; shared borders must be longer than this.
pub(crate) const SAME: f64 = 1e-9;

/// Maximum number of cells into which the borders of obstacles may cut a workplace.
pub const MAX_CELLS: usize = 1_000_000;

/// Reason why a workplace cannot be divided.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DecompositionError {
    /// Obstacles cover the whole workplace.
    #[error(
        "the obstacles, grown by the robot's radius of {radius} m, leave no free space: take fewer \
         or smaller obstacles, a smaller robot, or a smaller tolerance of the conversion to \
         rectangles"
    )]
    NoFreeSpace {
        /// The robot's radius (m).
        radius: f64,
    },
    /// Too many different borders of obstacles.
    #[error(
        "the borders of {obstacles} rectangles cut the workplace into {cells} cells: expected at \
         most {MAX_CELLS}; take a larger tolerance of the conversion to rectangles"
    )]
    TooManyCells {
        /// Number of rectangles that represent the obstacles.
        obstacles: usize,
        /// Number of cells.
        cells: usize,
    },
}

/// Free space as rectangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Decomposition {
    rectangles: Vec<Aabb>,
    bridges: Vec<Bridge>,
    /// Per rectangle, its neighbours by index and the bridge to each.
    neighbours: Vec<Vec<(usize, usize)>>,
    /// Per rectangle, its component.
    components: Vec<usize>,
    component_count: usize,
    /// The rectangles to cover.
    own: Range<usize>,
}

impl Decomposition {
    /// Divides the free space of a workplace. Rectangles are numbered in the order in which they
    /// were taken.
    ///
    /// # Errors
    /// [`DecompositionError`] if there is no free space or the borders are too many.
    pub fn new(workplace: &Workplace) -> Result<Self, DecompositionError> {
        Self::in_strips(workplace, 0, &[], 0)
    }

    /// The same with no rectangle across the lines at `cuts` (m) across an axis; only the strip number
    /// `own` between them is to be covered.
    fn in_strips(
        workplace: &Workplace,
        axis: usize,
        cuts: &[f64],
        own: usize,
    ) -> Result<Self, DecompositionError> {
        let cells = Cells::new(workplace, axis, cuts)?;
        let (mut rectangles, mut owners) = (Vec::new(), vec![merge::UNOWNED; cells.count()]);
        let mut firsts = Vec::new();
        for strip in 0..=cuts.len() {
            firsts.push(rectangles.len());
            merge::merge(&cells, strip, &mut rectangles, &mut owners);
        }
        firsts.push(rectangles.len());
        if rectangles.is_empty() {
            return Err(DecompositionError::NoFreeSpace {
                radius: workplace.radius(),
            });
        }
        let bridges = bridge::between(&cells, &rectangles, &owners);
        let neighbours = neighbours(rectangles.len(), &bridges);
        let (components, component_count) = components(&neighbours);
        Ok(Self {
            rectangles: rectangles.iter().map(|r| cells.aabb(r)).collect(),
            bridges,
            neighbours,
            components,
            component_count,
            own: firsts[own]..firsts[own + 1],
        })
    }

    /// The same with one more bridge, for routes between rectangles without a shared border:
    /// `rectangle` (m) is free and overlaps both of `between` (the paper's `T_BDF`, by which case 2
    /// returns).
    ///
    /// # Errors
    /// [`BridgeError`] if the bridge is not free, does not reach both or joins rectangles that are
    /// already joined.
    pub fn with_bridge(
        mut self,
        workplace: &Workplace,
        between: [usize; 2],
        rectangle: Aabb,
    ) -> Result<Self, BridgeError> {
        let [a, b] = [between[0].min(between[1]), between[0].max(between[1])];
        let last = self.rectangles.len() - 1;
        let (Some(first), Some(second)) = (self.rectangles.get(a), self.rectangles.get(b)) else {
            return Err(BridgeError::NoSuchRectangle { rectangle: b, last });
        };
        if a == b || self.bridge(a, b).is_some() {
            return Err(BridgeError::Joined { between: [a, b] });
        }
        if !bridge::is_free(&rectangle, workplace) {
            return Err(BridgeError::NotFree { rectangle });
        }
        for (other, aabb) in [(a, first), (b, second)] {
            if bridge::depth(&rectangle, aabb) <= SAME {
                return Err(BridgeError::Apart { rectangle, other });
            }
        }
        self.bridges.push(Bridge {
            between: [a, b],
            rectangle,
        });
        self.neighbours = neighbours(self.rectangles.len(), &self.bridges);
        (self.components, self.component_count) = components(&self.neighbours);
        Ok(self)
    }

    /// The rectangles (m); disjoint except for their borders. At least one.
    pub fn rectangles(&self) -> &[Aabb] {
        &self.rectangles
    }

    /// Returns `true` if a rectangle is to be covered: all are, unless the workplace is
    /// [divided](Self::divided).
    pub fn is_own(&self, rectangle: usize) -> bool {
        self.own.contains(&rectangle)
    }

    /// Returns `true` if others cover some of the rectangles.
    pub fn is_divided(&self) -> bool {
        self.own.len() < self.rectangles.len()
    }

    /// The bridges, in the order of the rectangles that they join; added ones last.
    pub fn bridges(&self) -> &[Bridge] {
        &self.bridges
    }

    /// The rectangles that share a border with one, by index, each with the bridge to it.
    pub fn neighbours(&self, rectangle: usize) -> impl Iterator<Item = (usize, &Bridge)> {
        let list = self
            .neighbours
            .get(rectangle)
            .map_or(&[][..], Vec::as_slice);
        list.iter()
            .filter_map(|&(to, bridge)| Some((to, self.bridges.get(bridge)?)))
    }

    /// The bridge between two rectangles, if they share a border.
    pub fn bridge(&self, from: usize, to: usize) -> Option<&Bridge> {
        self.neighbours(from)
            .find(|&(other, _)| other == to)
            .map(|(_, bridge)| bridge)
    }

    /// Area of a rectangle (m²); 0 for an unknown index.
    pub fn area_of(&self, rectangle: usize) -> f64 {
        self.rectangles.get(rectangle).map_or(0.0, area)
    }

    /// Free area (m²).
    pub fn area(&self) -> f64 {
        self.rectangles.iter().map(area).sum()
    }

    /// Number of components of the free space: parts without a connection.
    pub fn components(&self) -> usize {
        self.component_count
    }

    /// The component of a rectangle; components are numbered by their first rectangles.
    pub fn component_of(&self, rectangle: usize) -> Option<usize> {
        self.components.get(rectangle).copied()
    }

    /// The rectangles of a component, by index.
    pub fn component(&self, component: usize) -> impl Iterator<Item = usize> {
        let members = self.components.iter().enumerate();
        members
            .filter(move |&(_, &c)| c == component)
            .map(|(rectangle, _)| rectangle)
    }

    /// The rectangles on a path of fewest borders from one rectangle to another, both included;
    /// only the last one if there is no path.
    pub fn path(&self, from: usize, to: usize) -> Vec<usize> {
        // The next rectangle towards `to`, by a search from there.
        let mut next = vec![usize::MAX; self.rectangles.len()];
        let mut open = VecDeque::from([to]);
        if let Some(own) = next.get_mut(to) {
            *own = to;
        }
        while let Some(rectangle) = open.pop_front() {
            for (other, _) in self.neighbours(rectangle) {
                if let Some(unset) = next.get_mut(other).filter(|n| **n == usize::MAX) {
                    *unset = rectangle;
                    open.push_back(other);
                }
            }
        }
        let mut path = vec![];
        let mut at = from;
        while let Some(&following) = next.get(at)
            && following != usize::MAX
            && at != to
        {
            path.push(at);
            at = following;
        }
        path.push(to);
        path
    }

    /// The free space that cannot be reached from a rectangle.
    pub fn unreachable_from(&self, rectangle: usize) -> Unreachable {
        let Some(own) = self.component_of(rectangle) else {
            return Unreachable::default();
        };
        let rectangles: Vec<usize> = (0..self.rectangles.len())
            .filter(|&r| self.component_of(r) != Some(own))
            .collect();
        Unreachable {
            components: self.component_count - 1,
            area: rectangles.iter().fold(0.0, |sum, &r| sum + self.area_of(r)),
            rectangles,
        }
    }

    /// The first rectangle that contains a point (m), borders included.
    pub fn rectangle_at(&self, p: Point2<f64>) -> Option<usize> {
        self.rectangles.iter().position(|r| r.contains(p))
    }

    /// The rectangle nearest to a point (m) and its distance (m); 0 inside. `None` for a point that
    /// is not finite.
    pub fn nearest_rectangle(&self, p: Point2<f64>) -> Option<(usize, f64)> {
        let distances = self.rectangles.iter().map(|r| r.distance(p)).enumerate();
        distances
            .filter(|_| p.x.is_finite() && p.y.is_finite())
            .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }
}

/// Free space that cannot be reached.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unreachable {
    /// Number of other components.
    pub components: usize,
    /// Their rectangles.
    pub rectangles: Vec<usize>,
    /// Their area (m²).
    pub area: f64,
}

fn area(r: &Aabb) -> f64 {
    let size = r.max - r.min;
    size.x * size.y
}

/// Per rectangle, its neighbours and the bridges to them, by number.
fn neighbours(rectangles: usize, bridges: &[Bridge]) -> Vec<Vec<(usize, usize)>> {
    let mut neighbours = vec![Vec::new(); rectangles];
    for (index, bridge) in bridges.iter().enumerate() {
        let [a, b] = bridge.between;
        for (from, to) in [(a, b), (b, a)] {
            if let Some(list) = neighbours.get_mut(from) {
                list.push((to, index));
            }
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
    }
    neighbours
}

/// Numbers the components, in the order of their first rectangles.
fn components(neighbours: &[Vec<(usize, usize)>]) -> (Vec<usize>, usize) {
    const NONE: usize = usize::MAX;
    let mut component = vec![NONE; neighbours.len()];
    let mut count = 0;
    for first in 0..neighbours.len() {
        if component.get(first).copied() != Some(NONE) {
            continue;
        }
        let mut open = vec![first];
        while let Some(rectangle) = open.pop() {
            let Some(mine) = component.get_mut(rectangle) else {
                continue;
            };
            if *mine == NONE {
                *mine = count;
                let next = neighbours.get(rectangle).map_or(&[][..], Vec::as_slice);
                open.extend(next.iter().map(|&(to, _)| to));
            }
        }
        count += 1;
    }
    (component, count)
}
