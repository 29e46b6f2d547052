//! The map of a planner: clearance, and the blurred free space.

use std::sync::Arc;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use nalgebra::{Point2, Vector2};
use thiserror::Error;

use crate::derived::DerivedValues;
use crate::free_space::FreeSpace;

/// Larger clearances (m) are stored as this: a map without obstacles reports infinity, which would
/// corrupt interpolation.
const FAR: f32 = 1.0e6;

/// Number of steps after which a line of sight counts as blocked; a line across a map of 10 000
/// cells that grazes a wall all along needs this many.
const MAX_SIGHT_STEPS: usize = 20_000;

/// Reason why a map is invalid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MapError {
    /// The grid has no cells, or not as many values as its frame requires.
    #[error("the {layer} layer has {values} values for {width} x {height} cells")]
    Size {
        /// Layer of the map.
        layer: &'static str,
        /// Values present.
        values: usize,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
    /// The grid's resolution or origin is not a valid number.
    #[error("the {layer} layer has resolution {resolution} m and origin ({x}, {y}) m")]
    Frame {
        /// Layer of the map.
        layer: &'static str,
        /// Resolution (m).
        resolution: f64,
        /// Origin, x (m).
        x: f64,
        /// Origin, y (m).
        y: f64,
    },
}

/// The arena as a planner knows it.
///
/// Built from the layers of the shared map message; a planner that steers by them needs no vector
/// geometry. A planner that searches for paths gets the exact pieces in addition ([`Self::space`]).
#[derive(Debug, Clone)]
pub struct PlannerMap {
    blurred: BlurredMap,
    clearance: Grid<f32>,
    revision: u64,
    space: Option<Arc<FreeSpace>>,
    derived: DerivedValues,
    shared: bool,
}

impl PlannerMap {
    /// Creates a map from its blurred free space (value 1 in the open, 0 in obstacles), its
    /// clearance and its revision. The clearance is the distance from each cell's centre to the
    /// nearest obstacle (m) (≤ 0 inside one); the revision changes whenever an obstacle does.
    ///
    /// Clearances that are NaN count as blocked.
    ///
    /// # Errors
    /// [`MapError`] if a layer's frame and values do not match.
    pub fn new(
        blurred: BlurredMap,
        mut clearance: Grid<f32>,
        revision: u64,
    ) -> Result<Self, MapError> {
        check("clearance", &clearance)?;
        check("blurred", blurred.grid())?;
        for value in &mut clearance.cells {
            *value = if value.is_nan() {
                0.0
            } else {
                value.clamp(-FAR, FAR)
            };
        }
        Ok(Self {
            blurred,
            clearance,
            revision,
            space: None,
            derived: DerivedValues::default(),
            shared: false,
        })
    }

    /// The map with the exact geometry of the same revision.
    #[must_use]
    pub fn with_space(self, space: Arc<FreeSpace>) -> Self {
        Self {
            space: Some(space),
            ..self
        }
    }

    /// Marks the map as shared by several planners: they then also keep values that cost one
    /// planner alone more to keep than to recompute. Results do not depend on it.
    #[must_use]
    pub fn shared(self) -> Self {
        Self {
            shared: true,
            ..self
        }
    }

    /// The exact geometry; `None` when only the grids are known: the planner did not request it, or
    /// the map has more pieces than fit into a message.
    pub fn space(&self) -> Option<&Arc<FreeSpace>> {
        self.space.as_ref()
    }

    /// Returns `true` if several planners share the map ([`PlannerMap::shared`]).
    pub fn is_shared(&self) -> bool {
        self.shared
    }

    /// Values that planners have derived from this map. Example: the first planner that needs a
    /// graph of paths builds it, and all planners that share the map use it.
    pub fn derived(&self) -> &DerivedValues {
        &self.derived
    }

    /// The blurred free space.
    pub fn blurred(&self) -> &BlurredMap {
        &self.blurred
    }

    /// Distance from each cell's centre to the nearest obstacle (m), finite.
    pub fn clearance_grid(&self) -> &Grid<f32> {
        &self.clearance
    }

    /// The revision from which the map was built.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Distance from the centre of the cell at `p` to the nearest obstacle (m); 0 outside the map
    /// and for a point that is not finite.
    pub fn cell_clearance(&self, p: Point2<f64>) -> f64 {
        self.clearance
            .frame
            .index_at(p)
            .and_then(|index| self.clearance.cells.get(index))
            .map_or(0.0, |value| f64::from(*value))
    }

