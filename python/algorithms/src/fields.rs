//! Potential fields and feedback linearisation.

use avoidance::potential_field::{self, Goal, RepulsionParams, Repulsor};
use control::feedback_linearisation::{self, FeedbackParams};
use nalgebra::{Point2, Vector2};
use navigation::bearing::Bearings;
use parameters::Fidelity;
use planner_view::limits::Limits;
use pyo3::prelude::*;

use crate::arguments::{self, invalid, scalar};
use crate::interruptible::each;
use crate::map::Map;

/// Attraction of goals: a field of velocities.
///
/// The weighted sum of the unit vectors towards the goals gives the direction, the magnitude is 2 m/s; goals nearer
/// than 1 mm do not count. (Chasing-game paper, section III.A.)
///
/// Parameters
/// ----------
/// points
///     Points at which the field is evaluated (m), shape (2,) or (n, 2), or a robot.
/// goals
///     Goals (m), shape (2,) or (k, 2), or a robot.
/// weights
///     Weights ≥ 0 of the goals, shape (k,); equal if absent.
///
/// Returns
/// -------
/// ndarray
///     Velocities (m/s), of the shape of the points.
///
/// Raises
/// ------
/// InvalidInput
///     A number that is not finite, or a shape that does not fit.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> pr.steering.attraction((0, 0), [(3, 0)]).tolist()
/// [2.0, 0.0]
#[pyfunction]
#[pyo3(signature = (points, goals, weights=None))]
pub fn attraction<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    goals: &Bound<'py, PyAny>,
    weights: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let goals = weighted(arguments::goals("goals", goals)?, weights)?;
    let field = |at: Point2<f64>| {
        let goals = goals.iter().map(|&(at, weight)| Goal { at, weight });
        potential_field::attraction(at, goals, &Bearings::Straight)
    };
    at_points(py, points, field)
}

/// Repulsion from other robots: a field of velocities.
///
/// Each robot pushes away, turned slightly to the side; the sum saturates with a tanh. (Chasing-game paper,
/// section III.A.)
///
/// Parameters
/// ----------
/// points
///     Points at which the field is evaluated (m), shape (2,) or (n, 2), or a robot.
/// robots
///     Positions of the other robots (m), shape (2,) or (k, 2), or a robot.
/// weights
///     Weights ≥ 0 of the robots, shape (k,); equal if absent.
/// params
///     Other values than the defaults of ``falloff`` ("inverse_square" or "plateau"), ``reach`` (m), ``speed`` (m/s) and
///     ``fidelity`` ("ours" or "published").
///
/// Returns
/// -------
/// ndarray
///     Velocities (m/s), of the shape of the points; at most ``speed`` in magnitude.
///
/// Raises
/// ------
/// InvalidInput
///     A number that is not finite, a shape that does not fit, or a parameter that is out of range.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> push = pr.steering.repulsion([(1, 0), (4, 0)], (0, 0))
/// >>> bool(push[0, 0] > push[1, 0] > 0)
/// True
#[pyfunction]
#[pyo3(signature = (points, robots, weights=None, *, params=None))]
pub fn repulsion<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    robots: &Bound<'py, PyAny>,
    weights: Option<&Bound<'py, PyAny>>,
    params: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let params: RepulsionParams = arguments::params(params)?;
    let robots = weighted(arguments::robots("robots", robots)?, weights)?;
    let field = |at: Point2<f64>| {
        let robots = robots.iter().map(|&(at, weight)| Repulsor { at, weight });
        potential_field::repulsion(at, robots, &Bearings::Straight, &params)
    };
    at_points(py, points, field)
}

/// Push of the obstacles of a map: a field of velocities along the gradient of the blurred free space.
///
/// (Chasing-game paper, section III.B.)
///
/// Parameters
/// ----------
/// map
///     The map.
/// points
///     Points at which the field is evaluated (m), shape (2,) or (n, 2), or a robot.
/// published
///     True for the gradient of the published program, which is constant within a cell and 0 in obstacles.
///
/// Returns
/// -------
/// ndarray
///     Velocities (m/s), of the shape of the points; zero outside the map.
///
/// Raises
/// ------
/// InvalidInput
///     A number that is not finite, or a shape that does not fit.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> blocked = np.zeros((20, 40), dtype=bool)
/// >>> blocked[:, 0] = True
/// >>> map = pr.Map.from_grid(blocked, 0.1)
/// >>> bool(pr.steering.obstacle_push(map, (0.2, 1.0))[0] > 0)
/// True
#[pyfunction]
#[pyo3(signature = (map, points, *, published=false))]
pub fn obstacle_push<'py>(
    py: Python<'py>,
    map: &Map,
    points: &Bound<'py, PyAny>,
    published: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let fidelity = if published {
        Fidelity::Published
    } else {
        Fidelity::Ours
    };
    at_points(py, points, |at| {
        potential_field::obstacle(&map.map, at, fidelity)
    })
}

/// Command that moves the point 0.15 m ahead of a robot's axle with a desired velocity: feedback linearisation.
///
/// With u = vx cos θ + vy sin θ and ω = (−vx sin θ + vy cos θ) / ε the point at the distance ε ahead of the axle moves
/// with the velocity (vx, vy). (Chasing-game paper, section I-A.)
///
/// Parameters
/// ----------
/// velocity
///     Desired velocity (m/s), shape (2,), in the frame of the world.
/// heading
///     Heading of the robot (rad).
/// v_max
///     Maximum forward speed (m/s).
/// omega_max
///     Maximum turning rate (rad/s).
/// v_reverse_max
///     Maximum backward speed (m/s), as a magnitude; at most a tenth of the forward one is used.
/// params
///     Other values than the defaults of ``fidelity`` ("ours" or "published") and ``omega_cap`` (rad/s).
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
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> pr.steering.linearise((0.2, 0.0), 0.0, v_max=0.5, omega_max=2)
/// (0.2, 0.0)
#[pyfunction]
#[pyo3(signature = (velocity, heading, *, v_max, omega_max, v_reverse_max=0.0, params=None))]
pub fn linearise(
    velocity: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = scalar)] heading: f64,
    #[pyo3(from_py_with = scalar)] v_max: f64,
    #[pyo3(from_py_with = scalar)] omega_max: f64,
    #[pyo3(from_py_with = scalar)] v_reverse_max: f64,
    params: Option<&Bound<'_, PyAny>>,
) -> PyResult<(f64, f64)> {
    let limits = Limits::new(v_max, v_reverse_max, omega_max).map_err(invalid)?;
    let [x, y] = arguments::row("velocity", velocity, "two finite numbers (m/s)")?;
    arguments::finite("heading", heading)?;
    let params: FeedbackParams = arguments::params(params)?;
    let wanted = Vector2::new(x, y);
    let command = feedback_linearisation::command(wanted, heading, &limits, &params);
    Ok((command.v, command.omega))
}

/// Points with weights; equal ones without `weights`.
fn weighted(
    points: Vec<Point2<f64>>,
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<(Point2<f64>, f64)>> {
    let weights = arguments::per_row("weights", weights, points.len(), 1.0)?;
    for &weight in &weights {
        arguments::not_negative("weights", weight)?;
    }
    Ok(points.into_iter().zip(weights).collect())
}

/// A field at each point.
fn at_points<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    field: impl Fn(Point2<f64>) -> Vector2<f64> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let points = arguments::points("points", points)?;
    let vectors = each(py, &points.points, |&at| field(at))?;
    arguments::vector_per_point(py, points.is_single, &vectors)
}
