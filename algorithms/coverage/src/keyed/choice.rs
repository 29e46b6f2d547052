//! The choice of the next sub-goal among random candidates.

use nalgebra::Point2;

use super::KeyedParams;
use crate::draws::{Draws, part};
use crate::freshness::Freshness;
use crate::space::Space;

/// Minimum length of legs (m).
const MIN_LEG: f64 = 0.01;

/// Number of candidates per depth of look-ahead that are expanded further.
const WIDTHS: [usize; 3] = [10, 4, 2];

/// Number of strips into which the workplace is cut along each axis. An order names an axis and a
/// strip.
const STRIPS: usize = 4;

/// Required new domain per metre of path, as a share of the maximum swept area; more makes shorter
/// legs.
const REQUIRED_GAIN: f64 = 0.65;

/// Maximum distance of a sub-goal from the axis through the previous one, as a share of the
/// workplace's side.
const SIDEWAYS: f64 = 0.1;

/// Probability that a candidate in a strip along a border lies close to that border.
const NEAR_BORDER: f64 = 0.2;

/// Probability that a candidate lies exactly on the axis through the previous point.
const ON_AXIS: f64 = 0.3;

/// Rough target of the next sub-goal by the key: along one axis, in another strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// 0 for x, 1 for y.
    axis: usize,
    /// Strip among those other than the robot's own, as a number in [0, 1).
    strip: f64,
}

/// Draws the orders of one sub-goal; the parameter `choices` sets their number.
pub fn draw_orders(params: &KeyedParams, draws: &mut Draws) -> Vec<Order> {
    let whole = params.choices.floor();
    let count = whole as usize + usize::from(draws.chance(params.choices - whole));
    let order = |_| Order {
        axis: draws.index(2),
        strip: draws.unit(),
    };
    (0..count).map(order).collect()
}

/// A possible leg.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    to: Point2<f64>,
    score: f64,
}

/// Inputs of a choice.
pub struct Choice<'a> {
    pub(super) params: &'a KeyedParams,
    pub(super) space: &'a Space,
    pub(super) freshness: &'a Freshness,
    /// The disc's radius (m).
    pub(super) radius: f64,
}

impl Choice<'_> {
    /// The sub-goal after `from` (m) that serves the orders of this and the next sub-goals best;
    /// `None` if no order gives a leg from there.
    pub(super) fn best(
        &self,
        from: Point2<f64>,
        orders: &[Vec<Order>],
        draws: &mut Draws,
    ) -> Option<Point2<f64>> {
        self.search(from, orders, 0, draws).map(|c| c.to)
    }

    /// The best first leg along all orders, with the score of all legs.
    fn search(
        &self,
        from: Point2<f64>,
        orders: &[Vec<Order>],
        depth: usize,
        draws: &mut Draws,
    ) -> Option<Candidate> {
        let (now, later) = orders.split_first()?;
        // Half as many for every leg farther ahead: only the next one will be driven.
        let per_order = (self.params.candidates >> depth).max(1);
        let mut candidates = Vec::with_capacity(now.len() * per_order);
        for order in now {
            for _ in 0..per_order {
                let to = self.space.clear_to(from, self.draw(from, *order, draws));
                let length = (to - from).norm();
                if length >= MIN_LEG {
                    let score = self.freshness.worth_of(from, to) - self.cost() * length;
                    candidates.push(Candidate { to, score });
                }
            }
        }
        if later.is_empty() {
            let best = |a: &Candidate, b: &Candidate| a.score.total_cmp(&b.score);
            return candidates.into_iter().max_by(best);
        }
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        let width = WIDTHS.get(depth).copied().unwrap_or(1);
        let followed = candidates.iter().take(width).map(|first| {
            let then = self.search(first.to, later, depth + 1, draws);
            let rest = then.map_or(0.0, |next| next.score);
            let score = first.score + rest;
            Candidate { score, ..*first }
        });
        followed.max_by(|a, b| a.score.total_cmp(&b.score))
    }

    /// Required gain per metre of path (m²/m): it falls with the root of the remaining area, as the
    /// best leg's share of new domain does.
    fn cost(&self) -> f64 {
        2.0 * self.radius * REQUIRED_GAIN * self.freshness.mean_worth().sqrt()
    }

    /// A random point that follows an order, regardless of obstacles.
    fn draw(&self, from: Point2<f64>, order: Order, draws: &mut Draws) -> Point2<f64> {
        let bounds = self.space.bounds();
        let size = bounds.max - bounds.min;
        let (axis, other) = (order.axis, 1 - order.axis);
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        let share = ((from[axis] - low) / size[axis]).clamp(0.0, 1.0);
        let own = part(share, STRIPS);
        let mut strip = part(order.strip, STRIPS - 1);
        strip += usize::from(strip >= own);
        let mut to = from;
        to[axis] = low + size[axis] * (strip as f64 + draws.unit()) / STRIPS as f64;
        if draws.chance(NEAR_BORDER) {
            let depth = draws.unit();
            let inward = (2.0 * self.radius * depth * depth).min(size[axis]);
            if strip == 0 {
                to[axis] = low + inward;
            } else if strip + 1 == STRIPS {
                to[axis] = high - inward;
            }
        }
        if !draws.chance(ON_AXIS) {
            to[other] += size[other] * SIDEWAYS * (2.0 * draws.unit() - 1.0);
        }
        to
    }
}
