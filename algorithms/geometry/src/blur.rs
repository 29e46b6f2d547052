//! The blurred map: the openness of the surroundings of each point, 0…1.
//!
//! The free map (1 = free, 0 = occupied) is convolved with a Gaussian. Two users share the result:
//! the potential-field planners push a robot along its gradient ∇(G∗I) (chasing-game paper,
//! section III.B), and line of sight multiplies its values along a ray (section III.C, see
//! [`crate::visibility`]).
//!
//! Stored are the *unmasked* blur and the occupancy. [`BlurredMap::value`] is masked (0 in
//! obstacles, as the paper's "visibility at a point"); [`BlurredMap::gradient`] is that of the
//! unmasked blur. Masking before differentiating would put a jump of height ≈ 0.5 per cell at every
//! wall: a push that grows without bound with the resolution of the map. The unmasked gradient is
//! bounded by 1/(σ·√(2π)), about 2.1 per metre at σ = 0.19 m, and inside an obstacle it still points
//! outwards.

use nalgebra::{Point2, Vector2};
use thiserror::Error;

use crate::grid::{Grid, GridFrame};
use crate::math;

/// Standard deviation of the blur used by the chasing-game experiments (m): three cells of 0.0633 m.
pub const PAPER_SIGMA: f64 = 0.19;

/// Maximum length of a side of a map (cells); keeps the fixed-point arithmetic of line of sight
/// within 64 bits.
pub const MAX_SIDE: usize = 16_384;

/// Reason why a blurred map cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BlurError {
    /// The map has no cells, or a side that is too long.
    #[error("the map has {width} × {height} cells: expected sides of 1 to {MAX_SIDE}")]
    Size {
        /// Number of columns of the map.
        width: usize,
        /// Number of rows of the map.
        height: usize,
    },
    /// The cell size is not a positive finite length.
    #[error("the map's resolution is {resolution} m per cell: expected a finite number above 0")]
    Resolution {
        /// Actual resolution (m).
        resolution: f64,
    },
    /// The number of values does not match the frame.
    #[error("the {what} has {found} cells: expected {expected}, as its frame")]
    Length {
        /// Name of the grid.
        what: &'static str,
        /// Actual number of values.
        found: usize,
        /// Number of values that the frame requires.
        expected: usize,
    },
    /// The two layers have different frames.
    #[error("the blurred and the occupied layer lie on different grid frames")]
    FrameMismatch,
    /// The standard deviation of the blur is invalid.
    #[error(
        "the blur's sigma is {sigma} m: expected a number above 0 and of at most the map's longer side, {limit} m"
    )]
    Sigma {
        /// Actual standard deviation (m).
        sigma: f64,
        /// Maximum standard deviation (m).
        limit: f64,
    },
    /// A blurred value is outside 0…1.
    #[error("the blurred layer holds {value} in cell {cell}: expected 0 to 1")]
    Value {
        /// Actual value.
        value: f32,
        /// Storage index of its cell.
        cell: usize,
    },
}

/// Gaussian blur of a free map, with the occupancy that masks it.
///
/// ```
/// use geometry::blur::BlurredMap;
/// use geometry::grid::{Grid, GridFrame};
/// use nalgebra::Point2;
///
/// let frame = GridFrame { width: 20, height: 20, resolution: 0.1, origin: Point2::origin() };
/// let mut free = Grid::filled(frame, true);
/// for row in 0..20 {
///     free.cells[frame.index(0, row)] = false;
/// }
/// let map = BlurredMap::new(&free, 0.2)?;
/// let (by_the_wall, in_the_open) = (Point2::new(0.15, 1.0), Point2::new(1.5, 1.0));
/// assert!(map.value(by_the_wall) < map.value(in_the_open));
/// assert!(map.gradient(by_the_wall).x > 0.0);
/// # Ok::<(), geometry::blur::BlurError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BlurredMap {
    blurred: Grid<f32>,
    occupied: Grid<bool>,
}

