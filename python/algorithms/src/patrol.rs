//! Patrols along a contour.

use std::sync::Arc;

use ::patrol::awg::{Awg, AwgParams, Preset};
use ::patrol::contour::Contour;
use ::patrol::danger::DangerZones;
use ::patrol::forecast::{Forecast, ForecastError};
use chaotic_maps::{Key, KeyKind};
use metrics::detection::detection_by_place;
use numpy::{PyArray1, PyArray2};
use planner_view::waypoint::WaypointKind;
use pyo3::prelude::*;
use serde_json::Value as Json;

use crate::arguments::{self, invalid, refused, scalar};
use crate::interruptible::compute;

/// Waypoints of a lap: positions, due times, and whether each was inserted.
type Lap<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
);

/// Shares of detected attacks, and their intervals.
type Shares<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// Patrol along a contour as a zig-zag that differs on every lap, and that only the owner of the key can predict.
///
/// A point (X, Y) of a chaotic generator becomes a waypoint in a square of side alpha that moves along the contour at the
/// speed v = length / t_max (cat-map patrol paper, Eq. 2, 3, 7, 9 and 10).
///
/// Parameters
/// ----------
/// contour
///     Corners of the contour (m), shape (n, 2).
/// t_max
///     Time of a lap (s).
/// alpha
///     Width of the zig-zag (m): waypoints lie within half of it on either side.
/// key
///     Generator and initial state as text, such as "catp:0.4,0.644"; a key of the cat map from the seed if absent.
/// seed
///     Seed of the key.
/// closed
///     True if the contour ends at its start; an open one is driven there and back.
/// preset
///     Choices that the paper leaves open: "default", "printed" (its formulas) or "paper_fit" (its figures).
///
/// Raises
/// ------
/// InvalidInput
///     A contour, time, width, key or preset that is invalid.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> square = [(0, 0), (4, 0), (4, 4), (0, 4)]
/// >>> patrol = pr.patrol.ZigZag(square, t_max=32, alpha=0.5, key="catp:0.4,0.644")
/// >>> patrol.v, patrol.waypoints_per_lap
/// (0.5, 32)
/// >>> points, due, inserted = patrol.lap(0)
/// >>> points[7].tolist(), float(due[7]), bool(inserted[7])
/// ([4.0, 0.0], 8.0, False)
/// >>> patrol.predict(8.0).tolist()
/// [4.0, 0.0]
#[pyclass(frozen, module = "protean_robotics.patrol")]
#[derive(Debug)]
pub struct ZigZag {
    forecast: Arc<Forecast>,
    key: Key,
}

