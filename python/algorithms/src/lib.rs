//! Algorithms and maps for Python, and the conversion of arguments: the part of the module `_core` that knows no mission.

// Arguments come from Python as values, and doc comments of what it sees are docstrings.
#![allow(
    clippy::needless_pass_by_value,
    clippy::doc_markdown,
    clippy::missing_errors_doc
)]

pub mod arguments;
pub mod coverage;
pub mod error;
pub mod fields;
pub mod followers;
pub mod interpreter;
pub mod interruptible;
pub mod map;
pub mod navigation;
pub mod patrol;
pub mod rrt_star;
pub mod steering;
pub mod tracking;
pub mod trajectory;

use pyo3::prelude::*;

/// Returns the module whose functions draw objects.
pub fn plots(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("protean_robotics._plots")
}
