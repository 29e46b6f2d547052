//! Protean with a planner that breaks determinism on demand: negative controls of its checks.
//!
//! A check that has never failed proves nothing. `tests/determinism.rs` and `tools/determinism --control` run
//! `mission.toml` with this program and expect the checks to fail, and to name the process.

mod breach;

use std::process::ExitCode;

use breach::Breach;
use planner::geometry::pose::Twist2;
use planner::parameters::Parameters;
use planner::{Planner, PlannerError, PlannerMap, RobotInfo, Steering, View};
use protean::kinds::{KINDS, planner};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

fn main() -> ExitCode {
    protean::main_with([KINDS, &[planner::<Suspect>()]].concat())
}

/// Parameters of [`Suspect`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct SuspectParams {
    /// Source of the turn rate.
    breach: Breach,
}

impl Parameters for SuspectParams {}

/// A planner that drives at a constant speed and turns at a rate that has a reproducible source, or none.
struct Suspect {
    breach: Breach,
}

impl Planner for Suspect {
    const NAME: &'static str = "suspect";
    const SUMMARY: &'static str = "turns at a rate that may not be reproducible";

    type Params = SuspectParams;

    fn new(params: &SuspectParams, _: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            breach: params.breach,
        })
    }

    fn steer(&mut self, _: &PlannerMap, view: &View<'_>) -> Steering {
        Steering {
            command: Twist2 {
                v: 0.1,
                omega: self.breach.turn_rate(view.time_s),
            },
            ..Steering::stop()
        }
    }
}
