//! Objects that steer over many ticks.

use std::sync::{Mutex, PoisonError};

use avoidance::tangent_bug::{self, Advice, Mode};
use control::path_tracking::{self, Path, TrackingParams};
use numpy::PyArray1;
use planner_view::limits::Limits;
use planner_view::view::ScanView;
use pyo3::prelude::*;
use robot::spec::MAX_BEAMS;

use crate::arguments::{self, invalid, refused, scalar};

/// Point to drive to and the mode; `None` if no path leads to the goal.
type Head<'py> = Option<(Bound<'py, PyArray1<f64>>, &'static str)>;

/// Maximum difference of the steps between beams (rad).
const SAME_STEP: f64 = 1e-6;

/// Way around unknown obstacles to a point, with a range sensor and no map.
///
/// Kamon, Rimon and Rivlin, *TangentBug: A Range-Sensor-Based Navigation Algorithm* (IJRR 1998).
///
/// Parameters
/// ----------
/// radius
///     Radius of the robot (m); obstacles are grown by it and by a margin of 5 cm.
///
/// Raises
/// ------
/// InvalidInput
///     A radius that is not above 0.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> bug = pr.steering.TangentBug(0.1)
/// >>> beams = np.linspace(-np.pi, np.pi, 360, endpoint=False)
/// >>> free = np.full(360, np.inf)
/// >>> bug.advise((0, 0, 0), free, (2, 0), angles=beams, range_max=1.5)
/// (array([2., 0.]), 'to_goal')
#[pyclass(frozen, module = "protean_robotics.steering")]
#[derive(Debug)]
pub struct TangentBug {
    bug: Mutex<tangent_bug::TangentBug>,
}

#[pymethods]
impl TangentBug {
    #[new]
    fn new(#[pyo3(from_py_with = scalar)] radius: f64) -> PyResult<Self> {
        let bug = tangent_bug::TangentBug::new(radius).map_err(invalid)?;
        Ok(Self {
            bug: Mutex::new(bug),
        })
    }

    /// Point to drive to now.
    ///
    /// Parameters
    /// ----------
    /// pose
    ///     Position (m) and heading (rad), shape (3,), or a robot.
    /// ranges
    ///     A scan all round: ranges (m), shape (beams,), infinity without an echo; or the scan of a planner, which has
    ///     the next two values.
    /// goal
    ///     The goal (m), shape (2,), or a robot; another one than before begins a new search.
    /// angles
    ///     Directions of the beams from the heading (rad), shape (beams,), evenly spaced.
    /// range_max
    ///     Maximum range of the sensor (m).
    /// tolerance
    ///     Distance from the goal at which it is reached (m).
    ///
    /// Returns
    /// -------
    /// tuple of ndarray and str, or None
    ///     The point (m), shape (2,), and the mode: "to_goal", "tangent", "boundary", "leaving" or "detour". None if no path
    ///     leads to the goal; the robot's position and "stuck" if the search has ended without proof of that.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     A number that is not finite, a scan without beams, or beams that are not evenly spaced.
    #[pyo3(signature = (pose, ranges, goal, *, angles=None, range_max=None, tolerance=0.05))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn advise<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        ranges: &Bound<'py, PyAny>,
        goal: &Bound<'py, PyAny>,
        angles: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = scalar)] range_max: Option<f64>,
        #[pyo3(from_py_with = scalar)] tolerance: f64,
    ) -> PyResult<Head<'py>> {
        let pose = arguments::pose("pose", pose)?;
        let goal = arguments::point("goal", goal)?;
        arguments::not_negative("tolerance", tolerance)?;
        let scan = Scan::from_ranges(ranges, angles, range_max)?;
        let view = scan.view();
        let mut bug = self.bug.lock().unwrap_or_else(PoisonError::into_inner);
        let advice = bug.advise(&pose, &view, goal, tolerance);
        drop(bug);
        match advice {
            Some(Advice::Head { towards, mode }) => {
                let point = PyArray1::from_vec(py, vec![towards.x, towards.y]);
                Ok(Some((point, name(mode))))
            }
            Some(Advice::Stuck) => Ok(Some((
                PyArray1::from_vec(py, vec![pose.x, pose.y]),
                "stuck",
            ))),
            Some(Advice::Unreachable) => Ok(None),
            None => Err(refused("ranges", "empty", "at least one beam")),
        }
    }

    /// Forgets the goal and everything seen on the way to it.
    fn reset(&self) {
        let mut bug = self.bug.lock().unwrap_or_else(PoisonError::into_inner);
        bug.reset();
    }
}

fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::ToGoal => "to_goal",
        Mode::Tangent(_) => "tangent",
        Mode::Boundary(_) => "boundary",
        Mode::Leaving => "leaving",
        Mode::Detour => "detour",
    }
}

/// A range scan.
struct Scan {
    ranges: Vec<f32>,
    first: f64,
    step: f64,
    range_max: f64,
}

