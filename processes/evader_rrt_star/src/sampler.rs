//! Uniform samples of the places where the robot fits.

use nalgebra::{Point2, Vector2};
use planner_view::free_space::FreeSpace;
use rand::Rng;

/// Cells along the longer side.
const CELLS: f64 = 192.0;

/// Maximum number of draws for one point.
const MAX_DRAWS: u32 = 1000;

/// A number uniform in [0, 1).
pub fn uniform(rng: &mut impl Rng) -> f64 {
    // 53 bits: every multiple of 2⁻⁵³ is a double.
    (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Cells of a grid in which a robot of some radius fits somewhere.
///
/// Most of them lie wholly in free space, so that most points need no check.
#[derive(Debug, Clone)]
pub struct FreeSampler {
    radius: f64,
    size: f64,
    /// Lower left corners of the cells that are free everywhere, followed by the others.
    corners: Vec<Point2<f64>>,
    whole: usize,
}

impl FreeSampler {
    /// Returns the cells for a robot of this radius (m).
    pub fn new(space: &FreeSpace, radius: f64) -> Self {
        let bounds = space.bounds();
        let extent = bounds.max - bounds.min;
        let size = extent.x.max(extent.y) / CELLS;
        let half_diagonal = size * core::f64::consts::FRAC_1_SQRT_2;
        let (mut whole, mut parts) = (Vec::new(), Vec::new());
        for row in 0..(extent.y / size).ceil() as u32 {
            for column in 0..(extent.x / size).ceil() as u32 {
                let corner = bounds.min + Vector2::new(f64::from(column), f64::from(row)) * size;
                let spare = space.distance(corner + Vector2::new(0.5, 0.5) * size) - radius;
                // A small tolerance for rounding.
                if spare > half_diagonal * (1.0 + 1e-9) {
                    whole.push(corner);
                } else if spare >= -half_diagonal {
                    parts.push(corner);
                }
            }
        }
        let count = whole.len();
        whole.extend(parts);
        Self {
            radius,
            size,
            corners: whole,
            whole: count,
        }
    }

    /// Returns the approximate area of the free space (m²).
    pub fn area(&self) -> f64 {
        let parts = self.corners.len() - self.whole;
        (self.whole as f64 + 0.5 * parts as f64) * self.size * self.size
    }

    /// Returns `true` if there is no place for the robot.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Returns a uniform point of the free space; `None` if many draws found none.
    pub fn draw(&self, space: &FreeSpace, rng: &mut impl Rng) -> Option<Point2<f64>> {
        if self.corners.is_empty() {
            return None;
        }
        for _ in 0..MAX_DRAWS {
            let cell = (uniform(rng) * self.corners.len() as f64) as usize;
            let corner = self.corners.get(cell)?;
            let p = corner + Vector2::new(uniform(rng), uniform(rng)) * self.size;
            if cell < self.whole || space.is_free(p, self.radius) {
                return Some(p);
            }
        }
        None
    }
}
