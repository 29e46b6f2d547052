//! Parameters of the pursuit of intruders.

use parameters::{Parameters, at_least};
use pursuit_evasion::pursuit::PursuerParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of pursuits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PursueParams {
    /// Time without a sighting after which an intruder is lost, and its guard returns to the patrol.
    #[schemars(transform = at_least(0).unit("s"))]
    pub lost_s: f64,
    /// Tactics of a guard in pursuit.
    pub tactics: PursuerParams,
}

impl Default for PursueParams {
    fn default() -> Self {
        Self {
            lost_s: 10.0,
            tactics: PursuerParams::default(),
        }
    }
}

impl Parameters for PursueParams {}
