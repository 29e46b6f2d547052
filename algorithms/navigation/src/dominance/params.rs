//! Parameters of the dominance regions.

use serde::{Deserialize, Serialize};

use sim_backend::params::{ParamsError, positive};

/// How finely dominance is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DominanceParams {
    /// Side of a cell [m], > 0, rounded to whole cells of the map. Cost grows with its inverse
    /// square.
    pub pitch: f64,
}

impl Default for DominanceParams {
    fn default() -> Self {
        Self { pitch: 0.2 }
    }
}

impl DominanceParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("pitch", self.pitch)
    }
}
