//! Keyed coverage: fast to cover, hard to predict even for who knows the method and all of its
//! state but the key.
//!
//! Goals that are independent and uniform cannot be predicted but cover badly; the leg that sweeps
//! the most new domain covers well but is known to who has watched. Here the key orders roughly
//! where to go, whatever has been covered, and the planner is free only within that order:
//!
//! 1. Every sub-goal gets one or two *orders* (the parameter `choices`) from the keyed stream: an
//!    axis, and one of the strips across it other than the robot's own. Legs near two directions
//!    only overlap least: k directions that each sweep a share a leave (1 − a)ᵏ.
//! 2. Of random points that follow an order, that one is taken whose leg sweeps the most new domain
//!    less the cost of its length, where slivers count more ([`Freshness`]).
//! 3. Orders are drawn ahead, so that legs are chosen along with the next ones. The holder of the
//!    key gains from that; for an observer the orders to come are as unknown as this one.
//! 4. Where obstacles stop a leg it ends before them. When legs have brought next to nothing
//!    several times in a row, the way through free rectangles to a random fresh cell follows, so
//!    that every part of the free space that can be reached is.
//!
//! Every number comes from a `ChaCha20` stream of the key.

mod choice;
mod params;
#[cfg(test)]
mod tests;

pub use params::KeyedParams;

use std::collections::VecDeque;

use metrics::coverage::{CellGrid, CoverageError};
use nalgebra::Point2;
use parameters::{ParamsError, check};
use thiserror::Error;

use crate::decomposition::Decomposition;
use crate::freshness::Freshness;
use crate::goal::{Goal, GoalSource};
use crate::space::Space;
use crate::wander::{Standing, Wander};
use crate::workplace::Workplace;
use choice::{Choice, Order, draw_orders};

/// How many cells away along each axis cells are neighbours, for the worth of slivers.
const NEIGHBOURHOOD: usize = 2;

/// How much more the last fresh cell of a neighbourhood is worth than one among fresh ones.
const RARITY: f64 = 1.5;

/// Legs beyond the next that are planned along with it, by orders that only the holder of the key
/// knows. More cover faster and are no easier to predict, but take time.
const LOOK_AHEAD: usize = 2;

/// Idle legs in a row after which a fresh cell is headed for.
const PATIENCE: u32 = 4;

/// A leg is idle if what it sweeps is new by less than this share of what is left in all: a random
/// leg would do better.
const IDLE: f64 = 0.5;

/// Why keyed coverage cannot start.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KeyedError {
    /// A parameter out of range.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The workplace cannot be divided into cells.
    #[error(transparent)]
    Coverage(#[from] CoverageError),
    /// Cells too large for the disc to sweep them all.
    #[error(
        "`cell` is {cell}, but must be at most the radius that the robot covers, {radius} m: take \
         smaller cells"
    )]
    Cell {
        /// Side found (m).
        cell: f64,
        /// Radius of the disc (m).
        radius: f64,
    },
}

/// Plans sub-goals without end; see the module.
#[derive(Debug, Clone)]
pub struct KeyedCoverage {
    params: KeyedParams,
    wander: Wander,
    freshness: Freshness,
    /// `true` if what is covered is told by [`GoalSource::driven`], instead of taken from the legs.
    tracked: bool,
    radius: f64,
    /// Orders of the next sub-goals.
    orders: VecDeque<Vec<Order>>,
    idle: u32,
}

impl KeyedCoverage {
    /// A planner for the part of a workplace that can be reached from `start` (m), for a robot that
    /// covers a disc of radius `disc` (m), with the key of its stream.
    ///
    /// # Errors
    /// [`KeyedError`] if a parameter is out of range or the cells do not suit the workplace or the
    /// robot.
    pub fn new(
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
        disc: f64,
        key: [u8; 32],
        params: KeyedParams,
    ) -> Result<Self, KeyedError> {
        check(&params)?;
        let (radius, cell) = (disc, params.cell);
        let fine = cell <= radius && radius.is_finite();
        if !fine {
            return Err(KeyedError::Cell { cell, radius });
        }
        let space = Space::new(workplace, decomposition, start);
        let grid = CellGrid::new(&workplace.domain()?, cell)?;
        let freshness = Freshness::new(&grid, &space, radius, RARITY, NEIGHBOURHOOD);
        let mut planner = Self {
            params,
            wander: Wander::new(space, key),
            freshness,
            tracked: false,
            radius,
            orders: VecDeque::new(),
            idle: 0,
        };
        planner.fill_orders();
        Ok(planner)
    }

