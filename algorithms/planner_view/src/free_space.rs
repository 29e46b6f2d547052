//! Free places and motions of a disc: exact geometry among convex pieces.
//!
//! [`PlannerMap`](crate::map::PlannerMap) holds the arena as grids. Planners that search for paths test
//! segments and arcs some hundred thousand times per second and need results exact to the nanometre, so
//! that a path may run along a wall. A [`FreeSpace`] has the same pieces and the same index as the world
//! itself ([`ShapeMap`]).
//!
//! **Touching.** A disc that touches (distance = radius) is free. All queries allow [`TOUCHING`] (1 nm) of
//! penetration for rounding, so that tangents of grown obstacles are free. All space beyond the bounds is
//! solid. With a radius of 0 the seam between two touching pieces is free to pass; use the real radius of
//! the robot.

use std::sync::{Arc as Shared, OnceLock};

use geometry::grid::GridFrame;
use geometry::map::{MAX_CELLS, ShapeMap, TOUCHING};
use geometry::math;
use geometry::shape::{Aabb, Convex, ShortArc};
use nalgebra::{Point2, Vector2};
use rand::Rng;
use thiserror::Error;

/// Maximum attempts to draw a free point before none is reported. Cells without free points are left out
/// beforehand, so that sampling works even if a millionth of the remaining area is free.
const MAX_DRAWS: usize = 1 << 24;

/// Maximum number of steps by which a place is moved out of obstacles.
const PUSHES: u32 = 16;

/// Extra distance by which a place is moved (m).
const SLACK: f64 = 1e-6;

/// Reason why a free space cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FreeSpaceError {
    /// The bounds are empty, reversed or not finite.
    #[error("bounds from ({}, {}) to ({}, {}): expected finite bounds with a positive area", .0.min.x, .0.min.y, .0.max.x, .0.max.y)]
    Bounds(Aabb),
    /// The side of the grid's cells is not usable.
    #[error(
        "resolution = {resolution}: expected a number > 0 (m) that makes at most {MAX_CELLS} cells"
    )]
    Resolution {
        /// Side of a cell (m).
        resolution: f64,
    },
}

/// An arc of a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Centre of the circle (m).
    pub center: Point2<f64>,
    /// Radius of the circle (m), ≥ 0.
    pub radius: f64,
    /// Direction from the centre to the start of the arc (rad).
    pub start: f64,
    /// Angle of the arc (rad): counter-clockwise if positive, clockwise if negative.
    pub sweep: f64,
}

impl Arc {
    /// Length (m).
    pub fn length(&self) -> f64 {
        self.radius * self.sweep.abs()
    }

    /// The point at a fraction of the arc, 0 at the start and 1 at the end (m).
    pub fn at(&self, part: f64) -> Point2<f64> {
        self.center + direction(self.start + self.sweep * part) * self.radius
    }

    /// Unit vector of travel at a fraction of the arc.
    pub fn heading(&self, part: f64) -> Vector2<f64> {
        let outward = direction(self.start + self.sweep * part);
        Vector2::new(-outward.y, outward.x) * self.sweep.signum()
    }
}

fn direction(angle: f64) -> Vector2<f64> {
    let (sin, cos) = math::sincos(angle);
    Vector2::new(cos, sin)
}

/// The free space of a disc robot among convex pieces; cheap to clone, shared between threads.
///
/// ```
/// use planner_view::free_space::FreeSpace;
/// use nalgebra::Point2;
/// use geometry::shape::{Aabb, Convex};
///
/// let bounds = Aabb { min: Point2::new(0.0, 0.0), max: Point2::new(4.0, 2.0) };
/// let pillar = Convex::disc(Point2::new(2.0, 1.0), 0.5);
/// let space = FreeSpace::new(vec![pillar], bounds, 0.05).unwrap();
/// let (a, b) = (Point2::new(0.5, 0.4), Point2::new(3.5, 0.4));
/// assert!(space.segment_is_free(a, b, 0.1));
/// assert!(!space.segment_is_free(a, b, 0.2));
/// ```
#[derive(Debug, Clone)]
pub struct FreeSpace {
    inner: Shared<Inner>,
}

#[derive(Debug)]
struct Inner {
    shapes: ShapeMap,
    /// Computed on first use.
    open: OnceLock<OpenCells>,
}

#[derive(Debug)]
struct OpenCells {
    /// Cells that may contain a free point.
    cells: Vec<u32>,
    /// Maximum clearance of the map (m).
    most: f64,
}

impl FreeSpace {
    /// Builds the space between pieces within `bounds` (m).
    ///
    /// `resolution` (m) is the side of the cells of the clearance field that answers most queries; the
    /// results do not depend on it. A twentieth of the width of a street is suitable.
    ///
    /// # Errors
    /// [`FreeSpaceError`] names the invalid value.
    pub fn new(parts: Vec<Convex>, bounds: Aabb, resolution: f64) -> Result<Self, FreeSpaceError> {
        let size = bounds.max - bounds.min;
        let finite = |p: Point2<f64>| p.x.is_finite() && p.y.is_finite();
        let has_inside = size.x > 0.0 && size.y > 0.0;
        if !(finite(bounds.min) && finite(bounds.max) && has_inside) {
            return Err(FreeSpaceError::Bounds(bounds));
        }
        let cells = (size / resolution).map(|cells| (cells - 1e-6).ceil().max(1.0));
        let fits = resolution > 0.0 && cells.x * cells.y <= MAX_CELLS as f64;
        if !fits {
            return Err(FreeSpaceError::Resolution { resolution });
        }
        let frame = GridFrame {
            width: cells.x as usize,
            height: cells.y as usize,
            resolution,
            origin: bounds.min,
        };
        Ok(Self::from(ShapeMap::new(parts, bounds, frame)))
    }