#[pymethods]
impl ZigZag {
    #[new]
    #[pyo3(signature = (contour, *, t_max, alpha, key=None, seed=0, closed=true, preset="default"))]
    fn new(
        contour: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = scalar)] t_max: f64,
        #[pyo3(from_py_with = scalar)] alpha: f64,
        key: Option<&str>,
        #[pyo3(from_py_with = scalar)] seed: u64,
        closed: bool,
        preset: &str,
    ) -> PyResult<Self> {
        let corners = arguments::points("contour", contour)?.points;
        let contour = if closed {
            Contour::closed(&corners)
        } else {
            Contour::open(&corners)
        };
        let contour = contour.map_err(invalid)?;
        let preset: Preset = serde_json::from_value(Json::from(preset)).map_err(|_| {
            refused(
                "preset",
                preset,
                "\"default\", \"printed\" or \"paper_fit\"",
            )
        })?;
        let params = AwgParams {
            t_max,
            alpha,
            mode: preset.mode(),
        };
        let awg = Awg::new(&contour, &DangerZones::default(), params).map_err(invalid)?;
        let key = arguments::key(key, KeyKind::CatP, seed)?;
        let source = key.source().map_err(invalid)?;
        Ok(Self {
            forecast: Arc::new(Forecast::new(awg, source)),
            key,
        })
    }

    /// Waypoints of a lap.
    ///
    /// Parameters
    /// ----------
    /// number
    ///     Number of the lap, from 0.
    ///
    /// Returns
    /// -------
    /// points : ndarray
    ///     Positions (m), shape (waypoints_per_lap, 2); the start of the lap is the end of the lap before.
    /// due : ndarray
    ///     Times at which the robot should be there (s), since the start of lap 0, shape (waypoints_per_lap,).
    /// inserted : ndarray
    ///     True for inserted ones; the others are corners of the contour.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     A lap that is too far ahead for a generator that cannot jump.
    #[pyo3(signature = (number=0))]
    fn lap<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = scalar)] number: u32,
    ) -> PyResult<Lap<'py>> {
        let forecast = Arc::clone(&self.forecast);
        let waypoints = compute(py, move || forecast.lap(number))?;
        let waypoints = waypoints.map_err(invalid)?;
        let awg = self.forecast.awg();
        let due = waypoints.iter().map(|w| awg.due_s(w.number)).collect();
        let inserted = waypoints
            .iter()
            .map(|w| w.kind == WaypointKind::Inserted)
            .collect();
        let points = waypoints.iter().map(|w| [w.point.x, w.point.y]);
        Ok((
            arguments::array_of_rows(py, points)?,
            PyArray1::from_vec(py, due),
            PyArray1::from_vec(py, inserted),
        ))
    }

    /// Position of a robot that keeps to the times of the waypoints, without computing the laps before.
    ///
    /// Parameters
    /// ----------
    /// times
    ///     Times since the start of lap 0 (s), ≥ 0: a number, or shape (n,).
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     Positions (m), shape (2,) or (n, 2).
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     A time that is negative, not finite or too far ahead.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (times, is_single) = if let Ok(time) = times.extract::<f64>() {
            (vec![time], true)
        } else {
            let expected = "finite numbers ≥ 0 (s), one or of shape (n,)";
            (arguments::list("times", times, expected)?, false)
        };
        let forecast = Arc::clone(&self.forecast);
        let points = compute(py, move || -> Result<Vec<_>, ForecastError> {
            let at = |&time: &f64| Ok(forecast.at_time(time)?.point.coords);
            times.iter().map(at).collect()
        })?;
        let points = points.map_err(invalid)?;
        arguments::vector_per_point(py, is_single, &points)
    }

    /// Generator and initial state, as text.
    #[getter]
    fn key(&self) -> String {
        self.key.to_string()
    }

    /// Speed along the contour (m/s).
    #[getter]
    fn v(&self) -> f64 {
        self.forecast.awg().v()
    }

    /// Length of the contour (m).
    #[getter]
    fn length(&self) -> f64 {
        self.forecast.awg().contour_length()
    }

    /// Time of a lap by the times of its waypoints (s).
    #[getter]
    fn lap_time(&self) -> f64 {
        self.forecast.lap_time()
    }

    /// Number of waypoints of a lap.
    #[getter]
    fn waypoints_per_lap(&self) -> u64 {
        self.forecast.awg().waypoints_per_lap()
    }
}

/// Shares of the start times at which attacks on places are detected, and their intervals, shapes (n,) and (n, 2).
///
/// `guards` has the positions of all guards at the first time, then at the second one, and so on.
#[pyfunction]
pub fn detection<'py>(
    py: Python<'py>,
    times: &Bound<'py, PyAny>,
    guards: &Bound<'py, PyAny>,
    places: &Bound<'py, PyAny>,
    distance: f64,
    duration: f64,
) -> PyResult<Shares<'py>> {
    let times = arguments::list("times", times, "finite numbers (s)")?;
    let guards = arguments::points("guards", guards)?.points;
    let places = arguments::points("places", places)?.points;
    arguments::not_negative("distance", distance)?;
    arguments::positive("duration", duration)?;
    let shares = compute(py, move || {
        detection_by_place(&times, &guards, &places, distance, duration)
    })?;
    let expected = "a duration for which ten attacks or more end in the time";
    let shares = shares.ok_or_else(|| refused("duration", &duration, expected))?;
    let intervals = arguments::array_of_rows(py, shares.iter().map(|place| place.interval))?;
    let shares = shares.iter().map(|place| place.share).collect();
    Ok((PyArray1::from_vec(py, shares), intervals))
}
