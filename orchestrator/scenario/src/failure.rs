//! Reaction of a run to the failure of one of its processes: keys of `[[processes]]`.

use config::{Code, FieldPath, Node};
use parameters::Parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::context::Context;
use super::spec::{Mode, OnFailure, ProcessBlock, RunSpec, ready_timeout};

/// Supervision of a process.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Supervision {
    /// Reaction to a failure of the process.
    pub on_failure: OnFailure,
    /// Real time within which it must become ready, at the start and after every restart.
    #[schemars(transform = ready_timeout())]
    pub ready_timeout_s: f64,
}

impl Parameters for Supervision {}

impl Default for Supervision {
    fn default() -> Self {
        Self {
            on_failure: OnFailure::default(),
            ready_timeout_s: RunSpec::default().ready_timeout_s,
        }
    }
}

/// Reads the supervision of a process and reports all problems.
pub(super) fn read(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
    run: &RunSpec,
) -> Option<Supervision> {
    let supervision = Supervision {
        on_failure: block.on_failure.unwrap_or_default(),
        ready_timeout_s: block.ready_timeout_s.unwrap_or(run.ready_timeout_s),
    };
    let before = ctx.problems.len();
    ctx.check(node, path, &supervision);
    if supervision.on_failure == OnFailure::Restart && run.mode == Mode::LockStep {
        let field = "on_failure";
        let message = "lock-step mode cannot restart a process";
        ctx.problems.push(
            ctx.problem(node, path, field, Code::Requirement, message)
                .expected("\"abort\" or \"continue\", or run.mode = \"real_time\""),
        );
    }
    (ctx.problems.len() == before).then_some(supervision)
}
