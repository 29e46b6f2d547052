//! Conditions on a robot's progress.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Condition on a robot.
///
/// In TOML the keys of one variant: `{ travelled = 1.5 }`, `{ progress = 0.36 }` or
/// `{ within = 0.8, of = [2.0, 3.0] }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub enum Condition {
    /// Its centre has travelled a distance.
    Travelled {
        /// Length of the path (m).
        travelled: f64,
    },
    /// It has approached its goal.
    Progress {
        /// Share of the straight distance from its start to the centre of its goal.
        progress: f64,
    },
    /// Its centre is near a point.
    Within {
        /// Maximum distance (m).
        within: f64,
        /// The point, x and y (m).
        of: [f64; 2],
    },
}
