//! Exceptions of the package.

use pyo3::create_exception;
use pyo3::exceptions::PyException;

create_exception!(protean_robotics, Error, PyException, "Failure of Protean.");
create_exception!(
    protean_robotics,
    InvalidInput,
    Error,
    "Scenario, file or argument that is invalid; the text names the field, the value and what is expected."
);
