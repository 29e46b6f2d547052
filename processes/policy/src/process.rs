//! Connects [`Policy`] to its topics: state, map, exact shapes and what its observation contains in; command out.

use ipc_types::bus::Bus;
use network::Network;
use observation::action::ActionKind;
use observation::facts::RobotFacts;
use observation::parts::Parts;
use planner::{Declaration, Input, Planner, PlannerError, teams};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::{ProcessConfig, RobotInfo};
use runtime::error::ProcessError;
use runtime::kind::{Task, TaskFault};

use crate::{Policy, PolicyParams};

/// Process of the robots of one policy.
#[derive(Debug)]
pub struct PolicyPlanner {
    network: Network,
    parts: Parts,
    action: ActionKind,
    ticks_per_action: u32,
    /// Standard deviation and seed.
    exploration: (f64, u64),
    /// Opened with the configuration of the run.
    policy: Option<Policy>,
    failure: Option<String>,
}

impl Planner for PolicyPlanner {
    const NAME: &'static str = "policy";
    const SUMMARY: &'static str = "steers by a learned policy in an ONNX file";
    const FILES: &'static [&'static str] = &["model"];

    type Params = PolicyParams;

    fn declare(params: &PolicyParams) -> Declaration {
        let parts = params.parts().unwrap_or_default();
        Declaration::default()
            .reads(Input::SHAPES)
            .reads_if(parts.belief, Input::BELIEFS)
            .reads_if(parts.scan, Input::SCANS)
    }

    fn check_task(params: &PolicyParams, task: &Task<'_>, _: u64) -> Result<(), TaskFault> {
        let (Ok(network), Ok(parts), Ok(action)) =
            (params.network(), params.parts(), params.action_kind())
        else {
            // Reported with the parameters.
            return Ok(());
        };
        let facts = RobotFacts::of_specs(task.robots);
        let own = facts.iter().position(|robot| robot.name == task.robot.name);
        let ticks = params.ticks_per_action;
        match Policy::new(
            network,
            parts,
            action,
            ticks,
            &facts,
            own.unwrap_or(0),
            task.exits,
        ) {
            Ok(_) => Ok(()),
            Err(error) => Err(TaskFault::Param {
                field: "model".to_owned(),
                message: error.to_string(),
            }),
        }
    }

    fn new(params: &PolicyParams, _: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            network: params.network()?,
            parts: params.parts()?,
            action: params.action_kind()?,
            ticks_per_action: params.ticks_per_action,
            exploration: (params.exploration, seed),
            policy: None,
            failure: None,
        })
    }

    fn open(&mut self, config: &ProcessConfig, _: &Bus, robot: u32) -> Result<(), ProcessError> {
        let run = &config.run;
        let facts: Vec<RobotFacts> = run
            .robots
            .iter()
            .zip(teams(&run.robots))
            .map(|(info, team)| RobotFacts {
                name: info.name.clone(),
                team,
                model: info.model,
                goal: info.goal,
                beams: info.beams as usize,
            })
            .collect();
        let policy = Policy::new(
            self.network.clone(),
            self.parts,
            self.action,
            self.ticks_per_action,
            &facts,
            robot as usize,
            run.exits.len(),
        );
        let policy = policy.map_err(|error| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason: error.to_string(),
        })?;
        let (deviation, seed) = self.exploration;
        self.policy = Some(policy.exploring(deviation, seed));
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take().map(ProcessError::Algorithm)
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let result = match &mut self.policy {
            Some(policy) => policy.command(map, view).map_err(|error| error.to_string()),
            None => Err("a policy steers once its process is open".to_owned()),
        };
        let command = result.unwrap_or_else(|error| {
            self.failure = Some(error);
            Steering::stop().command
        });
        Steering {
            command,
            ..Steering::stop()
        }
    }
}