    /// The same planner with the same state of coverage, but with a key of its own from here on:
    /// what an observer who knows all but the key can ask for guesses of the next sub-goal.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.wander = self.wander.with_key(key);
        other.orders.clear();
        other.fill_orders();
        other
    }

    /// The same planner in a workplace that has changed, from `start` (m): key, numbers and round go
    /// on, and what has been covered stays so where the cells are the same.
    ///
    /// # Errors
    /// [`KeyedError`] if the cells do not suit the workplace or the robot.
    pub fn moved(
        self,
        workplace: &Workplace,
        decomposition: &Decomposition,
        start: Point2<f64>,
    ) -> Result<Self, KeyedError> {
        let unused = [0; 32];
        let params = self.params.clone();
        let mut other = Self::new(workplace, decomposition, start, self.radius, unused, params)?;
        other.freshness.keep_covered(&self.freshness);
        other.tracked = self.tracked;
        other.orders = self.orders;
        other.wander = self.wander.moved(other.wander.space);
        Ok(other)
    }

    /// The same planner, going by where the robot really was ([`GoalSource::driven`]) instead of the
    /// legs that it was sent along: what a robot on wheels misses is seen to. The sub-goals then
    /// follow from key and robot, and an ally with the key alone cannot predict them.
    #[must_use]
    pub fn tracking(mut self) -> Self {
        self.tracked = true;
        self
    }

    /// Share of the reachable cells that this round has covered, from 0 to 1, if every leg to a
    /// sub-goal given out was driven.
    pub fn covered(&self) -> f64 {
        1.0 - self.freshness.share()
    }

    /// The round, from 0: a new one begins when [`KeyedParams::round_at`] is covered.
    pub fn round(&self) -> u32 {
        self.wander.counter.round()
    }

    fn fill_orders(&mut self) {
        while self.orders.len() <= LOOK_AHEAD {
            let orders = draw_orders(&self.params, &mut self.wander.draws);
            self.orders.push_back(orders);
        }
    }

    /// Counts a leg as driven, unless the robot tells itself; whether it is idle.
    fn sweep(&mut self, from: Point2<f64>, to: Point2<f64>) -> bool {
        let left = self.freshness.share();
        let cells = if self.tracked {
            self.freshness.fresh_on(from, to)
        } else {
            self.freshness.sweep(from, to)
        };
        let swept = cells as f64 * self.params.cell * self.params.cell;
        swept < IDLE * left * 2.0 * self.radius * (to - from).norm()
    }

    /// The sub-goal that the orders ask for; `None` if they lead nowhere or the last ones brought
    /// nothing.
    fn by_orders(&mut self, from: Point2<f64>) -> Option<Goal> {
        if self.idle >= PATIENCE {
            return None;
        }
        let choice = Choice {
            params: &self.params,
            space: &self.wander.space,
            freshness: &self.freshness,
            radius: self.radius,
        };
        let orders = self.orders.make_contiguous();
        let best = choice.best(from, orders, &mut self.wander.draws);
        self.orders.pop_front();
        self.fill_orders();
        let to = best.filter(|&to| self.wander.space.contains(to))?;
        let idle = self.sweep(from, to);
        self.idle = if idle { self.idle + 1 } else { 0 };
        Some(self.wander.sub_goal(to, None))
    }

    /// The first leg of the way to a random fresh cell.
    fn by_fresh_cell(&mut self, from: Point2<f64>) -> Option<Goal> {
        self.idle = 0;
        let index = self.wander.draws.index(self.freshness.left());
        let cell = self.freshness.nth(index)?;
        let last = self.wander.space.member_at(cell);
        let goal = self.wander.set_out(from, last, cell)?;
        self.sweep(from, goal.waypoint.point);
        Some(goal)
    }
}

impl GoalSource for KeyedCoverage {
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal> {
        match self.wander.standing(from) {
            Standing::Nowhere => return None,
            Standing::Outside(goal) => return Some(goal),
            Standing::OnTheWay(goal) => {
                self.sweep(from, goal.waypoint.point);
                return Some(goal);
            }
            Standing::Free => {}
        }
        if 1.0 - self.freshness.share() >= self.params.round_at {
            self.freshness.renew();
            self.wander.counter.begin_round();
        }
        self.by_orders(from).or_else(|| self.by_fresh_cell(from))
    }

    fn driven(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let finite = |p: Point2<f64>| p.x.is_finite() && p.y.is_finite();
        if self.tracked && finite(from) && finite(to) {
            self.freshness.sweep(from, to);
        }
    }
}
