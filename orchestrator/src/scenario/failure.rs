//! What becomes of a run when one of its processes fails: keys of `[[processes]]`.

use serde::{Deserialize, Serialize};

use super::context::Context;
use super::spec::{ProcessBlock, RunSpec};
use super::text::{Code, FieldPath, Node};

/// What happens when a process exits, is killed, breaks the protocol or no longer answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnFailure {
    /// The run ends, and fails.
    #[default]
    AbortRun,
    /// It is started again and rejoins the run; its robots stand still meanwhile.
    Restart,
    /// The run goes on; the robots that it drove stand still.
    StopRobot,
    /// The run goes on without it: for processes that drive no robot.
    GoOn,
}

impl OnFailure {
    /// As the scenario writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::AbortRun => "abort_run",
            Self::Restart => "restart",
            Self::StopRobot => "stop_robot",
            Self::GoOn => "go_on",
        }
    }
}

/// `restart = { … }`: how a process that failed is started again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RestartSpec {
    /// Restarts in one run, 0 to 1 000 000; the next failure is dealt with by `then`.
    pub limit: u32,
    /// Simulated time [s] between the first failure and the return, 0 to 3600.
    pub backoff_s: f64,
    /// What the time is multiplied by after every further failure, 1 to 100.
    pub backoff_factor: f64,
    /// What the time never exceeds [simulated s], 0 to 3600.
    pub backoff_max_s: f64,
    /// What happens at the failure after the last restart.
    pub then: OnFailure,
}

impl Default for RestartSpec {
    fn default() -> Self {
        Self {
            limit: 5,
            backoff_s: 0.5,
            backoff_factor: 2.0,
            backoff_max_s: 10.0,
            then: OnFailure::AbortRun,
        }
    }
}

impl RestartSpec {
    /// Simulated time that the process stays away after its failure number `failure` (from 0) [s].
    pub fn backoff(&self, failure: u32) -> f64 {
        let exponent = i32::try_from(failure).unwrap_or(i32::MAX);
        (self.backoff_s * self.backoff_factor.powi(exponent)).min(self.backoff_max_s)
    }
}

/// How a process is looked after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Supervision {
    /// What happens when it fails.
    pub on_failure: OnFailure,
    /// How it is started again, if it is.
    pub restart: RestartSpec,
    /// Real time that it has to become ready, at the start and after every restart [s].
    pub ready_timeout_s: f64,
}

impl Default for Supervision {
    fn default() -> Self {
        Self {
            on_failure: OnFailure::default(),
            restart: RestartSpec::default(),
            ready_timeout_s: RunSpec::default().ready_timeout_s,
        }
    }
}

/// Reads how a process is looked after; `drives`: whether it drives a robot. Everything wrong is
/// reported.
pub(super) fn read(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    block: &ProcessBlock,
    drives: bool,
    run: &RunSpec,
) -> Option<Supervision> {
    let supervision = Supervision {
        on_failure: block.on_failure.unwrap_or_default(),
        restart: block.restart.unwrap_or_default(),
        ready_timeout_s: block.ready_timeout_s.unwrap_or(run.ready_timeout_s),
    };
    let before = ctx.problems.len();
    let restart = &supervision.restart;
    for (field, value, low, high) in [
        ("ready_timeout_s", supervision.ready_timeout_s, 0.1, 3600.0),
        ("restart.limit", f64::from(restart.limit), 0.0, 1e6),
        ("restart.backoff_s", restart.backoff_s, 0.0, 3600.0),
        ("restart.backoff_factor", restart.backoff_factor, 1.0, 100.0),
        ("restart.backoff_max_s", restart.backoff_max_s, 0.0, 3600.0),
    ] {
        if !(low..=high).contains(&value) {
            let message = format!("`{field}` is out of range");
            let problem = ctx
                .problem(node, path, field, Code::OutOfRange, message)
                .value(value)
                .expected(format!("a number from {low} to {high}"));
            ctx.problems.push(problem);
        }
    }
    if block.restart.is_some() && supervision.on_failure != OnFailure::Restart {
        let name = supervision.on_failure.name();
        let message = format!("`restart` says how, but on_failure is \"{name}\"");
        let problem = ctx
            .problem(node, path, "restart", Code::Requirement, message)
            .expected("on_failure = \"restart\", or no `restart`");
        ctx.problems.push(problem);
    }
    if restart.then == OnFailure::Restart {
        let message = "what comes after the last restart cannot be a restart";
        let problem = ctx
            .problem(node, path, "restart.then", Code::Requirement, message)
            .expected("then = \"abort_run\", \"stop_robot\" or \"go_on\"");
        ctx.problems.push(problem);
    }
    check_fit(
        ctx,
        node,
        path,
        "on_failure",
        supervision.on_failure,
        drives,
    );
    check_fit(ctx, node, path, "restart.then", restart.then, drives);
    (ctx.problems.len() == before).then_some(supervision)
}

/// Only who drives robots leaves some standing, and nobody goes on without saying so.
fn check_fit(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    field: &str,
    on_failure: OnFailure,
    drives: bool,
) {
    let (message, expected) = match (on_failure, drives) {
        (OnFailure::StopRobot, false) => (
            "\"stop_robot\", but this process drives no robot",
            OnFailure::GoOn,
        ),
        (OnFailure::GoOn, true) => (
            "\"go_on\", but without this process its robots cannot go on",
            OnFailure::StopRobot,
        ),
        _ => return,
    };
    let problem = ctx
        .problem(node, path, field, Code::Requirement, message)
        .expected(format!(
            "\"abort_run\", \"restart\" or \"{}\"",
            expected.name()
        ));
    ctx.problems.push(problem);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_away_doubles_up_to_its_limit() {
        let restart = RestartSpec {
            backoff_max_s: 3.0,
            ..RestartSpec::default()
        };
        let times: Vec<f64> = (0..5).map(|n| restart.backoff(n)).collect();
        assert_eq!(times, [0.5, 1.0, 2.0, 3.0, 3.0]);
        assert_eq!(restart.backoff(u32::MAX), 3.0);
    }
}