impl BlurredMap {
    /// Blurs a free map (`true` = free) with a Gaussian of standard deviation `sigma` (m).
    ///
    /// The kernel is sampled at whole cells out to ±4σ (rounded to a cell) and normalised to sum 1.
    /// Beyond its edge the map continues as its mirror image (`d c b a | a b c d | d c b a`), so the
    /// edge of the grid itself is neither a wall nor a hole. Sums are in f64 in a fixed order.
    ///
    /// # Errors
    /// [`BlurError`] if the map is empty, too large or of the wrong length, or if `sigma` is not in
    /// (0, longer side of the map].
    pub fn new(free: &Grid<bool>, sigma: f64) -> Result<Self, BlurError> {
        check_frame("free map", &free.frame, free.cells.len())?;
        let frame = free.frame;
        let limit = frame.width.max(frame.height) as f64 * frame.resolution;
        if !(sigma > 0.0 && sigma <= limit) {
            return Err(BlurError::Sigma { sigma, limit });
        }
        let kernel = half_kernel(sigma / frame.resolution);
        let source: Vec<f64> = free.cells.iter().map(|&f| f64::from(u8::from(f))).collect();
        let across = blur_rows(&source, frame.width, &kernel);
        let both = blur_columns(&across, frame.width, frame.height, &kernel);
        // A sum of rounded products may exceed 1 by a few ulp; ln of it would be negative.
        let cells = both.into_iter().map(|v| v.clamp(0.0, 1.0) as f32).collect();
        let occupied = Grid {
            frame,
            cells: free.cells.iter().map(|&f| !f).collect(),
        };
        Ok(Self {
            blurred: Grid { frame, cells },
            occupied,
        })
    }

    /// Blurs the free cells of an occupancy grid (`true` = occupied), as [`BlurredMap::new`].
    ///
    /// # Errors
    /// As [`BlurredMap::new`].
    pub fn of_occupied(occupied: &Grid<bool>, sigma: f64) -> Result<Self, BlurError> {
        let free = Grid {
            frame: occupied.frame,
            cells: occupied.cells.iter().map(|&occupied| !occupied).collect(),
        };
        Self::new(&free, sigma)
    }

    /// Rebuilds the map from the two layers of a message: the *unmasked* blur (0…1 per cell, also
    /// inside obstacles) and the occupancy (`true` = occupied).
    ///
    /// # Errors
    /// [`BlurError`] if the layers are empty, too large, of the wrong length, on different frames,
    /// or if a blurred value is not in 0…1.
    pub fn from_parts(blurred: Grid<f32>, occupied: Grid<bool>) -> Result<Self, BlurError> {
        check_frame("blurred layer", &blurred.frame, blurred.cells.len())?;
        check_frame("occupied layer", &occupied.frame, occupied.cells.len())?;
        if blurred.frame != occupied.frame {
            return Err(BlurError::FrameMismatch);
        }
        if let Some(cell) = blurred.cells.iter().position(|v| !(0.0..=1.0).contains(v)) {
            return Err(BlurError::Value {
                value: blurred.cells[cell],
                cell,
            });
        }
        Ok(Self { blurred, occupied })
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.blurred.frame
    }

    /// The unmasked blur, 0…1 per cell; the input of [`Self::from_parts`].
    pub fn grid(&self) -> &Grid<f32> {
        &self.blurred
    }

    /// The occupancy (`true` = occupied).
    pub fn occupied(&self) -> &Grid<bool> {
        &self.occupied
    }

    /// Returns `true` if the point (m) lies in an occupied cell or outside the grid.
    pub fn is_blocked(&self, p: Point2<f64>) -> bool {
        self.occupied.at(p).copied().unwrap_or(true)
    }

    /// Openness of the surroundings of a point (m): 0…1, bilinear between cell centres (constant
    /// over the outer half cell of the grid), continuous up to the walls; 0 in obstacles and
    /// outside.
    pub fn value(&self, p: Point2<f64>) -> f64 {
        if self.is_blocked(p) {
            return 0.0;
        }
        let cells = &self.blurred.cells;
        self.corners(p)
            .map_or(0.0, |c| c.mix(|col, row| self.cell(cells, col, row)))
    }

    /// Gradient of the unmasked blur at a point (1/m), pointing from obstacles to open space.
    ///
    /// Bilinear interpolation of the central differences at the cell centres (one-sided in the
    /// outermost cells), hence continuous. Zero outside the grid.
    pub fn gradient(&self, p: Point2<f64>) -> Vector2<f64> {
        let Some(corners) = self.corners(p) else {
            return Vector2::zeros();
        };
        Vector2::new(
            corners.mix(|col, row| self.difference(col, row, true)),
            corners.mix(|col, row| self.difference(col, row, false)),
        )
    }

    fn cell(&self, cells: &[f32], col: usize, row: usize) -> f64 {
        f64::from(cells[self.blurred.frame.index(col, row)])
    }

    /// Central difference along x or y at a cell centre (1/m).
    fn difference(&self, col: usize, row: usize, along_x: bool) -> f64 {
        let frame = &self.blurred.frame;
        let cells = &self.blurred.cells;
        let (here, last) = if along_x {
            (col, frame.width - 1)
        } else {
            (row, frame.height - 1)
        };
        let (before, after) = (here.saturating_sub(1), (here + 1).min(last));
        if before == after {
            return 0.0;
        }
        let (low, high) = if along_x {
            (self.cell(cells, before, row), self.cell(cells, after, row))
        } else {
            (self.cell(cells, col, before), self.cell(cells, col, after))
        };
        (high - low) / ((after - before) as f64 * frame.resolution)
    }

