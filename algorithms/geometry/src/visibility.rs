//! Graded line of sight: the visibility of one point from another.
//!
//! The chasing-game paper (section III.C) multiplies the blurred map's values along the ray, each to the
//! power of the step. This module computes the limit for small steps,
//!
//! > V(a, b) = exp( ∫ ln B ds ) along the segment from a to b, s in metres,
//!
//! with B constant in each cell, so the integral is a finite sum of (arc length in the cell) × ln B
//! and no step size remains. V is 0 if the segment crosses an occupied cell, if an end lies in one,
//! or if an end lies outside the grid. Near walls B is small: a view around a corner or along a wall
//! is poor, one down the middle of a street is close to 1.
//!
//! # How it is computed
//! −ln B is stored as a fixed-point number, as prefix sums along the rows and, in a second copy, along the
//! columns. A segment that is longer in x than in y stays in each row for a run of cells. A run costs two
//! interpolated look-ups regardless of its length, and one look-up in a table of "next occupied cell"
//! decides whether it is free. A ray therefore costs as many steps as it has cells along its *shorter*
//! extent. Seven points spread over the ray are looked up first: between random points of a city most rays
//! are blocked, and 97 of 100 blocked ones are detected there.
//!
//! End points are rounded down to 1/65536 of a cell, and all computations up to the final exponential are
//! integer arithmetic. The result is the same on every machine, and bit for bit symmetric because the two
//! ends are put in a canonical order first. The error against the same integral in f64 is below 2e-4 (7e-6
//! on a city of 384 × 384 cells). A ray that passes an obstacle's corner closer than about 1/65536 of a
//! cell may be free or blocked.

mod lanes;
pub mod polygon;

use nalgebra::Point2;

use self::lanes::{LaneTable, Segment};
use crate::blur::BlurredMap;
use crate::grid::GridFrame;
use crate::math;

/// Fractional bits of an end point, in cells.
const POINT_BITS: u32 = 16;

/// Maximum −ln B per metre; a free cell darker than e⁻¹⁶ counts as this dark.
const DARKEST: f64 = 16.0;

/// An end point of a line of sight: a position in a free cell, rounded to 1/65536 of a cell.
///
/// Created by [`VisibilityField::end`], so that a point of several rays is converted and checked once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RayEnd {
    x: i32,
    y: i32,
}

/// Answers line-of-sight queries on one blurred map. See the [module documentation](self).
///
/// ```
/// use geometry::blur::BlurredMap;
/// use geometry::grid::{Grid, GridFrame};
/// use geometry::visibility::VisibilityField;
/// use nalgebra::Point2;
///
/// let frame = GridFrame { width: 20, height: 20, resolution: 0.1, origin: Point2::origin() };
/// let mut free = Grid::filled(frame, true);
/// for row in 5..20 {
///     free.cells[frame.index(10, row)] = false;
/// }
/// let field = VisibilityField::new(&BlurredMap::new(&free, 0.1)?);
/// let viewpoint = Point2::new(0.5, 1.5);
/// assert!(field.visibility(viewpoint, Point2::new(0.5, 0.5)) > 0.9);
/// assert!(!field.is_visible(viewpoint, Point2::new(1.5, 1.5)));
/// # Ok::<(), geometry::blur::BlurError>(())
/// ```
#[derive(Debug, Clone)]
pub struct VisibilityField {
    frame: GridFrame,
    /// Fixed-point units per metre, and the grid's size in them.
    scale: f64,
    limits: (f64, f64),
    /// Occupied cells as bits, rows padded to whole words.
    bits: Vec<u64>,
    /// Words per row of `bits`.
    words: usize,
    /// Runs along x, for rays that are longer in x.
    rows: LaneTable,
    /// Runs along y, for rays that are longer in y.
    columns: LaneTable,
    /// Metres per cell over fixed-point units per nat: scales an integer sum to nats.
    nats: f64,
}

