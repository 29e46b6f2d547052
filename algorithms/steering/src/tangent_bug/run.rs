//! A connected piece of boundary in sight, and its ends.

use nalgebra::Vector2;

use super::surroundings::{DIRECTIONS, Surroundings};

/// Which way a boundary is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The obstacle lies to the right of the robot; it goes around it counter-clockwise.
    Right,
    /// The obstacle lies to the left of the robot; it goes around it clockwise.
    Left,
}

/// Directions beside an end of a boundary in which it is the wall that is passed there: a third of a turn.
const BESIDE: usize = DIRECTIONS / 3;

/// Neighbouring directions that end at one piece of boundary: no gap and no jump between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// First direction, going counter-clockwise.
    first: usize,
    /// Number of directions.
    count: usize,
}

/// One of the discontinuities Oᵢ of the scan: where a piece of boundary ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RunEnd {
    /// Direction just beside the boundary.
    pub(super) unit: Vector2<f64>,
    /// How far it is free (m).
    pub(super) free: f64,
    /// How far away the boundary ends (m).
    pub(super) edge: f64,
}

impl Run {
    /// The piece of boundary seen in a direction; a change of the free distance from one direction
    /// to the next by more than `jump` (m) ends it. `None` where nothing is in reach.
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

    /// Whether it is all around the robot.
    pub(super) fn closed(&self) -> bool {
        self.count >= DIRECTIONS
    }

    /// Its directions, counter-clockwise.
    pub(super) fn directions(&self) -> impl Iterator<Item = usize> + use<> {
        let first = self.first;
        (0..self.count).map(move |i| (first + i) % DIRECTIONS)
    }

    /// Whether a direction belongs to it.
    pub(super) fn contains(&self, k: usize) -> bool {
        (k % DIRECTIONS + DIRECTIONS - self.first) % DIRECTIONS < self.count
    }

    /// The end at which the boundary is passed on a side; `None` if the run is closed.
    pub(super) fn end(&self, view: &Surroundings, side: Side) -> Option<RunEnd> {
        if self.closed() {
            return None;
        }
        let last = self.first + self.count - 1;
        let (inside, outside) = match side {
            Side::Right => (last, last + 1),
            Side::Left => (self.first, self.first + DIRECTIONS - 1),
        };
        // Of both sides of the jump the one that leads farther: beside the boundary, or between it
        // and what hides its continuation.
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

    /// The same, of a run that is all around, with its ends where it is farthest away.
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

    /// The direction in which it is nearest.
    pub(super) fn nearest(&self, view: &Surroundings) -> usize {
        Self::nearest_of(self.directions(), view).unwrap_or(self.first)
    }

    /// The direction in which it is nearest beside the end on a side: where it reaches farther around the robot,
    /// as in the tip of a wedge, that part of it is another wall.
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
        // The first of those that are equally near.
        directions.reduce(|best, k| {
            if view.free(k) < view.free(best) {
                k
            } else {
                best
            }
        })
    }
}