    /// Distance from `p` to the nearest obstacle (m), interpolated between cell centres; 0 outside
    /// the map and for a point that is not finite.
    pub fn clearance(&self, p: Point2<f64>) -> f64 {
        if self.clearance.frame.cell_at(p).is_none() {
            return 0.0;
        }
        let frame = &self.clearance.frame;
        let x = (p.x - frame.origin.x) / frame.resolution - 0.5;
        let y = (p.y - frame.origin.y) / frame.resolution - 0.5;
        let (col, row) = (whole_below(x), whole_below(y));
        let (fx, fy) = (x - col as f64, y - row as f64);
        let value = |dx: i64, dy: i64| cell_of(&self.clearance, col + dx, row + dy);
        let low = value(0, 0) * (1.0 - fx) + value(1, 0) * fx;
        let high = value(0, 1) * (1.0 - fx) + value(1, 1) * fx;
        low * (1.0 - fy) + high * fy
    }

    /// The unit vector away from the nearest obstacle, by central differences over one cell each
    /// way; `None` where the clearance has no slope (on a ridge, outside the map).
    pub fn away_from_obstacles(&self, p: Point2<f64>) -> Option<Vector2<f64>> {
        let h = self.clearance.frame.resolution;
        let slope = Vector2::new(
            self.clearance(Point2::new(p.x + h, p.y)) - self.clearance(Point2::new(p.x - h, p.y)),
            self.clearance(Point2::new(p.x, p.y + h)) - self.clearance(Point2::new(p.x, p.y - h)),
        );
        let norm = slope.norm();
        // A true distance has slope 1, i.e. a difference of 2h; a tenth of it is a ridge.
        (norm.is_finite() && norm > 0.2 * h).then(|| slope / norm)
    }

    /// Returns `true` if a disc of this radius (m) can travel straight from `from` to `to` (m).
    ///
    /// Marches by the clearance, so that open space costs few steps; accurate to about a cell.
    pub fn line_is_clear(&self, from: Point2<f64>, to: Point2<f64>, radius: f64) -> bool {
        let length = (to - from).norm();
        self.free_run(from, to, radius) >= length
    }

    /// The distance (m) that a disc of this radius (m) covers on the straight line from `from` to
    /// `to` (m) before it would touch an obstacle; at most the length of the line, 0 for points
    /// that are not finite.
    pub fn free_run(&self, from: Point2<f64>, to: Point2<f64>, radius: f64) -> f64 {
        let mut march = March::new(&self.clearance, from, to);
        for _ in 0..MAX_SIGHT_STEPS {
            if !march.step(self, radius) {
                break;
            }
        }
        march.run
    }

    /// As [`Self::free_run`] along several lines.
    ///
    /// Each step along a line waits for the one before it; four lines side by side take two thirds of the time.
    pub fn free_runs<const N: usize>(
        &self,
        lines: [(Point2<f64>, Point2<f64>); N],
        radius: f64,
    ) -> [f64; N] {
        let mut marches = lines.map(|(from, to)| March::new(&self.clearance, from, to));
        for _ in 0..MAX_SIGHT_STEPS {
            let mut goes_on = false;
            for march in &mut marches {
                goes_on |= march.step(self, radius);
            }
            if !goes_on {
                break;
            }
        }
        marches.map(|march| march.run)
    }
}

/// The largest integer not above `value`; unlike `floor` without a call on the oldest x86-64.
pub fn whole_below(value: f64) -> i64 {
    let whole = value as i64;
    whole.saturating_sub(i64::from(whole as f64 > value))
}

/// A march along a line over a grid, without the divisions of [`GridFrame::cell_at`] at each step:
/// a position in cells is a linear function of the distance.
///
/// Rounding makes the two methods differ by much less than [`March::UNSURE`]. This one gives no
/// result for positions that near to the edge of a cell, so its results never differ.
struct March<'a> {
    grid: &'a Grid<f32>,
    from: Point2<f64>,
    line: Vector2<f64>,
    /// Length of the line (m); NaN if it is not finite.
    length: f64,
    /// Distance covered so far (m).
    run: f64,
    /// Start of the line, in cells from the centre of cell (0, 0).
    begin: Vector2<f64>,
    /// Cells per metre of distance; NaN for a line that is left to the other method.
    slope: Vector2<f64>,
}

