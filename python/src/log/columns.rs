//! Columns of a topic as NumPy arrays, moved there without a copy.

use numpy::{Element, IntoPyArray as _, PyArrayMethods as _};
use pyo3::prelude::*;
use tables::{ColumnValues, Values};

/// A column of a table.
///
/// Attributes
/// ----------
/// name : str
///     Its name.
/// values : numpy.ndarray
///     One value for each row, read-only; of texts, their indices in `texts`.
/// texts : list of str or None
///     The different texts; None unless it is a column of texts.
/// empty : numpy.ndarray or None
///     True for each row without a value; None if every row has one.
#[pyclass(frozen, get_all, module = "protean_robotics")]
#[derive(Debug)]
pub struct Column {
    name: String,
    values: Py<PyAny>,
    texts: Option<Vec<String>>,
    empty: Option<Py<PyAny>>,
}

impl Column {
    /// Takes a column over.
    pub fn new(py: Python<'_>, column: ColumnValues) -> Self {
        let mut texts = None;
        let values = match column.values {
            Values::Bool(values) => array(py, values),
            Values::Int(values) => array(py, values),
            Values::UInt(values) => array(py, values),
            Values::F32(values) => array(py, values),
            Values::F64(values) => array(py, values),
            Values::Text(found) => {
                texts = Some(found.distinct);
                array(py, found.codes)
            }
        };
        Self {
            name: column.name,
            values,
            texts,
            empty: column.empty.map(|empty| array(py, empty)),
        }
    }
}

/// Returns a read-only array that owns the values.
fn array<T: Element>(py: Python<'_>, values: Vec<T>) -> Py<PyAny> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array.into_any().unbind()
}
