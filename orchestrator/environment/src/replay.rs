//! Execution of recorded episodes as runs with a recorder.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use geometry::pose::Twist2;
use mission::MissionReport;
use mission::in_process::{InProcessOptions, run};
use observation::action::{ACTION_LENGTH, command};
use planner::PlannerProcess;
use scenario::kind::ConfiguredKind;
use scenario::{Program, ResolvedScenario};

use crate::commanded::{CommandHistory, CommandedParams, CommandedPlanner};
use crate::episode::Episode;
use crate::error::EnvironmentError;
use crate::shared::SharedData;

impl Episode {
    /// Executes the episode again as a run in this thread, with planners that send its commands and stop after the last
    /// one. The run ends with the tick after the last step. `out` is the path of its log; `force` permits to overwrite
    /// one; `interrupted` ends it in order, as [`InProcessOptions::interrupted`] does.
    ///
    /// # Errors
    /// [`EnvironmentError`] if the run fails or the log cannot be written.
    pub fn replay(
        &self,
        out: Option<PathBuf>,
        force: bool,
        interrupted: &Arc<AtomicBool>,
    ) -> Result<(ResolvedScenario, MissionReport), EnvironmentError> {
        let options = InProcessOptions {
            out,
            force,
            interrupted: Arc::clone(interrupted),
            ..InProcessOptions::default()
        };
        replay(&self.shared, self, options)
    }
}

fn replay(
    shared: &SharedData,
    episode: &Episode,
    options: InProcessOptions,
) -> Result<(ResolvedScenario, MissionReport), EnvironmentError> {
    let mut scenario = shared.scenario(episode.seed)?;
    let commands = Arc::new(CommandHistory(commands(shared, episode)));
    let mut programs = shared.options.programs.clone();
    for &index in &shared.agents.processes {
        let Some(process) = scenario.processes.get_mut(index) else {
            continue;
        };
        // The log shows that no kind of the scenario steered.
        process.program = Program::Command {
            words: vec!["learner".to_owned()],
            folder: "/".to_owned(),
            params: serde_json::Value::Object(serde_json::Map::new()),
            declared: scenario::ProgramDeclaration::Nothing,
        };
        let params = CommandedParams::new(Arc::clone(&commands) as _);
        let kind = ConfiguredKind::new::<PlannerProcess<CommandedPlanner>>(params);
        programs.insert(process.name.clone(), kind);
    }
    let options = InProcessOptions {
        remarks: scenario.remarks(),
        last_tick: Some(episode.steps),
        programs,
        cache: Arc::clone(&shared.cache),
        ..options
    };
    let report = run(&scenario, &options)?;
    Ok((scenario, report))
}

/// Returns the commands of an episode, by the names of the robots.
fn commands(shared: &SharedData, episode: &Episode) -> BTreeMap<String, Vec<Twist2>> {
    let (actions, _) = episode.actions.as_chunks::<ACTION_LENGTH>();
    let agents = shared.agents.robots.iter().enumerate();
    let named = agents.filter_map(|(agent, &robot)| {
        let facts = shared.facts.get(robot)?;
        let step = shared.shape.agents.max(1);
        let commands = if shared.evaders.is_empty() {
            let own = actions.iter().skip(agent).step_by(step);
            own.map(|&action| command(action, &facts.model)).collect()
        } else {
            let own = episode.commands.iter().skip(agent).step_by(step);
            own.copied().collect()
        };
        Some((facts.name.clone(), commands))
    });
    named.collect()
}