impl<'a> March<'a> {
    /// Distance (cells) to the edge of a cell below which positions are left to the other method.
    const UNSURE: f64 = 1e-9;

    /// Maximum coordinates of a line and its grid (cells): up to this, a dozen roundings by 2⁻⁵³
    /// add up to less than half of [`March::UNSURE`].
    const MAX_COORDINATE: f64 = 1e5;

    /// Rounds a number to an integer when added to it; the integer is then in the lowest bits.
    const TO_WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

    #[inline]
    fn new(grid: &'a Grid<f32>, from: Point2<f64>, to: Point2<f64>) -> Self {
        let line = to - from;
        let length = line.norm();
        let length = if length.is_finite() { length } else { f64::NAN };
        let GridFrame {
            resolution, origin, ..
        } = grid.frame;
        let per_metre = 1.0 / resolution;
        let largest = from.coords.amax().max(origin.coords.amax()).max(length);
        // Also rejects a line without length.
        let slope = if largest * per_metre < Self::MAX_COORDINATE && length > 0.0 {
            line * (per_metre / length)
        } else {
            Vector2::repeat(f64::NAN)
        };
        Self {
            grid,
            from,
            line,
            length,
            run: 0.0,
            begin: (from - origin) * per_metre - Vector2::repeat(0.5),
            slope,
        }
    }

    /// Extends the run by one step; returns `false` at its end.
    #[inline]
    fn step(&mut self, map: &PlannerMap, radius: f64) -> bool {
        let spare = match self.clearance(self.run) {
            Some(clearance) => f64::from(clearance),
            None => map.cell_clearance(self.point_at(self.run)),
        } - radius;
        // Also stops at NaN radii, and on lines that are not finite.
        let goes_on = spare >= 0.0 && self.run < self.length;
        if goes_on {
            let step = spare.max(self.grid.frame.resolution);
            self.run = (self.run + step).min(self.length);
        }
        goes_on
    }

    /// The point after a run (m).
    fn point_at(&self, run: f64) -> Point2<f64> {
        if self.length > 0.0 {
            self.from + self.line * (run / self.length)
        } else {
            self.from
        }
    }

    /// The clearance (m) of the cell at the point after `run` (m); `None` outside the grid or too
    /// near to the edge of the cell.
    #[inline]
    fn clearance(&self, run: f64) -> Option<f32> {
        let (col, sure_of_col) = Self::nearest(self.begin.x + self.slope.x * run);
        let (row, sure_of_row) = Self::nearest(self.begin.y + self.slope.y * run);
        let frame = &self.grid.frame;
        if !(sure_of_col && sure_of_row && col < frame.width && row < frame.height) {
            return None;
        }
        self.grid.cells.get(frame.index(col, row)).copied()
    }

    /// The integer nearest to a number of less than 2³¹ (a huge one for a negative), and whether it
    /// is certainly the nearest.
    #[inline]
    fn nearest(place: f64) -> (usize, bool) {
        let shifted = place + Self::TO_WHOLE;
        let off = place - (shifted - Self::TO_WHOLE);
        // The sign of a negative number is among these bits.
        (
            shifted.to_bits() as u32 as usize,
            off.abs() < 0.5 - Self::UNSURE,
        )
    }
}

/// Value of a cell; for places beyond the grid's edge, the nearest cell inside.
pub fn cell_of(grid: &Grid<f32>, col: i64, row: i64) -> f64 {
    let col = col.clamp(0, grid.frame.width as i64 - 1) as usize;
    let row = row.clamp(0, grid.frame.height as i64 - 1) as usize;
    grid.cells
        .get(grid.frame.index(col, row))
        .map_or(0.0, |value| f64::from(*value))
}

fn check(layer: &'static str, grid: &Grid<f32>) -> Result<(), MapError> {
    let GridFrame {
        width,
        height,
        resolution,
        origin,
    } = grid.frame;
    let cells = width.checked_mul(height);
    if cells != Some(grid.cells.len()) || cells == Some(0) {
        return Err(MapError::Size {
            layer,
            values: grid.cells.len(),
            width,
            height,
        });
    }
    let usable =
        resolution.is_finite() && resolution > 0.0 && origin.x.is_finite() && origin.y.is_finite();
    if !usable {
        return Err(MapError::Frame {
            layer,
            resolution,
            x: origin.x,
            y: origin.y,
        });
    }
    Ok(())
}