impl VisibilityField {
    /// Prepares the tables for a map: about 12 bytes per cell, a millisecond for 300 × 300 cells.
    pub fn new(map: &BlurredMap) -> Self {
        let frame = *map.frame();
        let occupied = &map.occupied().cells;
        let bits = cost_bits(frame.width.max(frame.height));
        let unit = f64::from(1_u32 << bits);
        let costs: Vec<u32> = map
            .grid()
            .cells
            .iter()
            .map(|&b| {
                let nats = -math::ln(f64::from(b));
                (nats.clamp(0.0, DARKEST) * unit + 0.5) as u32
            })
            .collect();
        let (w, h) = (frame.width, frame.height);
        let rows = LaneTable::new(h, w, |row, col| {
            let i = frame.index(col, row);
            (!occupied[i]).then_some(costs[i])
        });
        let columns = LaneTable::new(w, h, |col, row| {
            let i = frame.index(col, row);
            (!occupied[i]).then_some(costs[i])
        });
        let words = w.div_ceil(64);
        let mut bits = vec![0; words * h];
        for (i, _) in occupied.iter().enumerate().filter(|&(_, &o)| o) {
            bits[i / w * words + i % w / 64] |= 1 << (i % w % 64);
        }
        let point = f64::from(1_u32 << POINT_BITS);
        let scale = point / frame.resolution;
        let limits = (w as f64 * point, h as f64 * point);
        Self {
            frame,
            scale,
            limits,
            bits,
            words,
            rows,
            columns,
            nats: frame.resolution / (unit * point),
        }
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Returns `true` if a point (m) lies in a free cell of the grid.
    pub fn is_free(&self, p: Point2<f64>) -> bool {
        self.end(p).is_some()
    }

    /// The point (m) as an end of lines of sight; `None` in an occupied cell, outside the grid or
    /// if not finite.
    pub fn end(&self, p: Point2<f64>) -> Option<RayEnd> {
        let x = (p.x - self.frame.origin.x) * self.scale;
        let y = (p.y - self.frame.origin.y) * self.scale;
        let inside = x >= 0.0 && y >= 0.0 && x < self.limits.0 && y < self.limits.1;
        if !inside {
            return None;
        }
        // A side has at most 2^14 cells: 30 bits.
        let end = RayEnd {
            x: x as i32,
            y: y as i32,
        };
        (self.occupied_bit(i64::from(end.x), i64::from(end.y)) & 1 == 0).then_some(end)
    }

    /// V(a, b) for two points (m): 0…1; exactly 0 if the line of sight is blocked.
    ///
    /// Symmetric bit for bit; 1 for a = b in a free cell; independent of any step size.
    pub fn visibility(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        match (self.end(a), self.end(b)) {
            (Some(a), Some(b)) => self.depth(a, b).map_or(0.0, |nats| math::exp(-nats)),
            _ => 0.0,
        }
    }

    /// Returns `true` if no occupied cell lies between two points (m) (false if an end is not free).
    pub fn is_visible(&self, a: Point2<f64>, b: Point2<f64>) -> bool {
        match (self.end(a), self.end(b)) {
            (Some(a), Some(b)) => self.depth(a, b).is_some(),
            _ => false,
        }
    }

    /// V between two prepared ends, in single precision (relative error about 1e-7 of
    /// [`Self::visibility`]).
    pub fn between(&self, a: RayEnd, b: RayEnd) -> f32 {
        self.depth(a, b)
            .map_or(0.0, |nats| math::expf(-nats as f32))
    }

    /// Returns `true` if one of seven points spread over the ray lies in an obstacle: this detects most
    /// blocked rays without a single unpredictable branch.
    #[inline]
    fn probe(&self, a: RayEnd, b: RayEnd) -> bool {
        let mut blocked = 0;
        for eighth in 1..8 {
            // At most 30 + 3 bits. The points are the same from either end.
            let x = (i64::from(a.x) * (8 - eighth) + i64::from(b.x) * eighth) >> 3;
            let y = (i64::from(a.y) * (8 - eighth) + i64::from(b.y) * eighth) >> 3;
            blocked |= self.occupied_bit(x, y);
        }
        blocked & 1 != 0
    }

    /// The occupancy of a fixed-point position, in the lowest bit.
    #[inline]
    fn occupied_bit(&self, x: i64, y: i64) -> u64 {
        let word = (y >> POINT_BITS) as usize * self.words + (x >> (POINT_BITS + 6)) as usize;
        self.bits[word] >> ((x >> POINT_BITS) & 63)
    }

    /// Optical depth −ln V between two ends (nats), ≥ 0; `None` if blocked.
    #[inline]
    fn depth(&self, a: RayEnd, b: RayEnd) -> Option<f64> {
        if self.probe(a, b) {
            return None;
        }
        let (dx, dy) = ((b.x - a.x).abs(), (b.y - a.y).abs());
        let (sum, long) = if dx >= dy {
            (self.rows.sum(Segment::new((a.x, a.y), (b.x, b.y)))?, dx)
        } else {
            (self.columns.sum(Segment::new((a.y, a.x), (b.y, b.x)))?, dy)
        };
        if long == 0 {
            return Some(0.0);
        }
        // The sum runs over the longer coordinate; the arc is longer by this factor.
        let (x, y) = (f64::from(dx), f64::from(dy));
        let stretch = (x * x + y * y).sqrt() / f64::from(long);
        Some(sum as f64 * (self.nats * stretch))
    }
}

/// Fractional bits of a cell's cost such that a whole lane of the darkest cells stays below 2^31.
fn cost_bits(longest_side: usize) -> u32 {
    let lane_bits = usize::BITS - longest_side.saturating_sub(1).leading_zeros();
    // DARKEST needs 4 integer bits and, because it can be reached, a fifth.
    (31 - 5 - lane_bits).min(20)
}

#[cfg(test)]
mod tests;