    /// The rectangle beyond which all space is solid.
    pub fn bounds(&self) -> &Aabb {
        self.inner.shapes.bounds()
    }

    /// The pieces, with further queries.
    pub fn shapes(&self) -> &ShapeMap {
        &self.inner.shapes
    }

    /// Distance (m) from a point to the nearest piece or the bounds; 0 or less inside one or
    /// beyond the bounds (by the depth in the nearest piece), NaN for a point that is not finite.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return f64::NAN;
        }
        let distance = self.inner.shapes.distance(p);
        if distance > 0.0 {
            distance
        } else {
            self.inner.shapes.nearest_contact(p).distance.min(0.0)
        }
    }

    /// Returns `true` if a disc of this radius (m) about a point is free.
    #[inline]
    pub fn is_free(&self, p: Point2<f64>, radius: f64) -> bool {
        self.inner.shapes.is_clear(p, radius - TOUCHING)
            && (radius > 0.0 || self.distance(p) >= 0.0)
    }

    /// A free place of a disc of this radius (m) near a point: the point itself, or its position after it is
    /// pushed away from the surfaces that it is too near to. `None` if there is none within `most` (m).
    pub fn free_place(&self, p: Point2<f64>, radius: f64, most: f64) -> Option<Point2<f64>> {
        let mut at = p;
        for _ in 0..PUSHES {
            if self.is_free(at, radius) {
                return ((at - p).norm() <= most).then_some(at);
            }
            let contact = self.inner.shapes.nearest_contact(at);
            if !contact.distance.is_finite() {
                return None;
            }
            at += contact.normal * (radius - contact.distance + SLACK);
        }
        None
    }

    /// Returns `true` if a disc of this radius (m) can travel straight from `a` to `b`; exact: every point
    /// of the segment is tested. `false` for points that are not finite.
    #[inline]
    pub fn segment_is_free(&self, a: Point2<f64>, b: Point2<f64>, radius: f64) -> bool {
        self.inner.shapes.segment_is_clear(a, b, radius)
    }

    /// Returns `true` if a disc of this radius (m) can travel along an arc; exact: every point of it is
    /// tested. `false` for an arc that is not finite. More than a full turn counts as one turn.
    pub fn arc_is_free(&self, arc: &Arc, radius: f64) -> bool {
        use core::f64::consts::{FRAC_PI_2, TAU};

        if !(arc.sweep.is_finite() && arc.start.is_finite() && arc.radius >= 0.0) {
            return false;
        }
        let sweep = arc.sweep.abs().min(TAU);
        // Counter-clockwise from the end from which the arc is counter-clockwise.
        let first = if arc.sweep < 0.0 {
            arc.start - sweep
        } else {
            arc.start
        };
        let pieces = (sweep / FRAC_PI_2).ceil().max(1.0) as u32;
        let step = sweep / f64::from(pieces);
        let mut start = direction(first);
        (1..=pieces).all(|i| {
            let end = direction(first + step * f64::from(i));
            let piece = ShortArc {
                center: arc.center,
                radius: arc.radius,
                start,
                end,
            };
            start = end;
            self.inner.shapes.arc_is_clear(&piece, radius)
        })
    }

    /// A point uniformly distributed over the places where a disc of this radius (m) is free; `None` if
    /// there is (almost) none. Uses a bounded number of the generator's words per attempt.
    pub fn random_free(&self, rng: &mut (impl Rng + ?Sized), radius: f64) -> Option<Point2<f64>> {
        let shapes = &self.inner.shapes;
        let frame = shapes.frame();
        let OpenCells { cells: open, most } = self.open_cells();
        let reach = shapes.clearance_error();
        if *most < radius {
            return None;
        }
        for _ in 0..MAX_DRAWS {
            // The high bits choose the cell: a bias of 2⁻³² at most.
            let chosen = ((rng.next_u64() >> 32) as usize * open.len()) >> 32;
            let cell = *open.get(chosen)? as usize;
            if f64::from(shapes.clearance().cells[cell]) + reach < radius {
                continue;
            }
            let mut unit = || (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
            let within = Vector2::new(
                (cell % frame.width) as f64 + unit(),
                (cell / frame.width) as f64 + unit(),
            );
            let p = frame.origin + within * frame.resolution;
            if self.is_free(p, radius) {
                return Some(p);
            }
        }
        None
    }

    fn open_cells(&self) -> &OpenCells {
        self.inner.open.get_or_init(|| {
            let shapes = &self.inner.shapes;
            let occupied = &shapes.occupancy().cells;
            let clearance = &shapes.clearance().cells;
            let is_open = |&cell: &u32| {
                let cell = cell as usize;
                // A cell with its centre in a piece may extend beyond it. The exact test costs no more
                // than a test of the neighbours' centres.
                let frame = shapes.frame();
                clearance[cell] > 0.0 || !occupied[cell] || {
                    let center = frame.center(cell % frame.width, cell / frame.width);
                    self.distance(center) > -shapes.clearance_error()
                }
            };
            let most = clearance.iter().copied().fold(0.0, f32::max);
            OpenCells {
                cells: (0..occupied.len() as u32).filter(is_open).collect(),
                most: f64::from(most) + shapes.clearance_error(),
            }
        })
    }
}

impl From<ShapeMap> for FreeSpace {
    fn from(shapes: ShapeMap) -> Self {
        let inner = Inner {
            shapes,
            open: OnceLock::new(),
        };
        Self {
            inner: Shared::new(inner),
        }
    }
}
