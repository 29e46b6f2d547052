//! Arguments from Python: arrays of points and poses, parameters. All numbers must be finite.

use core::fmt::Display;
use std::path::PathBuf;

use chaotic_maps::{Key, KeyKind};
use control::path_tracking::Path;
use geometry::map::MAX_EXITS;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use numpy::ndarray::ArrayViewD;
use numpy::{
    AllowTypeChange, IntoPyArray as _, PyArrayLikeDyn, PyArrayMethods as _,
    PyUntypedArrayMethods as _,
};
use numpy::{PyArray1, PyArray2, PyUntypedArray};
use parameters::{Parameters, ParamsError, check};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};
use scenario::spec::MAX_ROBOTS;

use crate::error::InvalidInput;

/// Maximum number of characters of a value in an error.
const MAX_SHOWN: usize = 60;

/// Returns the exception for an argument, with its value and what is expected.
pub fn refused(name: &str, value: &(impl Display + ?Sized), expected: &str) -> PyErr {
    invalid(ParamsError::new(name, value, expected))
}

/// Returns the exception for invalid input.
pub fn invalid(error: impl Display) -> PyErr {
    InvalidInput::new_err(error.to_string())
}

fn refused_object(name: &str, value: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    refused(name, &shown(value), expected)
}

/// Returns the fault of an argument that could not be read, or Ctrl-C.
fn unless_interrupted(
    value: &Bound<'_, PyAny>,
    error: impl Into<PyErr>,
    fault: impl FnOnce() -> PyErr,
) -> PyErr {
    let error = error.into();
    if error.is_instance_of::<PyKeyboardInterrupt>(value.py()) {
        error
    } else {
        fault()
    }
}

fn shown(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map(|text| text.to_string());
    let mut text = text.unwrap_or_else(|_| "without a text".to_owned());
    if text.chars().count() > MAX_SHOWN {
        text = text.chars().take(MAX_SHOWN).chain(['…']).collect();
    }
    text
}

/// Reads a plain value. PyO3 adds the name of the argument to the exception as a note.
///
/// # Errors
/// The exception has the value and what is expected.
pub fn scalar<'py, T>(value: &Bound<'py, PyAny>) -> PyResult<T>
where
    T: ScalarValue + FromPyObjectOwned<'py>,
{
    let fault = || invalid(format!("{}: expected {}", shown(value), T::EXPECTED));
    value
        .extract()
        .map_err(|error| unless_interrupted(value, error, fault))
}

/// Values that [`scalar`] reads.
pub trait ScalarValue {
    /// Accepted values.
    const EXPECTED: &'static str;
}

impl ScalarValue for f64 {
    const EXPECTED: &'static str = "a number";
}

impl ScalarValue for u32 {
    const EXPECTED: &'static str = "a whole number from 0 to 2^32 - 1";
}

impl ScalarValue for u64 {
    const EXPECTED: &'static str = "a whole number from 0 to 2^64 - 1";
}

impl ScalarValue for PathBuf {
    const EXPECTED: &'static str = "a path or a name";
}

impl ScalarValue for usize {
    const EXPECTED: &'static str = u64::EXPECTED;
}

impl<T: ScalarValue> ScalarValue for Option<T> {
    const EXPECTED: &'static str = T::EXPECTED;
}

/// Numbers in an array, with its shape.
struct Numbers<'py> {
    array: PyArrayLikeDyn<'py, f64, AllowTypeChange>,
}

impl<'py> Numbers<'py> {
    /// Reads numbers that must be finite.
    fn from_value(name: &str, value: &Bound<'py, PyAny>, expected: &str) -> PyResult<Self> {
        let numbers = Self::read(name, value, expected)?;
        if numbers.view().iter().all(|x| x.is_finite()) {
            Ok(numbers)
        } else {
            Err(refused_object(name, value, expected))
        }
    }

    fn read(name: &str, value: &Bound<'py, PyAny>, expected: &str) -> PyResult<Self> {
        let fault = || refused_object(name, value, expected);
        // NumPy reads text as numbers.
        if value.is_none() || value.is_instance_of::<PyString>() {
            return Err(fault());
        }
        let mut array: PyArrayLikeDyn<'py, f64, AllowTypeChange> = value
            .extract()
            .map_err(|error| unless_interrupted(value, error, fault))?;
        if !array.is_aligned() {
            let copy = value.call_method0("copy");
            let copied = copy.and_then(|copy| copy.extract());
            array = copied.map_err(|error| unless_interrupted(value, error, fault))?;
        }
        Ok(Self { array })
    }

    /// The numbers in one dimension; `None` for another shape.
    fn list(&self) -> Option<Vec<f64>> {
        let view = self.view();
        (view.ndim() == 1).then(|| view.iter().copied().collect())
    }

