//! Fidelity of a method to its publication.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Traits of a published program that are not part of its method: errors, and consequences of its
/// simulator's grid and tick rate. `docs/explanation/deviations.md` lists them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// The method without these traits.
    #[default]
    Ours,
    /// The method as in the published program.
    Published,
}

impl Fidelity {
    /// Returns `true` for the published program's traits.
    pub fn is_published(self) -> bool {
        self == Self::Published
    }
}
