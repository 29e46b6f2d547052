//! Parameters of a planner in Python: what the scenario says, unchecked.

use std::sync::Arc;

use parameters::Parameters;
use pyo3::prelude::*;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value as Json;

use super::function::Function;

/// The values of `params` in the scenario, and the function that takes them.
#[derive(Debug, Clone, Default)]
pub struct PythonParams {
    values: Json,
    function: Option<Arc<Py<Function>>>,
}

impl PythonParams {
    /// Returns the parameters of a process.
    pub fn new(values: Json, function: Arc<Py<Function>>) -> Self {
        Self {
            values,
            function: Some(function),
        }
    }

    /// Returns the values.
    pub(super) fn values(&self) -> &Json {
        &self.values
    }

    /// Returns the function; `None` for the default parameters alone.
    pub(super) fn function(&self) -> Option<&Arc<Py<Function>>> {
        self.function.as_ref()
    }
}

impl PartialEq for PythonParams {
    fn eq(&self, other: &Self) -> bool {
        let same = match (&self.function, &other.function) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (None, None) => true,
            _ => false,
        };
        same && self.values == other.values
    }
}

impl Serialize for PythonParams {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.values.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for PythonParams {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Json::deserialize(deserializer)?;
        Ok(Self {
            values,
            function: None,
        })
    }
}

impl JsonSchema for PythonParams {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "PythonParams".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Json::json_schema(generator)
    }
}

impl Parameters for PythonParams {}
