//! Work of a plan, counted instead of timed: the same on every machine.

use core::cell::Cell;

/// Count of the work of a plan, and its limit.
#[derive(Debug, Default)]
pub struct Effort {
    programs: Cell<u32>,
    work: Cell<u64>,
    limit: Option<u64>,
}

impl Effort {
    /// Begins a count that is spent at this work; never if `None`.
    pub fn new(limit: Option<u64>) -> Self {
        Self {
            limit,
            ..Self::default()
        }
    }

    /// Adds a convex program that took this number of solver steps, each over this number of
    /// coefficients.
    pub fn add(&self, steps: u32, coefficients: usize) {
        let work = u64::from(steps) * coefficients as u64;
        self.programs.set(self.programs.get() + 1);
        self.work.set(self.work.get().saturating_add(work));
    }

    /// Number of convex programs solved.
    pub fn programs(&self) -> u32 {
        self.programs.get()
    }

    /// Work so far: coefficients of convex programs, once per step of their solver.
    pub fn work(&self) -> u64 {
        self.work.get()
    }

    /// Returns `true` once the limit is reached.
    pub fn is_spent(&self) -> bool {
        self.limit.is_some_and(|limit| self.work.get() >= limit)
    }
}
