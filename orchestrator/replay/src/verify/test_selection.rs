//! Selection of the processes under test, of the processes that they need, and of the senders before their step.

use std::collections::BTreeSet;

use mcap_log::LogReadError;
use mcap_log::Origin;

use super::VerifyOptions;
use crate::ReplayError;
use mission::plan::{Launch, Plan, Role, answering};
use scenario::Program;

/// Selection of the processes of a test.
pub(super) struct TestSelection {
    pub(super) launches: Vec<Launch>,
    pub(super) helpers: Vec<String>,
    /// Senders whose messages are compared.
    pub(super) senders: BTreeSet<u32>,
    /// Senders whose messages precede the step: the world, and the processes that those under test wait for.
    pub(super) before: BTreeSet<u32>,
}

impl TestSelection {
    pub(super) fn new(
        plan: &Plan,
        origin: &Origin,
        options: &VerifyOptions,
    ) -> Result<Self, ReplayError> {
        check_same_parties(plan, origin)?;
        let mut launches = options
            .processes
            .iter()
            .map(|name| launch_of(plan, name, options.allow_external).cloned())
            .collect::<Result<Vec<_>, _>>()?;
        let senders: BTreeSet<u32> = launches.iter().map(|l| l.config.index).collect();
        // Requests and answers are not logged.
        let answering: Vec<Launch> = answering(&launches, &plan.launches).cloned().collect();
        let helpers = answering.iter().map(|l| l.config.name.clone()).collect();
        launches.extend(answering);
        let mut before: BTreeSet<u32> = launches
            .iter()
            .flat_map(|launch| launch.config.upstream.iter().copied())
            .collect();
        before.extend([0, plan.orchestrator_index()]);
        // In the order of the run, without duplicates.
        launches.sort_by_key(|launch| launch.config.index);
        launches.dedup_by_key(|launch| launch.config.index);
        Ok(Self {
            launches,
            helpers,
            senders,
            before,
        })
    }

    /// Returns `true` for a sender whose logged messages are not sent, because it is running.
    pub(super) fn is_silent(&self, source: u32) -> bool {
        let mut launches = self.launches.iter();
        launches.any(|launch| launch.config.index == source)
    }
}

/// Checks that the log is from a run with the processes, robots and ticks of this plan.
fn check_same_parties(plan: &Plan, origin: &Origin) -> Result<(), LogReadError> {
    let processes = plan.launches.iter().map(|l| l.config.name.as_str());
    let processes: Vec<&str> = processes.chain(["orchestrator"]).collect();
    let robots: Vec<&str> = plan.run.robots.iter().map(|r| r.name.as_str()).collect();
    for (key, now) in [
        ("processes", processes.join(",")),
        ("robots", robots.join(",")),
        ("tick_period_ns", plan.run.tick_period_ns.to_string()),
    ] {
        if let Some(then) = origin.manifest.get(key)
            && *then != now
        {
            return Err(LogReadError::Argument(format!(
                "--set: the {key} of the log are {then}, with the changes they are {now}: the messages of \
                 the log do not fit them"
            )));
        }
    }
    Ok(())
}

/// Returns the launch of a process under test.
fn launch_of<'p>(
    plan: &'p Plan,
    name: &str,
    allow_external: bool,
) -> Result<&'p Launch, LogReadError> {
    let refuse = |reason: String| LogReadError::Argument(format!("--test {name}: {reason}"));
    let mut known = plan.launches.iter();
    let Some(launch) = known.find(|launch| launch.config.name == *name) else {
        let others = plan.launches.iter().skip(1);
        let known: Vec<&str> = others.map(|l| &*l.config.name).collect();
        return Err(refuse(format!(
            "the log's scenario has no process with this name: expected one of {}",
            known.join(", ")
        )));
    };
    if launch.config.index == 0 {
        let text = "it leads the tick barrier; `protean verify` runs the whole scenario again";
        return Err(refuse(text.to_owned()));
    }
    if let Role::Process(program @ Program::Command { .. }) = &launch.role
        && !allow_external
    {
        let line = program.command_line();
        return Err(refuse(format!(
            "it is an external program; check it and add --allow-external: {}",
            line.unwrap_or_default()
        )));
    }
    Ok(launch)
}
