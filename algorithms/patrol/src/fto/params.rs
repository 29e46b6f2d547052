//! Parameters of the fictive obstacles.

use chaotic_maps::{Key, KeyError};
use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, fraction, positive, require};
use thiserror::Error;

/// Parameters of [`Fto`](super::Fto). The defaults are the paper's where it gives any.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FtoParams {
    /// Key of a generator; the paper's logistic map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<Key>,
    /// Least and greatest time that one is there [s].
    pub active_s: [f64; 2],
    /// Radius of an obstacle [m], > 0.
    pub radius: f64,
    /// Least distance at which one appears, as a share of the way from the robot's edge to the end
    /// of its sensor's reach, 0 to 1.
    pub nearest: f64,
}

impl Default for FtoParams {
    fn default() -> Self {
        Self {
            key: None,
            active_s: [0.3, 2.5],
            radius: 0.15,
            nearest: 0.5,
        }
    }
}

/// Why there are no fictive obstacles.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FtoError {
    /// A parameter out of its range.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// A key that cannot be used.
    #[error("`key`: {0}")]
    Key(#[from] KeyError),
}

impl FtoParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`FtoError`] for the first field that is out of range.
    pub fn validate(&self) -> Result<(), FtoError> {
        if let Some(key) = &self.key {
            key.validate()?;
        }
        let [low, high] = self.active_s;
        require(
            low > 0.0 && low <= high && high.is_finite(),
            "active_s",
            &format!("[{low}, {high}]"),
            "two finite numbers above 0, the greater one last [s]",
        )?;
        positive("radius", self.radius)?;
        fraction("nearest", self.nearest)?;
        Ok(())
    }
}
