//! The map of a planner.

mod queries;
mod source;

use std::path::PathBuf;
use std::sync::Arc;

use navigation::shortest_paths::ShortestPaths;
use numpy::{IntoPyArray as _, PyArray1, PyArray2, PyArrayMethods as _};
use planner_view::map::PlannerMap;
use pyo3::prelude::*;

use crate::arguments::{self, Points, scalar};
use crate::interruptible::{compute, each};

/// A map: its grids, and the exact pieces of its obstacles.
///
/// Parameters
/// ----------
/// source
///     Name of a built-in scenario, or path of a scenario or of a map (``.toml``, or ``.yaml`` of ROS).
///
/// Raises
/// ------
/// InvalidInput
///     The source does not exist or is invalid; the text is that of the command.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> map = pr.Map("chase")
/// >>> map.grid.shape, map.resolution
/// ((380, 380), 0.05)
/// >>> map.path((-9.0, -9.0), (9.0, 9.0), radius=0.1).shape[1]
/// 2
#[pyclass(frozen, module = "protean_robotics")]
#[derive(Debug)]
pub struct Map {
    /// The map.
    pub map: Arc<PlannerMap>,
    /// Source, for pickling: name or path of the source (of a grid: None) and blur (m); None for a map of a
    /// run.
    #[pyo3(get, name = "_recipe")]
    pub recipe: Option<(Option<PathBuf>, f64)>,
}

#[pymethods]
impl Map {
    #[new]
    fn new(py: Python<'_>, #[pyo3(from_py_with = scalar)] source: PathBuf) -> PyResult<Self> {
        let name = source.to_string_lossy().into_owned();
        let map = compute(py, move || source::read(&name))??;
        // Names of built-in scenarios have no extension.
        let is_name = source.extension().is_none();
        let path = if is_name {
            Ok(source.clone())
        } else {
            std::path::absolute(&source)
        };
        let recipe = Some((Some(path.unwrap_or(source)), 0.0));
        Ok(Self { map, recipe })
    }

