//! Random workplaces, and their properties computed without the crate under test.
//!
//! A square of 10 m with rectangles of 0.5 to 3 m, a robot of 0.1 m: on such maps the printed
//! decomposition of the Chebyshev coverage paper stalls.

pub mod drive;

use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use coverage::workplace::Workplace;

/// Side of the workplaces (m).
pub const SIDE: f64 = 10.0;

/// Radius of the robot (m).
pub const RADIUS: f64 = 0.1;

/// A sequence of random workplaces; the same for the same seed.
#[derive(Debug, Clone)]
pub struct RandomMaps(ChaCha8Rng);

impl RandomMaps {
    /// Creates the sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// The next workplace, with this many rectangles.
    pub fn next_map(&mut self, obstacles: usize) -> Workplace {
        let parts: Vec<Convex> = (0..obstacles)
            .map(|_| Convex::Box(self.rectangle()))
            .collect();
        let bounds = Aabb {
            min: Point2::origin(),
            max: Point2::new(SIDE, SIDE),
        };
        Workplace::from_parts(bounds, RADIUS, &parts, 0.1).expect("sound by construction")
    }

    fn rectangle(&mut self) -> Aabb {
        let mut within = |low: f64, high: f64| low + (high - low) * self.unit();
        let (width, height) = (within(0.5, 3.0), within(0.5, 3.0));
        let min = Point2::new(within(0.0, SIDE - width), within(0.0, SIDE - height));
        Aabb {
            min,
            max: Point2::new(min.x + width, min.y + height),
        }
    }
}

/// Free area (m²) and number of components of the free space, counted over the cells between all
/// borders.
pub fn free_components(workplace: &Workplace) -> (f64, usize) {
    let inner = workplace.inner();
    let lines = |axis: usize| {
        let sides = workplace.inflated().iter();
        let mut all: Vec<f64> = sides.flat_map(|o| [o.min[axis], o.max[axis]]).collect();
        all.extend([inner.min[axis], inner.max[axis]]);
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a - *b <= 1e-9);
        all
    };
    let (xs, ys) = (lines(0), lines(1));
    let (columns, rows) = (xs.len() - 1, ys.len() - 1);
    let mut open = vec![false; columns * rows];
    let mut area = 0.0;
    for row in 0..rows {
        for column in 0..columns {
            let center = Point2::new(
                0.5 * (xs[column] + xs[column + 1]),
                0.5 * (ys[row] + ys[row + 1]),
            );
            if !workplace.inflated().iter().any(|o| o.contains(center)) {
                open[row * columns + column] = true;
                area += (xs[column + 1] - xs[column]) * (ys[row + 1] - ys[row]);
            }
        }
    }
    let mut components = 0;
    for first in 0..open.len() {
        if !open[first] {
            continue;
        }
        components += 1;
        let mut stack = vec![first];
        while let Some(cell) = stack.pop() {
            if !core::mem::take(&mut open[cell]) {
                continue;
            }
            let (column, row) = (cell % columns, cell / columns);
            stack.extend((column > 0).then(|| cell - 1));
            stack.extend((column + 1 < columns).then_some(cell + 1));
            stack.extend((row > 0).then(|| cell - columns));
            stack.extend((row + 1 < rows).then_some(cell + columns));
        }
    }
    (area, components)
}
