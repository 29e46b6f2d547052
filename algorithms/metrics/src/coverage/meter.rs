//! All coverage rates of one path, updated while it grows.

use nalgebra::Point2;

use super::{CellGrid, CoverageDomain, CoverageError, SweptCells, Visits};

/// Sides of the cells for goals and path (m).
pub const CELL_SIDES: [f64; 3] = [0.1, 0.25, 0.5];

/// Side of the cells for the disc (m).
pub const DISC_CELL_SIDE: f64 = 0.1;

/// Subtracted from a number of steps before rounding up, so that integers stay unchanged.
const WHOLE_STEPS: f64 = 1e-12;

/// Ratio of covered to coverable cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    /// Number of covered coverable cells.
    pub covered: usize,
    /// Number of coverable cells, ≥ 1.
    pub coverable: usize,
}

impl Rate {
    /// Covered share, from 0 to 1.
    pub fn share(self) -> f64 {
        self.covered as f64 / self.coverable as f64
    }
}

/// Figures of a [`Meter`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Length of the path (m).
    pub length: f64,
    /// Cells with a sub-goal, for each of [`CELL_SIDES`].
    pub goals: [Rate; 3],
    /// Cells with a point of the path, for each of [`CELL_SIDES`].
    pub path: [Rate; 3],
    /// Cells of [`DISC_CELL_SIDE`] whose centres came within the robot's radius of the path.
    pub disc: Rate,
    /// Coefficient of variation (standard deviation over mean) of the points of the path per cell,
    /// for each of [`CELL_SIDES`]; infinite before the first point.
    pub variation: [f64; 3],
}

/// Measures the coverage of a path that grows leg by leg.
///
/// A leg counts by points at equal distances along it: `⌈d/step − 10⁻¹²⌉` parts (at least one); its
/// start is the end of the previous leg. The disc is swept along the leg itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Meter {
    step: f64,
    goals: [Visits; 3],
    path: [Visits; 3],
    disc: SweptCells,
    last: Option<Point2<f64>>,
    length: f64,
}

impl Meter {
    /// Creates a meter without a path; points of the path are at most `step` (m) apart (0.125 m in
    /// the Chebyshev coverage paper, §4).
    ///
    /// # Errors
    /// [`CoverageError`] if the step is not positive or, for some cell size, no cell is coverable.
    pub fn new(domain: &CoverageDomain, step: f64) -> Result<Self, CoverageError> {
        let usable = step > 0.0 && step.is_finite();
        if !usable {
            return Err(CoverageError::Step { step });
        }
        let [a, b, c] = CELL_SIDES.map(|side| CellGrid::new(domain, side).map(Visits::new));
        let visits = [a?, b?, c?];
        Ok(Self {
            step,
            goals: visits.clone(),
            path: visits,
            disc: SweptCells::new(CellGrid::new(domain, DISC_CELL_SIDE)?, domain.radius()),
            last: None,
            length: 0.0,
        })
    }

    /// Drives straight to a sub-goal (m); the first call sets the start of the path, which counts
    /// as a sub-goal too.
    pub fn goal(&mut self, p: Point2<f64>) {
        self.drive(p);
        self.mark_goal(p);
    }

    /// Counts a sub-goal (m) to which the path does not lead straight.
    pub fn mark_goal(&mut self, p: Point2<f64>) {
        for visits in &mut self.goals {
            visits.add(p);
        }
    }

    /// Drives straight to a point (m) that is not a sub-goal; the first call sets the start of the
    /// path. Points that are not finite are left out.
    pub fn drive(&mut self, p: Point2<f64>) {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return;
        }
        let Some(from) = self.last else {
            self.disc.sweep(p, p);
            self.pass(p);
            self.last = Some(p);
            return;
        };
        let line = p - from;
        let length = line.norm();
        let parts = (length / self.step - WHOLE_STEPS).ceil().max(1.0);
        let mut part = 1.0;
        while part < parts {
            self.pass(from + line * (part / parts));
            part += 1.0;
        }
        self.pass(p);
        self.disc.sweep(from, p);
        self.length += length;
        self.last = Some(p);
    }

    /// Drives towards a sub-goal (m) until the path is `limit` (m) long; returns `true` if the path
    /// reached it before that, which counts the sub-goal.
    pub fn goal_within(&mut self, p: Point2<f64>, limit: f64) -> bool {
        let Some(from) = self.last else {
            self.goal(p);
            return true;
        };
        let (line, left) = (p - from, limit - self.length);
        let length = line.norm();
        if length <= left {
            self.goal(p);
            return true;
        }
        if left > 0.0 {
            self.drive(from + line * (left / length));
        }
        false
    }

    fn pass(&mut self, p: Point2<f64>) {
        for visits in &mut self.path {
            visits.add(p);
        }
    }

    /// Length of the path (m).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// End of the path (m), once it has begun.
    pub fn last(&self) -> Option<Point2<f64>> {
        self.last
    }

    /// The counts of sub-goals, for each of [`CELL_SIDES`].
    pub fn goals(&self) -> &[Visits; 3] {
        &self.goals
    }

    /// The counts of points of the path, for each of [`CELL_SIDES`].
    pub fn path(&self) -> &[Visits; 3] {
        &self.path
    }

    /// The area that the disc has swept.
    pub fn disc(&self) -> &SweptCells {
        &self.disc
    }

    /// All figures so far.
    pub fn figures(&self) -> Figures {
        let rates = |visits: &[Visits; 3]| {
            visits.each_ref().map(|v| Rate {
                covered: v.covered(),
                coverable: v.grid().coverable(),
            })
        };
        Figures {
            length: self.length,
            goals: rates(&self.goals),
            path: rates(&self.path),
            disc: Rate {
                covered: self.disc.covered(),
                coverable: self.disc.grid().coverable(),
            },
            variation: self.path.each_ref().map(Visits::variation),
        }
    }
}