    /// Map of an occupancy grid.
    ///
    /// Parameters
    /// ----------
    /// blocked
    ///     True for cells in an obstacle, shape (rows, columns); rows along +y, columns along +x.
    /// resolution
    ///     Side of a cell (m).
    /// origin
    ///     Outer corner of cell (0, 0) (m), shape (2,).
    /// blur_sigma
    ///     Standard deviation of the blur of the free space (m), which potential fields use.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     The grid is empty, or a value is out of range.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> blocked = np.zeros((40, 80), dtype=bool)
    /// >>> blocked[:30, 40] = True
    /// >>> map = pr.Map.from_grid(blocked, 0.1)
    /// >>> map.bounds.tolist()
    /// [[0.0, 0.0], [8.0, 4.0]]
    #[staticmethod]
    #[pyo3(signature = (blocked, resolution, origin=None, *, blur_sigma=0.19))]
    fn from_grid(
        blocked: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = scalar)] resolution: f64,
        origin: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = scalar)] blur_sigma: f64,
    ) -> PyResult<Self> {
        let map = queries::from_grid(blocked, resolution, origin, blur_sigma)?;
        let recipe = Some((None, blur_sigma));
        Ok(Self { map, recipe })
    }

    /// Number that changes with every obstacle.
    #[getter]
    fn revision(&self) -> u64 {
        self.map.revision()
    }

    /// Side of a cell (m).
    #[getter]
    fn resolution(&self) -> f64 {
        self.map.clearance_grid().frame.resolution
    }

    /// Outer corner of cell (0, 0) (m), shape (2,).
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let origin = self.map.clearance_grid().frame.origin;
        vec![origin.x, origin.y].into_pyarray(py)
    }

    /// Lower left and upper right corner (m), shape (2, 2); everything beyond is solid.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (min, max) = queries::bounds(&self.map);
        arguments::array_of_points(py, &[min, max])
    }

    /// Occupancy: true for each cell whose centre is in an obstacle, shape (rows, columns); a copy.
    #[getter]
    fn grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let grid = self.map.blurred().occupied();
        let cells = grid.cells.clone().into_pyarray(py);
        cells.reshape([grid.frame.height, grid.frame.width])
    }

    /// Distance from the centre of each cell to the nearest obstacle (m), shape (rows, columns); a copy.
    #[getter]
    fn clearance_grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let grid = self.map.clearance_grid();
        let cells = grid.cells.clone().into_pyarray(py);
        cells.reshape([grid.frame.height, grid.frame.width])
    }

    /// Draw the obstacles into axes of matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes; new ones if absent.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     matplotlib is not installed.
    #[pyo3(signature = (*, ax=None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::plots(slf.py())?.call_method1("map_axes", (slf, ax))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        crate::plots(slf.py())?.call_method1("map_html", (slf,))
    }

    /// Corners of the exact shortest path of a disc.
    ///
    /// Corners around an obstacle lie outside the true arc, at most 5 mm from it, so that a disc that drives straight
    /// from one to the next does not touch the obstacle. An end where the disc does not fit is moved to the nearest
    /// free place, at most 0.3 m away. The structure of a radius is built once for a map.
    ///
    /// Parameters
    /// ----------
    /// start
    ///     A point (m), shape (2,), or a robot.
    /// goal
    ///     A point (m), shape (2,), or a robot.
    /// radius
    ///     Radius of the disc (m); that of the robot if absent.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Points from the start to the goal (m), shape (n, 2); shape (0, 2) if no path leads to the goal.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     A point that is not finite, a radius that is not above 0, or none for a start that is no robot.
    ///
    /// Notes
    /// -----
    /// Tangent graph of the grown obstacles: Laumond, *Obstacle growing in a nonpolygonal world* (1987); Chew,
    /// *Planning the shortest path for a disc in O(n² log n) time* (1985).
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.path((0.5, 0.5), (3.5, 1.5), radius=0.2).tolist()
    /// [[0.5, 0.5], [3.5, 1.5]]
    #[pyo3(signature = (start, goal, radius=None))]
    fn path<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        goal: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] radius: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let radius = queries::radius(start, radius)?;
        let start = arguments::point("start", start)?;
        let goal = arguments::point("goal", goal)?;
        let map = Arc::clone(&self.map);
        let corners = compute(py, move || {
            ShortestPaths::new(&map, radius)?.corners(start, goal)
        })?;
        arguments::array_of_points(py, &corners.map_err(arguments::invalid)?)
    }

    /// Length of the exact shortest path of a disc, which is that of `path` but for the corners outside its arcs.
    ///
    /// Parameters
    /// ----------
    /// start
    ///     Points (m), shape (2,) or (n, 2), or a robot.
    /// goal
    ///     A point (m), shape (2,), or a robot.
    /// radius
    ///     Radius of the disc (m); that of the robot if absent.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     Length (m) for each start; infinity where no path leads to the goal.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.path_length([(0.5, 1.0), (1.5, 1.0)], (3.5, 1.0), radius=0.2).tolist()
    /// [3.0, 2.0]
    #[pyo3(signature = (start, goal, radius=None))]
    fn path_length<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        goal: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] radius: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let radius = queries::radius(start, radius)?;
        let Points { points, is_single } = arguments::points("start", start)?;
        let goal = arguments::point("goal", goal)?;
        let map = Arc::clone(&self.map);
        let lengths = compute(py, move || {
            ShortestPaths::new(&map, radius)?.lengths(&points, goal)
        })?;
        let lengths = lengths.map_err(arguments::invalid)?;
        arguments::per_point(py, is_single, lengths)
    }

    /// Exact distance from points to the nearest obstacle or the bounds (m).
    ///
    /// Parameters
    /// ----------
    /// points
    ///     Points (m), shape (2,) or (n, 2), or a robot.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     Distance for each point; negative inside an obstacle, down to the depth.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.clearance((0.5, 1.0))
    /// 0.5
    fn clearance<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = arguments::points("points", points)?;
        let values = each(py, &points.points, |&p| queries::clearance(&self.map, p))?;
        arguments::per_point(py, points.is_single, values)
    }

    /// Free straight drives of a disc from a point to others; exact.
    ///
    /// Parameters
    /// ----------
    /// start
    ///     A point (m), shape (2,), or a robot.
    /// ends
    ///     Points (m), shape (2,) or (n, 2), or a robot.
    /// radius
    ///     Radius of the disc (m).
    ///
    /// Returns
    /// -------
    /// bool or ndarray
    ///     True for each end that the disc reaches.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.line_is_clear((1, 1), [(2, 1), (9, 1)], radius=0.2).tolist()
    /// [True, False]
    fn line_is_clear<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        ends: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] radius: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        arguments::not_negative("radius", radius)?;
        let start = arguments::point("start", start)?;
        let ends = arguments::points("ends", ends)?;
        let values = each(py, &ends.points, |&end| {
            queries::line_is_clear(&self.map, start, end, radius)
        })?;
        arguments::per_point(py, ends.is_single, values)
    }

    /// Distance that a disc covers straight from a point towards others before it would touch an obstacle (m).
    ///
    /// Marches over the grid: accurate to about a cell.
    ///
    /// Parameters
    /// ----------
    /// start
    ///     A point (m), shape (2,), or a robot.
    /// ends
    ///     Points (m), shape (2,) or (n, 2), or a robot.
    /// radius
    ///     Radius of the disc (m).
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     Distance (m) for each end, at most that of the end.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.free_run((1, 1), (2, 1), radius=0.2)
    /// 1.0
    fn free_run<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        ends: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] radius: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        arguments::not_negative("radius", radius)?;
        let start = arguments::point("start", start)?;
        let ends = arguments::points("ends", ends)?;
        let values = each(py, &ends.points, |&end| {
            self.map.free_run(start, end, radius)
        })?;
        arguments::per_point(py, ends.is_single, values)
    }

    /// Distances along rays to the first obstacle; exact, as those of a range sensor.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     A point (m), shape (2,), or a robot.
    /// angles
    ///     Directions of the rays (rad), shape (n,), counter-clockwise from the x axis.
    /// range_max
    ///     Maximum distance (m).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Distance for each ray (m), shape (n,); infinity without an obstacle within the maximum.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.cast_rays((1, 1), [0, np.pi / 2], 2.0).tolist()
    /// [inf, 1.0]
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        angles: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] range_max: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arguments::positive("range_max", range_max)?;
        let at = arguments::point("at", at)?;
        let angles = arguments::list("angles", angles, "finite numbers (rad), shape (n,)")?;
        let ranges = each(py, &angles, |&angle| {
            queries::cast_ray(&self.map, at, angle, range_max)
        })?;
        Ok(ranges.into_pyarray(py))
    }

    /// Unit vectors away from the nearest obstacle, by differences over the cells around each point.
    ///
    /// Parameters
    /// ----------
    /// points
    ///     Points (m), shape (2,) or (n, 2), or a robot.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Vector for each point, of the shape of the points; zero midway between obstacles and outside the map.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> map.away_from_obstacles((0.5, 1.0)).round(6).tolist()
    /// [1.0, 0.0]
    fn away_from_obstacles<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = arguments::points("points", points)?;
        let vectors = each(py, &points.points, |&p| {
            self.map.away_from_obstacles(p).unwrap_or_default()
        })?;
        arguments::vector_per_point(py, points.is_single, &vectors)
    }

    /// Border of the region that is visible from a point.
    ///
    /// Parameters
    /// ----------
    /// at
    ///     A point (m), shape (2,), or a robot.
    /// range
    ///     Maximum distance (m); unlimited if absent.
    /// field_of_view
    ///     Opening angle around the heading (rad); all round if absent.
    /// heading
    ///     Heading of the view (rad).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Corners (m), counter-clockwise, shape (n, 2); shape (0, 2) for a point that is not in free space. With a
    ///     field of view, the polygon closes over the point.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, protean_robotics as pr
    /// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
    /// >>> seen = map.visible((1, 1))
    /// >>> seen.max(axis=0).round(6).tolist()
    /// [4.0, 2.0]
    #[pyo3(signature = (at, range=None, *, field_of_view=None, heading=0.0))]
    fn visible<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = scalar)] range: Option<f64>,
        #[pyo3(from_py_with = scalar)] field_of_view: Option<f64>,
        #[pyo3(from_py_with = scalar)] heading: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let seen = queries::visible(&self.map, at, range, field_of_view, heading)?;
        arguments::array_of_points(py, &seen)
    }

    fn __repr__(&self) -> String {
        let (min, max) = queries::bounds(&self.map);
        format!(
            "<Map from ({:.2}, {:.2}) to ({:.2}, {:.2})>",
            min.x, min.y, max.x, max.y
        )
    }
}
