//! Coverage of a workplace by sub-goals.

use std::sync::{Arc, Mutex, PoisonError};

use ::coverage::plan::{CoveragePlan, PlanSpec};
use ::coverage::sub_goals::FollowParams;
use ::coverage::sub_goals::site::Site;
use ::coverage::tour::Iterations;
use chaotic_maps::{AnySource, Emission, Key, KeyKind};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arguments::{self, invalid, refused, scalar};
use crate::interruptible::{compute, short};
use crate::map::Map;

/// Maximum number of sub-goals of one call.
const MAX_GOALS: usize = 1_000_000;

/// Coverage of a workplace: its free rectangles, a tour of them, and chaotic sub-goals.
///
/// The free space of the robot's centre is divided into rectangles; a loop visits all that can be reached, and each gets
/// sub-goals from two Chebyshev maps, mapped affinely onto it (Li et al., *A chaotic coverage path planner for the mobile
/// robot based on the Chebyshev map for special missions*, FITEE 18(9), 2017, Eq. 10).
///
/// Parameters
/// ----------
/// map
///     The map; obstacles count as rectangles around them.
/// start
///     Position of the robot (m), shape (2,), or a robot; moved to the nearest free place.
/// radius
///     Radius of the robot (m).
/// key
///     Generator and initial state as text, such as "chebp:123,456"; a key of the Chebyshev map from the seed if absent.
/// seed
///     Seed of the key.
/// sub_goals
///     Number of sub-goals of a loop, shared by area.
/// loops
///     Number of loops; 0 for no limit.
/// margin
///     Clearance of the robot's body from obstacles (m).
/// tolerance
///     Maximum distance by which rectangles extend beyond the obstacles that they stand for (m).
///
/// Raises
/// ------
/// InvalidInput
///     A value that is out of range, or a workplace without free space.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> map = pr.Map.from_grid(np.zeros((20, 40), dtype=bool), 0.1)
/// >>> plan = pr.coverage.Plan(map, (1, 1), 0.2, seed=1, margin=0.0)
/// >>> plan.rectangles.round(9).tolist()
/// [[0.2, 0.2, 3.8, 1.8]]
/// >>> plan.next(100).shape
/// (100, 2)
#[pyclass(frozen, module = "protean_robotics.coverage")]
#[derive(Debug)]
pub struct Plan {
    goals: Mutex<CoveragePlan<AnySource>>,
    site: Site,
    key: Key,
}

#[pymethods]
impl Plan {
    #[new]
    #[pyo3(signature = (map, start, radius, *, key=None, seed=0, sub_goals=200, loops=0, margin=0.05, tolerance=0.1))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn new(
        py: Python<'_>,
        map: &Map,
        start: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = scalar)] radius: f64,
        key: Option<&str>,
        #[pyo3(from_py_with = scalar)] seed: u64,
        #[pyo3(from_py_with = scalar)] sub_goals: u32,
        #[pyo3(from_py_with = scalar)] loops: u32,
        #[pyo3(from_py_with = scalar)] margin: f64,
        #[pyo3(from_py_with = scalar)] tolerance: f64,
    ) -> PyResult<Self> {
        let start = arguments::point("start", start)?;
        arguments::positive("radius", radius)?;
        if sub_goals == 0 {
            return Err(refused("sub_goals", &sub_goals, "at least 1"));
        }
        let follow = FollowParams {
            margin,
            tolerance,
            ..FollowParams::default()
        };
        parameters::check(&follow).map_err(invalid)?;
        let key = arguments::key(key, KeyKind::ChebP(Emission::Arcsine), seed)?;
        let source = key.source().map_err(invalid)?;
        let Some(space) = map.map.space() else {
            return Err(refused("map", "grids alone", "a map with its exact pieces"));
        };
        let spec = PlanSpec {
            iterations: Iterations::InAll(sub_goals),
            loops,
            ..PlanSpec::default()
        };
        let space = Arc::clone(space);
        let made = compute(py, move || {
            let parts = space.shapes().parts();
            let site = Site::new(*space.bounds(), parts, radius, &follow, start)
                .map_err(|error| error.to_string())?;
            let plan = CoveragePlan::new(site.decomposition.clone(), site.start, &spec, source)
                .map_err(|error| error.to_string())?;
            Ok((plan, site))
        });
        let (plan, site) = made?.map_err(|error: String| invalid(&error))?;
        Ok(Self {
            goals: Mutex::new(plan),
            site,
            key,
        })
    }

    /// Next sub-goals, which the legs between them reach within one free rectangle or bridge each.
    ///
    /// Parameters
    /// ----------
    /// count
    ///     Maximum number of sub-goals.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Positions (m), shape (n, 2); fewer than `count` at the end of the last loop.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     More than 1 million sub-goals at once.
    fn next<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = scalar)] count: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if count > MAX_GOALS {
            return Err(refused("count", &count, "at most 1 million"));
        }
        let goals: Vec<_> = short(py, || {
            let mut plan = self.goals.lock().unwrap_or_else(PoisonError::into_inner);
            core::iter::from_fn(|| plan.step().map(|goal| goal.waypoint.point))
                .take(count)
                .collect()
        });
        arguments::array_of_points(py, &goals)
    }

    /// Free rectangles of the robot's centre (m): minimum x, minimum y, maximum x, maximum y; shape (n, 4).
    #[getter]
    fn rectangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rectangles = self.site.decomposition.rectangles().iter();
        arguments::array_of_rows(py, rectangles.map(|r| [r.min.x, r.min.y, r.max.x, r.max.y]))
    }

    /// Pairs of rectangles that share a border, by index, shape (n, 2).
    #[getter]
    fn bridges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u64>>> {
        let bridges = self.site.decomposition.bridges().iter();
        arguments::array_of_rows(py, bridges.map(|b| b.between.map(|i| i as u64)))
    }

    /// Stops of a loop: index of the rectangle and its number of sub-goals, shape (n, 2).
    #[getter]
    fn tour<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u64>>> {
        let plan = self.goals.lock().unwrap_or_else(PoisonError::into_inner);
        let stops = plan.tour().stops().iter();
        arguments::array_of_rows(
            py,
            stops.map(|s| [s.rectangle as u64, u64::from(s.iterations)]),
        )
    }

    /// Start (m), shape (2,): the given one, or the nearest free place.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, vec![self.site.start.x, self.site.start.y])
    }

    /// Area of the free rectangles (m²).
    #[getter]
    fn area(&self) -> f64 {
        self.site.decomposition.area()
    }

    /// Generator and initial state, as text.
    #[getter]
    fn key(&self) -> String {
        self.key.to_string()
    }
}
