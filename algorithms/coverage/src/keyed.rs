//! Keyed coverage: fast, and hard to predict even for an observer that knows the method and its
//! whole state except the key.
//!
//! Goals that are independent and uniform cannot be predicted but cover badly. The leg that sweeps
//! the most new domain covers well but is predictable for an observer. Here the key orders roughly
//! where to go, regardless of the coverage, and the planner is free only within that order:
//!
//! 1. Every sub-goal gets one or two *orders* (the parameter `choices`) from the keyed stream: an
//!    axis, and one of the strips across it other than the robot's own. Legs near only two
//!    directions overlap least: k directions that each sweep a share a leave (1 − a)ᵏ.
//! 2. Of random points that follow an order, the planner takes the one whose leg sweeps the most new
//!    domain less the cost of its length, where slivers count more ([`Freshness`]).
//! 3. Orders are drawn ahead, so that legs are chosen along with the next ones. The planner, which
//!    has the key, gains from that; for an observer the future orders are as unknown as this one.
//! 4. A leg ends before obstacles that block it. When legs have covered nearly nothing several times
//!    in a row, the path through free rectangles to a random fresh cell follows, so that every
//!    reachable part of the free space is visited.
//!
//! All random numbers come from a `ChaCha20` stream of the key.

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
use crate::wander::{PositionRule, Wander};
use crate::workplace::Workplace;
use choice::{Choice, Order, draw_orders};

/// Distance (cells) along each axis within which cells are neighbours, for the worth of slivers.
const NEIGHBOURHOOD: usize = 2;

/// Additional worth of the last fresh cell of a neighbourhood, relative to one among fresh cells.
const RARITY: f64 = 1.5;

/// Number of legs beyond the next that are planned along with it, by orders that only the holder of
/// the key knows. More cover faster and are no easier to predict, but take time.
const LOOK_AHEAD: usize = 2;

/// Number of consecutive idle legs after which the robot heads for a fresh cell.
const MAX_IDLE_LEGS: u32 = 4;

/// Share of the fresh area below which the new part of a leg counts as idle: a random leg would do
/// better.
const IDLE: f64 = 0.5;

/// Reason why keyed coverage cannot start.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KeyedError {
    /// A parameter out of range.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The workplace cannot be divided into cells.
    #[error(transparent)]
    Coverage(#[from] CoverageError),
    /// Cells are too large for the disc to sweep them all.
    #[error(
        "`cell` is {cell}: expected at most the radius that the robot covers, {radius} m; take \
         smaller cells"
    )]
    Cell {
        /// Actual side (m).
        cell: f64,
        /// Radius of the disc (m).
        radius: f64,
    },
}

/// Plans endless sub-goals; see the module.
#[derive(Debug, Clone)]
pub struct KeyedCoverage {
    params: KeyedParams,
    wander: Wander,
    freshness: Freshness,
    /// `true` if [`GoalSource::driven`] reports the coverage, instead of the planned legs.
    tracked: bool,
    radius: f64,
    /// Orders of the next sub-goals.
    orders: VecDeque<Vec<Order>>,
    idle: u32,
}

impl KeyedCoverage {
    /// Creates a planner for the reachable part of a workplace from `start` (m), for a robot that
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

    /// The same planner with the same state of coverage, but with another key from here on: with it
    /// an observer that knows all but the key guesses the next sub-goal.
    #[must_use]
    pub fn with_key(&self, key: [u8; 32]) -> Self {
        let mut other = self.clone();
        other.wander = self.wander.with_key(key);
        other.orders.clear();
        other.fill_orders();
        other
    }

    /// The same planner in a changed workplace, from `start` (m): key, numbers and round continue,
    /// and covered cells stay covered where the grids are equal.
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

    /// The same planner, based on the real path of the robot ([`GoalSource::driven`]) instead of the
    /// planned legs: areas that a robot misses are covered later. The sub-goals then depend on key
    /// and robot, and an ally with the key alone cannot predict them.
    #[must_use]
    pub fn tracking(mut self) -> Self {
        self.tracked = true;
        self
    }

    /// Share of the reachable cells that this round has covered, from 0 to 1, if the leg to every
    /// returned sub-goal was driven.
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

    /// Counts a leg as driven, unless the robot reports its path; returns `true` if the leg is idle.
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

    /// The sub-goal by the orders; `None` if there is no such leg or the last ones covered nothing.
    fn by_orders(&mut self, from: Point2<f64>) -> Option<Goal> {
        if self.idle >= MAX_IDLE_LEGS {
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

    /// The first leg of the path to a random fresh cell.
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
            PositionRule::Nowhere => return None,
            PositionRule::Outside(goal) => return Some(goal),
            PositionRule::OnTheWay(goal) => {
                self.sweep(from, goal.waypoint.point);
                return Some(goal);
            }
            PositionRule::Free => {}
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
