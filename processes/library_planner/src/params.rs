//! The parameters of a process in a library.

use parameters::Parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use crate::library::Library;

/// Parameters as written, which the library checks, and the library.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LibraryParams {
    #[serde(flatten)]
    pub(crate) values: Map<String, Json>,
    #[serde(skip)]
    pub(crate) library: Option<Library>,
}

impl LibraryParams {
    /// Returns the parameters of a process of this library: the values of a JSON object.
    pub fn new(values: &Json, library: Library) -> Self {
        Self {
            values: values.as_object().cloned().unwrap_or_default(),
            library: Some(library),
        }
    }
}

impl Parameters for LibraryParams {}
