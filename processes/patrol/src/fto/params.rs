//! Parameters of the fictive obstacles.

use generators::{Key, KeyError};
use guidance::params::{ParamsError, fraction, not_negative, positive, require};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Parameters of [`Fto`](super::Fto). The defaults are the paper's where it gives any.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FtoParams {
    /// First value of the logistic map, between 0 and 1.
    pub z0: f64,
    /// Parameter of the logistic map, 3.57 (below which it settles down) to 4.
    pub r: f64,
    /// Key of another generator; the logistic map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<Key>,
    /// Least and greatest time without an obstacle [s].
    pub gap_s: [f64; 2],
    /// Least and greatest time that one is there [s].
    pub active_s: [f64; 2],
    /// Radius of an obstacle [m], > 0.
    pub radius: f64,
    /// Least distance at which one appears, as a share of the way from the robot's edge to the end
    /// of its sensor's reach, 0 to 1.
    pub nearest: f64,
    /// Kept free between an obstacle and the robot's body when it stands on its goal [m], ≥ 0.
    pub goal_gap: f64,
}

impl Default for FtoParams {
    fn default() -> Self {
        Self {
            z0: 0.18,
            r: 3.99,
            key: None,
            gap_s: [2.0, 20.0],
            active_s: [0.3, 2.5],
            radius: 0.15,
            nearest: 0.5,
            goal_gap: 0.1,
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
        let z = self.z0;
        // Values that the map sends to 0 or leaves where they are.
        let fixed = [0.5, 0.75, 0.25].contains(&z) || (z - (1.0 - 1.0 / self.r)).abs() < 1e-9;
        require(
            z > 0.0 && z < 1.0 && !fixed,
            "z0",
            &z,
            "a number between 0 and 1 that the logistic map does not leave where it is (not 0.25, \
             0.5, 0.75 or 1 - 1/r)",
        )?;
        require(
            (3.57..=4.0).contains(&self.r),
            "r",
            &self.r,
            "a number from 3.57 to 4",
        )?;
        if let Some(key) = &self.key {
            key.validate()?;
        }
        for (field, [low, high]) in [("gap_s", self.gap_s), ("active_s", self.active_s)] {
            require(
                low > 0.0 && low <= high && high.is_finite(),
                field,
                &format!("[{low}, {high}]"),
                "two finite numbers above 0, the greater one last [s]",
            )?;
        }
        positive("radius", self.radius)?;
        fraction("nearest", self.nearest)?;
        not_negative("goal_gap", self.goal_gap)?;
        Ok(())
    }
}
