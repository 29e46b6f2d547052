//! A connected piece of visible boundary, and its ends.

use nalgebra::Vector2;

use super::surroundings::{DIRECTIONS, Surroundings};

/// Side on which a boundary is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The obstacle is to the right of the robot; the robot circles it counter-clockwise.
    Right,
    /// The obstacle is to the left of the robot; the robot circles it clockwise.
    Left,
}

/// Number of directions beside an end of a boundary that belong to the wall passed there: a third of a turn.
const BESIDE: usize = DIRECTIONS / 3;

/// Neighbouring directions that end at one piece of boundary: no gap and no jump between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// First direction, going counter-clockwise.
    first: usize,
    /// Number of directions.
    count: usize,
}

/// One of the discontinuities Oᵢ of the scan: the end of a piece of boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunEnd {
    /// Direction just beside the boundary.
    pub(super) unit: Vector2<f64>,
    /// Free distance in this direction (m).
    pub(super) free: f64,
    /// Distance of the boundary's end (m).
    pub(super) edge: f64,
}

impl Run {
    /// The piece of boundary in a direction; a change of the free distance from one direction to the next by
    /// more than `jump` (m) ends it. `None` without an obstacle in reach.
    pub(super) fn around(view: &Surroundings, k: usize, jump: f64) -> Option<Self> {
        if !view.is_blocked(k) {
            return None;
        }
        let joined =
            |a: usize, b: usize| view.is_blocked(b) && (view.free(a) - view.free(b)).abs() <= jump;
        let mut last = k;
        let mut count = 1;
        while count < DIRECTIONS && joined(last, last + 1) {
            last += 1;
            count += 1;
        }
        let mut first = k + DIRECTIONS;
        while count < DIRECTIONS && joined(first, first - 1) {
            first -= 1;
            count += 1;
        }
        Some(Self {
            first: first % DIRECTIONS,
            count,
        })
    }

    /// Returns `true` if the piece surrounds the robot.
    pub(super) fn closed(&self) -> bool {
        self.count >= DIRECTIONS
    }

    /// The directions of the piece, counter-clockwise.
    pub(super) fn directions(&self) -> impl Iterator<Item = usize> + use<> {
        let first = self.first;
        (0..self.count).map(move |i| (first + i) % DIRECTIONS)
    }

    /// Returns `true` if a direction belongs to the piece.
    pub(super) fn contains(&self, k: usize) -> bool {
        (k % DIRECTIONS + DIRECTIONS - self.first) % DIRECTIONS < self.count
    }

    /// The end at which the robot passes the boundary on a side; `None` if the run is closed.
    pub(super) fn end(&self, view: &Surroundings, side: Side) -> Option<RunEnd> {
        if self.closed() {
            return None;
        }
        let last = self.first + self.count - 1;
        let (inside, outside) = match side {
            Side::Right => (last, last + 1),
            Side::Left => (self.first, self.first + DIRECTIONS - 1),
        };
        // Of both sides of the jump the one that leads farther: beside the boundary, or between it and the
        // obstacle that hides its continuation.
        let (far, near) = if view.free(outside) >= view.free(inside) {
            (outside, inside)
        } else {
            (inside, outside)
        };
        Some(RunEnd {
            unit: Surroundings::unit(far),
            free: view.free(far),
            edge: view.free(near),
        })
    }

    /// Opens a closed run at its farthest point.
    pub(super) fn parted_where_farthest(self, view: &Surroundings) -> Self {
        let farther = |best, k| {
            if view.free(k) > view.free(best) {
                k
            } else {
                best
            }
        };
        let Some(farthest) = self.directions().filter(|_| self.closed()).reduce(farther) else {
            return self;
        };
        Self {
            first: (farthest + 1) % DIRECTIONS,
            count: DIRECTIONS - 1,
        }
    }

    /// The direction of the nearest point.
    pub(super) fn nearest(&self, view: &Surroundings) -> usize {
        Self::nearest_of(self.directions(), view).unwrap_or(self.first)
    }

    /// The direction of the nearest point beside the end on a side. Where the run reaches farther around the
    /// robot, as in the tip of a wedge, that part of it is another wall.
    pub(super) fn nearest_beside(&self, view: &Surroundings, side: Side) -> usize {
        let left_out = self.count.saturating_sub(BESIDE);
        let skipped = match side {
            Side::Right => left_out,
            Side::Left => 0,
        };
        let beside = self.directions().skip(skipped).take(BESIDE);
        Self::nearest_of(beside, view).unwrap_or(self.first)
    }

    fn nearest_of(directions: impl Iterator<Item = usize>, view: &Surroundings) -> Option<usize> {
        // The first of equally near ones.
        directions.reduce(|best, k| {
            if view.free(k) < view.free(best) {
                k
            } else {
                best
            }
        })
    }
}