    fn view(&self) -> ArrayViewD<'_, f64> {
        self.array.as_array()
    }

    /// The rows of an array of shape (n, `N`); `None` for another shape.
    fn rows<const N: usize>(&self) -> Option<Vec<[f64; N]>> {
        let view = self.view();
        match *view.shape() {
            [n, columns] if columns == N => Some(
                (0..n)
                    .map(|i| core::array::from_fn(|j| view[[i, j]]))
                    .collect(),
            ),
            // An empty list has no columns.
            [0] => Some(Vec::new()),
            _ => None,
        }
    }

    /// The numbers of an array of shape (`N`,); `None` for another shape.
    fn row<const N: usize>(&self) -> Option<[f64; N]> {
        let view = self.view();
        (*view.shape() == [N]).then(|| core::array::from_fn(|i| view[[i]]))
    }
}

/// Returns an attribute of an object, if it has it; arrays, tuples and lists have none, which takes no look-up.
pub fn attribute<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let is_plain = value.is_instance_of::<PyUntypedArray>()
        || value.is_instance_of::<PyTuple>()
        || value.is_instance_of::<PyList>();
    if is_plain {
        return Ok(None);
    }
    value.getattr_opt(name)
}

/// Returns a point (m) of shape (2,), or the position of a robot.
pub fn point(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Point2<f64>> {
    let expected = "two finite numbers (m), or a robot";
    let position = attribute(value, "position")?;
    let value = position.as_ref().unwrap_or(value);
    let numbers = Numbers::from_value(name, value, expected)?;
    numbers
        .row::<2>()
        .map(Point2::from)
        .ok_or_else(|| refused_object(name, value, expected))
}

/// Points of an argument.
pub struct Points {
    /// The points (m).
    pub points: Vec<Point2<f64>>,
    /// `true` if the argument is one point and not an array of points.
    pub is_single: bool,
}

/// Checks the length of an argument against a limit of the program.
///
/// # Errors
/// The exception names argument, length and limit.
pub fn at_most(name: &str, count: usize, limit: usize) -> PyResult<()> {
    if count <= limit {
        return Ok(());
    }
    let found = format!("an array of {count}");
    Err(refused(name, &found, &format!("at most {limit}")))
}

/// Returns as many points as a scenario has robots at most, as [`points`] does.
pub fn robots(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Point2<f64>>> {
    let points = points(name, value)?.points;
    at_most(name, points.len(), MAX_ROBOTS)?;
    Ok(points)
}

/// Returns as many points as a map has exits at most, as [`points`] does.
pub fn goals(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Point2<f64>>> {
    let points = points(name, value)?.points;
    at_most(name, points.len(), MAX_EXITS)?;
    Ok(points)
}

/// Returns points (m) of shape (2,) or (n, 2), or the position of a robot.
pub fn points(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Points> {
    let expected = "an array of finite numbers (m) of shape (2,) or (n, 2)";
    let position = attribute(value, "position")?;
    let value = position.as_ref().unwrap_or(value);
    let numbers = Numbers::from_value(name, value, expected)?;
    if let Some(point) = numbers.row::<2>() {
        return Ok(Points {
            points: vec![Point2::from(point)],
            is_single: true,
        });
    }
    let rows = numbers.rows::<2>();
    let rows = rows.ok_or_else(|| refused_object(name, value, expected))?;
    Ok(Points {
        points: rows.into_iter().map(Point2::from).collect(),
        is_single: false,
    })
}

/// Returns rows of `N` finite numbers from an array of shape (n, `N`).
pub fn rows<const N: usize>(
    name: &str,
    value: &Bound<'_, PyAny>,
    expected: &str,
) -> PyResult<Vec<[f64; N]>> {
    let rows = Numbers::from_value(name, value, expected)?.rows::<N>();
    rows.ok_or_else(|| refused_object(name, value, expected))
}

/// Returns finite numbers from an array of shape (n,).
pub fn list(name: &str, value: &Bound<'_, PyAny>, expected: &str) -> PyResult<Vec<f64>> {
    let numbers = Numbers::from_value(name, value, expected)?;
    let list = numbers.list();
    list.ok_or_else(|| refused_object(name, value, expected))
}

/// Returns numbers, also infinite ones, from an array of shape (n,).
pub fn list_with_infinity(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let expected = "numbers (m) of shape (n,), infinity without an echo";
    let list = Numbers::read(name, value, expected)?.list();
    list.filter(|list| !list.iter().any(|x| x.is_nan()))
        .ok_or_else(|| refused_object(name, value, expected))
}

/// Returns one finite number for each of `count` rows; `default` without a value.
pub fn per_row(
    name: &str,
    value: Option<&Bound<'_, PyAny>>,
    count: usize,
    default: f64,
) -> PyResult<Vec<f64>> {
    let Some(value) = value else {
        return Ok(vec![default; count]);
    };
    let expected = format!("{count} finite numbers, shape ({count},)");
    let list = list(name, value, &expected)?;
    if list.len() == count {
        Ok(list)
    } else {
        Err(refused_object(name, value, &expected))
    }
}

/// Returns `N` finite numbers from an array of shape (`N`,).
pub fn row<const N: usize>(
    name: &str,
    value: &Bound<'_, PyAny>,
    expected: &str,
) -> PyResult<[f64; N]> {
    let row = Numbers::from_value(name, value, expected)?.row::<N>();
    row.ok_or_else(|| refused_object(name, value, expected))
}

/// Returns a pose (m, m, rad) of shape (3,), or that of a robot.
pub fn pose(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Pose2> {
    let own = attribute(value, "pose")?;
    let value = own.as_ref().unwrap_or(value);
    let [x, y, theta] = row(name, value, "x (m), y (m) and heading (rad), or a robot")?;
    Ok(Pose2::new(x, y, theta))
}

/// Target of a drive.
#[derive(Debug, Clone)]
pub enum Target {
    /// A point (m).
    Point(Point2<f64>),
    /// A path; a stop if it is empty.
    Path(Path),
}

/// Returns the target of a drive: a point of shape (2,), a path of shape (n, 2), or a robot.
pub fn target(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Target> {
    let Points { points, is_single } = points(name, value)?;
    Ok(match points[..] {
        [point] if is_single => Target::Point(point),
        _ => Target::Path(Path::new(points)),
    })
}

/// Returns parameters from a mapping of their names; the defaults without one.
pub fn params<P: Parameters + Default>(value: Option<&Bound<'_, PyAny>>) -> PyResult<P> {
    let Some(value) = value else {
        return Ok(P::default());
    };
    let params: P = serde_json::from_str(&json("params", value)?).map_err(|error| {
        // The place in a text that the caller has not written is of no use.
        let error = error.to_string();
        let fault = error.split(" at line ").next().unwrap_or_default();
        InvalidInput::new_err(format!("params: {fault}"))
    })?;
    check(&params).map_err(invalid)?;
    Ok(params)
}

/// Returns a mapping as JSON.
pub fn json(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let json = value.py().import("json")?;
    let values = value.cast::<PyDict>().map_err(PyErr::from);
    let text = values.and_then(|values| json.call_method1("dumps", (values,)));
    let text = text.and_then(|text| text.extract::<String>());
    text.map_err(|_| refused_object(name, value, "a mapping of names to plain values"))
}

/// Returns a key from its text, or one of this kind from the seed.
pub fn key(text: Option<&str>, kind: KeyKind, seed: u64) -> PyResult<Key> {
    match text {
        Some(text) => text
            .parse()
            .map_err(|error| InvalidInput::new_err(format!("`key`: {error}"))),
        None => Ok(Key::from_seed(kind, seed)),
    }
}

/// Returns points as an array of shape (n, 2).
pub fn array_of_points<'py>(
    py: Python<'py>,
    points: &[Point2<f64>],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    array_of_rows(py, points.iter().map(|p| [p.x, p.y]))
}

/// Returns rows of `N` numbers as an array of shape (n, `N`).
pub fn array_of_rows<T: numpy::Element, const N: usize>(
    py: Python<'_>,
    rows: impl Iterator<Item = [T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let flat: Vec<T> = rows.flatten().collect();
    let n = flat.len() / N.max(1);
    flat.into_pyarray(py).reshape([n, N])
}

/// Returns one number for each point: a number for a single point, an array of shape (n,) for several.
pub fn per_point<'py, T>(
    py: Python<'py>,
    is_single: bool,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyAny>>
where
    T: numpy::Element,
{
    let array: Bound<'py, PyArray1<T>> = values.into_pyarray(py);
    if is_single {
        array.get_item(0)?.call_method0("item")
    } else {
        Ok(array.into_any())
    }
}

/// Returns a vector for each point, in the shape of the points.
pub fn vector_per_point<'py>(
    py: Python<'py>,
    is_single: bool,
    vectors: &[Vector2<f64>],
) -> PyResult<Bound<'py, PyAny>> {
    let rows = array_of_rows(py, vectors.iter().map(|v| [v.x, v.y]))?;
    if is_single {
        rows.get_item(0)
    } else {
        Ok(rows.into_any())
    }
}

/// Checks a number that must be finite and at least 0.
///
/// # Errors
/// The exception names it.
pub fn not_negative(name: &str, value: f64) -> PyResult<()> {
    parameters::not_negative(name, value).map_err(invalid)
}

/// Checks a number that must be finite.
///
/// # Errors
/// The exception names it.
pub fn finite(name: &str, value: f64) -> PyResult<()> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(refused(name, &value, "a finite number"))
    }
}

/// Checks a number that must be finite and above 0.
///
/// # Errors
/// The exception names it.
pub fn positive(name: &str, value: f64) -> PyResult<()> {
    parameters::positive(name, value).map_err(invalid)
}
