//! Exceptions of the package.

use pyo3::import_exception;

import_exception!(protean_robotics._errors, Error);
import_exception!(protean_robotics._errors, InvalidInput);