    /// The four cell centres around a point and its position between them; `None` outside the grid.
    fn corners(&self, p: Point2<f64>) -> Option<Corners> {
        let frame = &self.blurred.frame;
        frame.cell_at(p)?;
        let (col, fx) = between((p.x - frame.origin.x) / frame.resolution - 0.5, frame.width);
        let (row, fy) = between(
            (p.y - frame.origin.y) / frame.resolution - 0.5,
            frame.height,
        );
        let next = (
            (col + 1).min(frame.width - 1),
            (row + 1).min(frame.height - 1),
        );
        Some(Corners {
            col,
            row,
            next,
            fx,
            fy,
        })
    }
}

/// Lower neighbour and fraction for a coordinate counted in cell centres, clamped to the grid.
fn between(coordinate: f64, len: usize) -> (usize, f64) {
    let clamped = coordinate.clamp(0.0, (len - 1) as f64);
    // Truncation rounds down here and, unlike `floor`, needs no call on the oldest x86-64.
    let low = clamped as usize;
    (low, clamped - low as f64)
}

struct Corners {
    col: usize,
    row: usize,
    next: (usize, usize),
    fx: f64,
    fy: f64,
}

impl Corners {
    fn mix(&self, at: impl Fn(usize, usize) -> f64) -> f64 {
        let low = lerp(at(self.col, self.row), at(self.next.0, self.row), self.fx);
        let high = lerp(
            at(self.col, self.next.1),
            at(self.next.0, self.next.1),
            self.fx,
        );
        lerp(low, high, self.fy)
    }
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

fn check_frame(what: &'static str, frame: &GridFrame, found: usize) -> Result<(), BlurError> {
    let GridFrame {
        width,
        height,
        resolution,
        ..
    } = *frame;
    if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
        return Err(BlurError::Size { width, height });
    }
    if !(resolution > 0.0 && resolution.is_finite()) {
        return Err(BlurError::Resolution { resolution });
    }
    let expected = width * height;
    if found != expected {
        return Err(BlurError::Length {
            what,
            found,
            expected,
        });
    }
    Ok(())
}

/// Normalised Gaussian weights at offsets 0, 1, 2, … cells (the other half is its mirror image).
fn half_kernel(sigma_cells: f64) -> Vec<f64> {
    let radius = (4.0 * sigma_cells + 0.5) as usize;
    let mut half: Vec<f64> = (0..=radius)
        .map(|i| {
            let z = i as f64 / sigma_cells;
            math::exp(-0.5 * z * z)
        })
        .collect();
    let total = half[0] + 2.0 * half[1..].iter().sum::<f64>();
    for weight in &mut half {
        *weight /= total;
    }
    half
}

/// Index of the cell at a possibly negative position beyond a mirrored border.
fn mirror(position: isize, len: usize) -> usize {
    let period = 2 * len as isize;
    let folded = position.rem_euclid(period);
    (if folded < len as isize {
        folded
    } else {
        period - 1 - folded
    }) as usize
}

fn blur_rows(source: &[f64], width: usize, kernel: &[f64]) -> Vec<f64> {
    let radius = kernel.len() - 1;
    let mut target = vec![0.0; source.len()];
    let mut padded = vec![0.0; width + 2 * radius];
    for (row, out) in source
        .chunks_exact(width)
        .zip(target.chunks_exact_mut(width))
    {
        for (i, slot) in padded.iter_mut().enumerate() {
            *slot = row[mirror(i as isize - radius as isize, width)];
        }
        for (offset, &weight) in kernel.iter().enumerate() {
            let left = &padded[radius - offset..];
            let right = &padded[radius + offset..];
            add_pair(out, left, right, weight, offset == 0);
        }
    }
    target
}

fn blur_columns(source: &[f64], width: usize, height: usize, kernel: &[f64]) -> Vec<f64> {
    let mut target = vec![0.0; source.len()];
    for (row, out) in target.chunks_exact_mut(width).enumerate() {
        for (offset, &weight) in kernel.iter().enumerate() {
            let below = mirror(row as isize - offset as isize, height) * width;
            let above = mirror(row as isize + offset as isize, height) * width;
            add_pair(out, &source[below..], &source[above..], weight, offset == 0);
        }
    }
    target
}

/// Adds a kernel weight times the two symmetric neighbours (once, at offset 0) to every output.
fn add_pair(out: &mut [f64], low: &[f64], high: &[f64], weight: f64, centre: bool) {
    if centre {
        for (o, &l) in out.iter_mut().zip(low) {
            *o += weight * l;
        }
    } else {
        for ((o, &l), &h) in out.iter_mut().zip(low).zip(high) {
            *o += weight * (l + h);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
