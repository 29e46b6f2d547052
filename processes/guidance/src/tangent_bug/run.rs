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
    /// How far it is free [m].
    pub(super) free: f64,
    /// How far away the boundary ends [m].
    pub(super) edge: f64,
}

impl Run {
    /// The piece of boundary seen in a direction; a change of the free distance from one direction
    /// to the next by more than `jump` [m] ends it. `None` where nothing is in reach.
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

    /// The direction in which it is nearest.
    pub(super) fn nearest(&self, view: &Surroundings) -> usize {
        let mut best = self.first;
        for k in self.directions() {
            if view.free(k) < view.free(best) {
                best = k;
            }
        }
        best
    }
}
