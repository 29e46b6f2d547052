//! How close to its publication a method is computed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Traits of a published program that are not part of its method: slips, and consequences of its
/// simulator's grid and tick rate. `docs/explanation/deviations.md` lists them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// The method without them.
    #[default]
    Ours,
    /// As the published program does it.
    Published,
}

impl Fidelity {
    /// Whether the published program's traits are wanted.
    pub fn is_published(self) -> bool {
        self == Self::Published
    }
}
