//! Parameters of the simulator.

use serde::{Deserialize, Serialize};
use sim_backend::spec::WorldSpec;

use crate::event_schedule::PlannedChange;

/// Parameters of the simulator process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulatorParams {
    /// The world: map, robots, rules, seed.
    pub world: WorldSpec,
    /// Standard deviation of the blur of the published map (m).
    pub blur_sigma: f64,
    /// Index of the driving process of every robot; `None`: no driver, it stands.
    pub drivers: Vec<Option<u32>>,
    /// Number of ticks after its own for which a command of every robot counts, beyond the general one: its driver steps in
    /// some ticks only, or its commands come late.
    pub holds: Vec<u64>,
    /// Changes of the obstacles that depend on robots or on each other, in their order. (Changes at
    /// a fixed time arrive over their topic.)
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub event_schedule: Vec<PlannedChange>,
}
