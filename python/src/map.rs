//! The map of a planner.

use std::sync::Arc;

use planner_view::map::PlannerMap;
use pyo3::prelude::*;

/// A map with its clearances and exact pieces.
#[pyclass(frozen, module = "protean_robotics")]
#[derive(Debug)]
pub struct Map {
    /// The map.
    pub map: Arc<PlannerMap>,
}

#[pymethods]
impl Map {
    /// Number that changes with every obstacle.
    #[getter]
    fn revision(&self) -> u64 {
        self.map.revision()
    }
}