impl Scan {
    fn from_ranges(
        ranges: &Bound<'_, PyAny>,
        angles: Option<&Bound<'_, PyAny>>,
        range_max: Option<f64>,
    ) -> PyResult<Self> {
        let own = |name| arguments::attribute(ranges, name);
        let (of_scan, own_angles) = (own("ranges")?, own("angles")?);
        let range_max = match (range_max, own("range_max")?) {
            (Some(range_max), _) => range_max,
            (None, Some(range_max)) => range_max.extract()?,
            (None, None) => return Err(refused("range_max", "None", "a number above 0 (m)")),
        };
        arguments::positive("range_max", range_max)?;
        let angles = angles
            .or(own_angles.as_ref())
            .ok_or_else(|| refused("angles", "None", "the directions of the beams (rad)"))?;
        let angles = arguments::list("angles", angles, "finite numbers (rad), shape (beams,)")?;
        let values = arguments::list_with_infinity("ranges", of_scan.as_ref().unwrap_or(ranges))?;
        arguments::at_most("ranges", values.len(), MAX_BEAMS)?;
        if values.len() != angles.len() || values.is_empty() {
            let found = format!("{} ranges and {} angles", values.len(), angles.len());
            return Err(refused(
                "ranges",
                &found,
                "one range for each angle, at least one",
            ));
        }
        let (first, last) = (angles[0], angles[angles.len() - 1]);
        let step = (last - first) / (angles.len() - 1).max(1) as f64;
        let even = |(i, angle): (usize, &f64)| (first + i as f64 * step - angle).abs() < SAME_STEP;
        if !angles.iter().enumerate().all(even) {
            return Err(refused(
                "angles",
                "uneven",
                "evenly spaced directions (rad)",
            ));
        }
        Ok(Self {
            ranges: values.into_iter().map(|range| range as f32).collect(),
            first,
            step,
            range_max,
        })
    }

    fn view(&self) -> ScanView<'_> {
        ScanView {
            angle_min: self.first,
            angle_increment: self.step,
            range_min: 0.0,
            range_max: self.range_max,
            ranges: &self.ranges,
        }
    }
}

/// Follower of a path: pure pursuit, slower where the robot could not follow otherwise.
///
/// Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm* (CMU-RI-TR-92-01, 1992); Macenski et al.,
/// *Regulated pure pursuit* (Autonomous Robots 2023).
///
/// Parameters
/// ----------
/// path
///     Corners (m), shape (n, 2).
/// params
///     Other values than the defaults of ``look_ahead`` (m), ``look_ahead_time_s`` (s), ``min_look_ahead`` (m),
///     ``turn_on_spot`` (rad), ``turn_gain`` (1/s), ``speed_fraction``, ``arrival_deceleration`` (m/s²), ``omega_cap``
///     (rad/s) and ``arrived`` (m).
///
/// Raises
/// ------
/// InvalidInput
///     A point that is not finite, a path without points, or a parameter that is out of range.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> tracker = pr.steering.PathTracker([(0, 0), (2, 0), (2, 2)])
/// >>> tracker.track((0, 0, 0), v_max=0.5, omega_max=2)
/// (0.5, 0.0)
/// >>> tracker.length, tracker.arrived
/// (4.0, False)
#[pyclass(module = "protean_robotics.steering")]
#[derive(Debug)]
pub struct PathTracker {
    tracker: path_tracking::PathTracker,
    params: TrackingParams,
    /// True once the robot has reached the end.
    #[pyo3(get)]
    arrived: bool,
}

#[pymethods]
impl PathTracker {
    #[new]
    #[pyo3(signature = (path, *, params=None))]
    fn new(path: &Bound<'_, PyAny>, params: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let points = arguments::points("path", path)?.points;
        if points.is_empty() {
            return Err(refused("path", "empty", "at least one point (m)"));
        }
        let mut tracker = path_tracking::PathTracker::default();
        tracker.set_path(Path::new(points));
        Ok(Self {
            tracker,
            params: arguments::params(params)?,
            arrived: false,
        })
    }

    /// Command of a tick.
    ///
    /// Parameters
    /// ----------
    /// pose
    ///     Position (m) and heading (rad), shape (3,), or a robot.
    /// v_max
    ///     Maximum forward speed (m/s).
    /// omega_max
    ///     Maximum turning rate (rad/s).
    /// v_reverse_max
    ///     Maximum backward speed (m/s), as a magnitude.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Forward speed (m/s) and turning rate (rad/s), within the limits.
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     An argument is out of range.
    #[pyo3(signature = (pose, *, v_max, omega_max, v_reverse_max=0.0))]
    fn track(
        &mut self,
        pose: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = scalar)] v_max: f64,
        #[pyo3(from_py_with = scalar)] omega_max: f64,
        #[pyo3(from_py_with = scalar)] v_reverse_max: f64,
    ) -> PyResult<(f64, f64)> {
        let limits = Limits::new(v_max, v_reverse_max, omega_max).map_err(invalid)?;
        let pose = arguments::pose("pose", pose)?;
        let tracking = self
            .tracker
            .track(&pose, &limits, &self.params, |_, _| true);
        Ok(tracking.map_or((0.0, 0.0), |tracking| {
            self.arrived = tracking.arrived;
            (tracking.command.v, tracking.command.omega)
        }))
    }

    /// Distance along the path that the robot has covered (m).
    #[getter]
    fn progress(&self) -> f64 {
        self.tracker.progress()
    }

    /// Length of the path (m).
    #[getter]
    fn length(&self) -> f64 {
        self.tracker.path().length()
    }
}
