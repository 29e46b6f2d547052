//! How far a robot must have come for something to happen.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What must be true of a robot.
///
/// In TOML the keys of one variant: `{ travelled = 1.5 }`, `{ progress = 0.36 }` or
/// `{ within = 0.8, of = [2.0, 3.0] }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub enum Condition {
    /// Its centre has covered a way.
    Travelled {
        /// Length of the way (m).
        travelled: f64,
    },
    /// It has come nearer to its goal.
    Progress {
        /// Share of the straight distance from its start to the centre of its goal.
        progress: f64,
    },
    /// Its centre is near a point.
    Within {
        /// Largest distance (m).
        within: f64,
        /// The point, x and y (m).
        of: [f64; 2],
    },
}
