//! The free space that a robot can reach, for planners that move freely in it.

#[cfg(test)]
mod tests;

use geometry::shape::Aabb;
use nalgebra::{Point2, Vector2};

use crate::decomposition::Decomposition;
use crate::workplace::Workplace;

/// Depth inside an obstacle that does not count as contact (m): the rounding of coordinates.
const TOUCH: f64 = 1e-9;

/// Distance from an obstacle at which a leg that would hit it ends (m).
const STAND_OFF: f64 = 1e-6;

/// The component of a workplace's free space that contains the start, and the part of it to cover.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    decomposition: Decomposition,
    inflated: Vec<Aabb>,
    reachable: Vec<usize>,
    members: Vec<usize>,
    bounds: Aabb,
}

impl Space {
    /// Creates the space that is reachable from `start` (m), or from the free rectangle nearest to
    /// it.
    pub fn new(workplace: &Workplace, decomposition: &Decomposition, start: Point2<f64>) -> Self {
        let home = decomposition.nearest_rectangle(start).map_or(0, |(r, _)| r);
        let component = decomposition.component_of(home).unwrap_or(0);
        let reachable: Vec<usize> = decomposition.component(component).collect();
        let mut members = reachable.clone();
        members.retain(|&r| decomposition.is_own(r));
        let rectangles = members
            .iter()
            .filter_map(|&r| decomposition.rectangles().get(r));
        let bounds = rectangles
            .copied()
            .reduce(|a, b| Aabb {
                min: a.min.inf(&b.min),
                max: a.max.sup(&b.max),
            })
            .unwrap_or_else(|| workplace.inner());
        Self {
            decomposition: decomposition.clone(),
            inflated: workplace.inflated().to_vec(),
            reachable,
            members,
            bounds,
        }
    }

    /// The free space as rectangles; those of other components do not belong to this space.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// Indices of the reachable rectangles to cover in the decomposition.
    pub fn members(&self) -> &[usize] {
        &self.members
    }

    /// The reachable rectangles to cover (m).
    pub fn rectangles(&self) -> impl Iterator<Item = &Aabb> {
        self.with_indices(&self.members).map(|(_, r)| r)
    }

