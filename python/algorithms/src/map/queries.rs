//! Queries of a map for arrays of points.

use std::sync::Arc;

use geometry::grid::{Grid, GridFrame};
use geometry::map::{CellMap, WorldMap};
use geometry::math;
use geometry::visibility::polygon::{SightLimits, Viewpoint, Walls};
use nalgebra::{Point2, Vector2};
use numpy::{AllowTypeChange, PyArrayLike2};
use planner_view::map::PlannerMap;
use pyo3::prelude::*;
use scenario::spec::MAX_CELLS;

use super::source::of_world;
use crate::arguments::{at_most, attribute, invalid, point, positive, refused, row};
use crate::interruptible::compute;

/// Returns the map of an occupancy grid of shape (rows, columns).
///
/// # Errors
/// A size, resolution, origin or blur that is out of range.
pub fn from_grid(
    blocked: &Bound<'_, PyAny>,
    resolution: f64,
    origin: Option<&Bound<'_, PyAny>>,
    blur_sigma: f64,
) -> PyResult<Arc<PlannerMap>> {
    let cells: PyArrayLike2<'_, bool, AllowTypeChange> = blocked.extract().map_err(|_| {
        refused(
            "blocked",
            blocked,
            "a boolean array of shape (rows, columns)",
        )
    })?;
    let cells = cells.as_array();
    at_most("blocked", cells.len(), MAX_CELLS)?;
    let [x, y] = match origin {
        Some(origin) => row("origin", origin, "two finite numbers (m)")?,
        None => [0.0; 2],
    };
    let grid = Grid {
        frame: GridFrame {
            width: cells.ncols(),
            height: cells.nrows(),
            resolution,
            origin: Point2::new(x, y),
        },
        cells: cells.iter().copied().collect(),
    };
    compute(blocked.py(), move || {
        let map = CellMap::from_grid(&grid);
        let world = WorldMap::from_cells(&map).map_err(invalid)?;
        of_world(&world, blur_sigma)
    })?
}

/// Returns the radius of a disc (m); if absent, of the robot at whose position its paths begin.
///
/// # Errors
/// There is none.
pub fn radius(start: &Bound<'_, PyAny>, radius: Option<f64>) -> PyResult<f64> {
    match (radius, attribute(start, "radius")?) {
        (Some(radius), _) => Ok(radius),
        (None, Some(radius)) => radius.extract(),
        (None, None) => Err(refused(
            "radius",
            "None",
            "a number above 0 (m), if the start is no robot",
        )),
    }
}

/// Returns the visible part of the free cells around a point or a robot.
///
/// # Errors
/// A range or field of view that is out of range.
pub fn visible(
    map: &Arc<PlannerMap>,
    at: &Bound<'_, PyAny>,
    range: Option<f64>,
    field_of_view: Option<f64>,
    heading: f64,
) -> PyResult<Vec<Point2<f64>>> {
    for (name, value) in [("range", range), ("field_of_view", field_of_view)] {
        value.map_or(Ok(()), |value| positive(name, value))?;
    }
    let limits = SightLimits {
        range,
        field_of_view,
    };
    if !heading.is_finite() {
        return Err(refused("heading", &heading, "a finite number (rad)"));
    }
    let viewpoint = Viewpoint {
        position: point("at", at)?,
        heading,
        limits,
    };
    let map = Arc::clone(map);
    compute(at.py(), move || {
        let walls = map
            .derived()
            .get("walls", || Walls::new(map.blurred().occupied().clone()));
        walls.seen_from(&viewpoint)
    })
}

/// Returns the lower left and the upper right corner of a map (m).
pub fn bounds(map: &PlannerMap) -> (Point2<f64>, Point2<f64>) {
    if let Some(space) = map.space() {
        return (space.bounds().min, space.bounds().max);
    }
    let frame = &map.clearance_grid().frame;
    let size = Vector2::new(frame.width as f64, frame.height as f64);
    (frame.origin, frame.origin + size * frame.resolution)
}

/// Returns the distance of a point from the nearest obstacle (m): exact, or by the grid of a map without pieces.
pub fn clearance(map: &PlannerMap, p: Point2<f64>) -> f64 {
    match map.space() {
        Some(space) => space.distance(p),
        None => map.clearance(p),
    }
}

/// Returns whether a disc of this radius (m) can drive straight from a point to another: exact, or by the grid of a map
/// without pieces.
pub fn line_is_clear(map: &PlannerMap, start: Point2<f64>, end: Point2<f64>, radius: f64) -> bool {
    match map.space() {
        Some(space) => space.segment_is_free(start, end, radius),
        None => map.line_is_clear(start, end, radius),
    }
}

/// Returns the distance to the first obstacle in a direction (rad); infinity beyond `range_max` (m).
pub fn cast_ray(map: &PlannerMap, at: Point2<f64>, angle: f64, range_max: f64) -> f64 {
    let (sin, cos) = math::sincos(angle);
    let direction = Vector2::new(cos, sin);
    let hit = match map.space() {
        Some(space) => space.shapes().cast_ray(at, direction, range_max),
        None => {
            Some(map.free_run(at, at + direction * range_max, 0.0)).filter(|&run| run < range_max)
        }
    };
    hit.unwrap_or(f64::INFINITY)
}
