//! Room for a zig-zag: places of waypoints that a robot reaches straight from the contour.

use geometry::map::{ShapeMap, TOUCHING};
use geometry::shape::Aabb;
use nalgebra::Point2;

use crate::awg::{Awg, Leg};

/// Share of a leg's zig-zag that may be out of reach: one waypoint in ten.
const OUT_OF_REACH: f64 = 0.1;

/// Halvings of the width: it is exact to a millionth.
const HALVINGS: u32 = 20;

/// Points per side of the square of a waypoint that is tested for obstacles.
const LATTICE: u32 = 6;

/// Places where a robot fits, as far as it knows: within the map, outside the obstacles.
#[derive(Debug, Clone, Copy)]
pub struct Room<'m> {
    bounds: Aabb,
    obstacles: Option<&'m ShapeMap>,
    radius: f64,
}

impl<'m> Room<'m> {
    /// The room of a robot of this radius (m) in a map with these bounds; `obstacles` are those that
    /// it knows.
    pub fn new(bounds: Aabb, obstacles: Option<&'m ShapeMap>, radius: f64) -> Self {
        Self {
            bounds,
            obstacles,
            radius,
        }
    }

    /// Returns `true` if the robot fits into the bounds at a point (m).
    pub fn is_inside(&self, p: Point2<f64>) -> bool {
        let (low, high) = (p - self.bounds.min, self.bounds.max - p);
        low.x.min(low.y).min(high.x).min(high.y) >= self.radius - TOUCHING
    }

    /// Returns `true` if the robot fits at a point (m).
    pub fn fits(&self, p: Point2<f64>) -> bool {
        let radius = self.radius - TOUCHING;
        self.is_inside(p) && self.obstacles.is_none_or(|map| map.is_clear(p, radius))
    }

    /// Returns `true` if the robot can drive straight from one point to another (m).
    fn connects(&self, from: Point2<f64>, to: Point2<f64>) -> bool {
        self.fits(to)
            && self
                .obstacles
                .is_none_or(|map| map.segment_is_clear(from, to, self.radius))
    }

    /// The largest width (m) of at most `most` at which every place of an additional waypoint lies
    /// within the map, and at most one in ten on each leg is out of reach behind known obstacles.
    ///
    /// Never below `least`. Obstacles never narrow it below the robot's diameter: a leg that is
    /// tighter does not count, since it would take the zig-zag from all others. Neither do parts of
    /// the contour where the robot itself does not fit.
    pub fn widest(&self, awg: &Awg, least: f64, most: f64) -> f64 {
        let least = least.min(most);
        let legs = || awg.legs(0).iter().chain(awg.legs(1));
        let mut width = legs()
            .map(|leg| self.width_inside(awg, leg))
            .fold(most, f64::min)
            .max(least);
        let diameter = 2.0 * self.radius;
        for leg in legs() {
            let fits = |width| self.share_out_of_reach(awg, leg, width) <= OUT_OF_REACH;
            if width <= diameter || fits(width) || !fits(diameter) {
                continue;
            }
            let mut low = diameter;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + width);
                if fits(middle) {
                    low = middle;
                } else {
                    width = middle;
                }
            }
            width = low;
        }
        width
    }

    /// The largest width (m) at which the squares of a leg's waypoints lie within the map.
    fn width_inside(&self, awg: &Awg, leg: &Leg) -> f64 {
        let mut width = f64::INFINITY;
        for j in 1..=leg.inserted {
            let nominal = leg.nominal(j, awg.v());
            let left = |room: f64| (room - self.radius).max(0.0);
            let low = (nominal - self.bounds.min).map(left);
            let high = (self.bounds.max - nominal).map(left);
            for corner in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
                let offset = leg.offset(corner);
                for axis in 0..2 {
                    let room = if offset[axis] > 0.0 { high } else { low };
                    if offset[axis] != 0.0 {
                        width = width.min(room[axis] / offset[axis].abs());
                    }
                }
            }
        }
        width
    }

    /// Share of the places of a leg's waypoints that the robot does not reach straight from the
    /// contour, 0 to 1.
    fn share_out_of_reach(&self, awg: &Awg, leg: &Leg, width: f64) -> f64 {
        if self.obstacles.is_none() {
            return 0.0;
        }
        let (mut out_of_reach, mut all) = (0_u32, 0_u32);
        for j in 1..=leg.inserted {
            let nominal = leg.nominal(j, awg.v());
            if self.fits(nominal) {
                for place in square(leg, nominal, width) {
                    all += 1;
                    out_of_reach += u32::from(!self.connects(nominal, place));
                }
            }
        }
        f64::from(out_of_reach) / f64::from(all.max(1))
    }
}

/// Places of a waypoint for the points of a lattice in the unit square.
pub(crate) fn square(
    leg: &Leg,
    nominal: Point2<f64>,
    width: f64,
) -> impl Iterator<Item = Point2<f64>> {
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(LATTICE);
    (0..LATTICE * LATTICE)
        .map(move |i| nominal + leg.offset([middle(i % LATTICE), middle(i / LATTICE)]) * width)
}

#[cfg(test)]
mod tests;