    fn with_indices<'a>(&'a self, list: &'a [usize]) -> impl Iterator<Item = (usize, &'a Aabb)> {
        let all = self.decomposition.rectangles();
        list.iter().filter_map(|&r| Some((r, all.get(r)?)))
    }

    /// The smallest rectangle around the space to cover (m).
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Returns `true` if a point (m) is free, reachable and to be covered.
    pub fn contains(&self, p: Point2<f64>) -> bool {
        self.rectangles().any(|r| r.contains(p))
    }

    /// Returns `true` if a point (m) is free and reachable.
    pub fn reaches(&self, p: Point2<f64>) -> bool {
        self.with_indices(&self.reachable)
            .any(|(_, r)| r.contains(p))
    }

    /// The reachable point nearest to `p` (m); `p` itself if it is reachable.
    pub fn nearest(&self, p: Point2<f64>) -> Point2<f64> {
        let reachable = self.with_indices(&self.reachable).map(|(_, r)| r);
        nearest(reachable, p)
    }

    /// The point to cover nearest to `p` (m).
    pub fn nearest_to_cover(&self, p: Point2<f64>) -> Point2<f64> {
        nearest(self.rectangles(), p)
    }

    /// The end of the free part of the straight leg from a free point to another (m): `to` without
    /// an obstacle, else a point a micrometre before the first obstacle or border.
    pub fn clear_to(&self, from: Point2<f64>, to: Point2<f64>) -> Point2<f64> {
        let to = clamp(&self.bounds, to);
        let length = (to - from).norm();
        let first = self
            .inflated
            .iter()
            .filter_map(|o| entry(o, from, to))
            .fold(1.0, f64::min);
        if first >= 1.0 || length <= 0.0 {
            return to;
        }
        let part = (first - STAND_OFF / length).max(0.0);
        from + (to - from) * part
    }

    /// The end of the free part of a ray from a free point along a direction (m), not necessarily
    /// of length 1; the point itself for a direction of length 0.
    pub fn ray_end(&self, from: Point2<f64>, direction: Vector2<f64>) -> Point2<f64> {
        let reach = (0..2).map(|axis| match direction[axis] {
            d if d > 0.0 => (self.bounds.max[axis] - from[axis]) / d,
            d if d < 0.0 => (self.bounds.min[axis] - from[axis]) / d,
            _ => f64::INFINITY,
        });
        let reach = reach.fold(f64::INFINITY, f64::min);
        if reach.is_finite() && reach > 0.0 {
            self.clear_to(from, from + direction * reach)
        } else {
            from
        }
    }

    /// Returns `true` if the straight leg between two points (m) touches no obstacle.
    pub fn is_clear(&self, from: Point2<f64>, to: Point2<f64>) -> bool {
        !self.inflated.iter().any(|o| entry(o, from, to).is_some())
    }

    /// The reachable rectangle that contains a point (m); for a point outside, the nearest one.
    pub fn member_at(&self, p: Point2<f64>) -> usize {
        let reachable = self.with_indices(&self.reachable);
        reachable
            .map(|(index, r)| (index, r.distance(p)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(r, _)| r)
    }

    /// Legs from a point in rectangle `from` to `goal` (m) in rectangle `to`, each within one free
    /// rectangle: per border one point before and one behind it, at random in the overlap of
    /// rectangles and bridge. `unit` returns uniform numbers in [0, 1).
    pub fn legs(
        &self,
        from: usize,
        to: usize,
        goal: Point2<f64>,
        mut unit: impl FnMut() -> f64,
    ) -> Vec<(Point2<f64>, Aabb)> {
        let path = self.decomposition.path(from, to);
        let all = self.decomposition.rectangles();
        let mut legs = Vec::with_capacity(2 * path.len());
        for pair in path.windows(2) {
            let &[a, b] = pair else { continue };
            let (Some(before), Some(behind), Some(bridge)) =
                (all.get(a), all.get(b), self.decomposition.bridge(a, b))
            else {
                continue;
            };
            let across = bridge.rectangle;
            let mut inside = |r: &Aabb| point_in(&overlap(r, &across), [unit(), unit()]);
            legs.push((inside(before), *before));
            legs.push((inside(behind), across));
        }
        if let Some(last) = path.last().and_then(|&r| all.get(r)) {
            legs.push((clamp(last, goal), *last));
        }
        legs
    }
}

fn nearest<'a>(rectangles: impl Iterator<Item = &'a Aabb>, p: Point2<f64>) -> Point2<f64> {
    let clamped = rectangles.map(|r| clamp(r, p));
    clamped
        .min_by(|a, b| (a - p).norm_squared().total_cmp(&(b - p).norm_squared()))
        .unwrap_or(p)
}

/// The point of a rectangle nearest to a point.
pub(crate) fn clamp(r: &Aabb, p: Point2<f64>) -> Point2<f64> {
    p.sup(&r.min).inf(&r.max)
}

/// A point of a rectangle by its coordinates in the unit square.
pub(crate) fn point_in(r: &Aabb, unit: [f64; 2]) -> Point2<f64> {
    let size = r.max - r.min;
    let p = Point2::new(r.min.x + size.x * unit[0], r.min.y + size.y * unit[1]);
    clamp(r, p)
}

fn overlap(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: a.min.sup(&b.min),
        max: a.max.inf(&b.max),
    }
}

/// The fraction of the segment, from 0 to 1, at which it enters the inside of an obstacle.
fn entry(o: &Aabb, from: Point2<f64>, to: Point2<f64>) -> Option<f64> {
    let line = to - from;
    let (mut enter, mut exit) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (low, high) = (o.min[axis] + TOUCH, o.max[axis] - TOUCH);
        let (start, rise) = (from[axis], line[axis]);
        if rise == 0.0 {
            if start <= low || start >= high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - start) / rise, (high - start) / rise);
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (enter < exit).then_some(enter)
}
