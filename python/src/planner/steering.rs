//! The result of a planner in Python.

use nalgebra::Point2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use python_algorithms::arguments::{row, scalar};

/// Accepted values of a point.
const POINT: &str = "two finite numbers (m)";

/// A command with its reason: what viewers show.
///
/// Parameters
/// ----------
/// v
///     Forward speed (m/s).
/// omega
///     Turning rate (rad/s).
/// target
///     Index of the chased robot.
/// aim
///     Final point (m), shape (2,).
/// waypoint
///     Next point on the way to it (m), shape (2,).
#[pyclass(frozen, get_all, name = "Steering", module = "protean_robotics")]
#[derive(Debug)]
pub struct PySteering {
    /// Forward speed (m/s).
    v: f64,
    /// Turning rate (rad/s).
    omega: f64,
    /// Index of the chased robot.
    target: Option<usize>,
    /// Final point (m).
    aim: Option<[f64; 2]>,
    /// Next point on the way to it (m).
    waypoint: Option<[f64; 2]>,
}

#[pymethods]
impl PySteering {
    #[new]
    #[pyo3(signature = (v, omega, *, target=None, aim=None, waypoint=None))]
    fn new(
        #[pyo3(from_py_with = scalar)] v: f64,
        #[pyo3(from_py_with = scalar)] omega: f64,
        #[pyo3(from_py_with = scalar)] target: Option<usize>,
        aim: Option<&Bound<'_, PyAny>>,
        waypoint: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Ok(Self {
            v,
            omega,
            target,
            aim: aim.map(|aim| row("aim", aim, POINT)).transpose()?,
            waypoint: waypoint.map(|at| row("waypoint", at, POINT)).transpose()?,
        })
    }

    fn __repr__(&self) -> String {
        format!("Steering(v={}, omega={})", self.v, self.omega)
    }
}

/// Command of a tick, as a planner returns it: two numbers, or a [`PySteering`].
#[derive(Debug)]
pub struct Command {
    pub(super) v: f64,
    pub(super) omega: f64,
    pub(super) target: Option<usize>,
    pub(super) aim: Option<Point2<f64>>,
    pub(super) waypoint: Option<Point2<f64>>,
}

impl<'a, 'py> FromPyObject<'a, 'py> for Command {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(steering) = object.cast::<PySteering>() {
            let steering = steering.get();
            return Ok(Self {
                v: steering.v,
                omega: steering.omega,
                target: steering.target,
                aim: steering.aim.map(Point2::from),
                waypoint: steering.waypoint.map(Point2::from),
            });
        }
        let [v, omega] = pair(&object).map_err(|_| {
            let shown = object
                .repr()
                .map_or_else(|_| "?".to_owned(), |text| text.to_string());
            PyTypeError::new_err(format!(
                "the planner returned {shown}: expected (v, omega) in m/s and rad/s, or a Steering"
            ))
        })?;
        Ok(Self {
            v,
            omega,
            target: None,
            aim: None,
            waypoint: None,
        })
    }
}

/// Two numbers of a sequence or an array.
fn pair(object: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    if let Ok((first, second)) = object.extract::<(f64, f64)>() {
        return Ok([first, second]);
    }
    let mut items = object.try_iter()?;
    let mut next = || items.next().transpose();
    match (next()?, next()?, next()?) {
        (Some(first), Some(second), None) => Ok([first.extract()?, second.extract()?]),
        _ => Err(PyTypeError::new_err("expected two numbers")),
    }
}
