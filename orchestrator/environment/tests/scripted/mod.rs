//! Episodes as ordinary runs, whose planners take the actions of a list.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use environment::{Environments, Episode};
use geometry::pose::Twist2;
use mission::in_process::{InProcessOptions, run};
use observation::action::{ACTION_LENGTH, ActionKind, command};
use observation::facts::RobotFacts;
use observation::field_evader::FieldEvader;
use observation::layout::Layout;
use observation::route_entries::RouteEntries;
use observation::scene::{OcclusionCache, Scene};
use parameters::Parameters;
use planner::{
    Declaration, Input, Planner, PlannerError, PlannerMap, PlannerProcess, RobotInfo, Steering,
    View,
};
use scenario::Template;
use scenario::kind::ConfiguredKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Actions of a run by robot, and the observations that its planners compute from their views.
#[derive(Debug, Default)]
struct Script {
    actions: BTreeMap<String, Vec<[f32; ACTION_LENGTH]>>,
    action: ActionKind,
    observation: String,
    observed: Mutex<BTreeMap<String, Vec<Vec<f32>>>>,
}

/// Parameters of a planner of this test: the script, which has no text.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
struct ScriptParams {
    #[serde(skip)]
    script: Arc<Script>,
}

impl PartialEq for ScriptParams {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.script, &other.script)
    }
}

impl Parameters for ScriptParams {}

/// An ordinary planner that takes actions of a list, and observes as a learned policy does.
struct ScriptedPlanner {
    script: Arc<Script>,
    robot: String,
    next: usize,
    facts: Vec<RobotFacts>,
    ways: Option<RouteEntries>,
    evader: Option<FieldEvader>,
}

impl Planner for ScriptedPlanner {
    const NAME: &'static str = "scripted";
    const SUMMARY: &'static str = "takes actions of a list";

    type Params = ScriptParams;

    fn declare(params: &ScriptParams) -> Declaration {
        let observation = &params.script.observation;
        Declaration::default()
            .reads(Input::SHAPES)
            .reads_if(observation.contains("belief"), Input::BELIEFS)
            .reads_if(observation.contains("scan"), Input::SCANS)
    }

    fn new(params: &ScriptParams, robot: &RobotInfo, _: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            script: Arc::clone(&params.script),
            robot: robot.name.clone(),
            next: 0,
            facts: Vec::new(),
            ways: None,
            evader: None,
        })
    }

    fn open(
        &mut self,
        config: &runtime::ProcessConfig,
        _: &ipc_types::bus::Bus,
        _: u32,
    ) -> Result<(), runtime::ProcessError> {
        let robots = &config.run.robots;
        let teams = planner::teams(robots);
        self.facts = robots
            .iter()
            .zip(teams)
            .map(|(robot, team)| RobotFacts {
                name: robot.name.clone(),
                team,
                model: robot.model,
                goal: robot.goal,
                beams: robot.beams as usize,
            })
            .collect();
        Ok(())
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let parts = self.script.observation.parse().unwrap();
        let layout = Layout::new(parts, &self.facts, view.me, view.exits.len()).unwrap();
        let own = &self.facts[view.me];
        if self.next == 0 {
            self.ways = layout.ways();
            self.evader = FieldEvader::new(self.script.action, own, view.me).ok();
        }
        let mut scene = Scene::new(&self.facts, &[view.me]);
        scene.update(
            view.robots,
            map.space().unwrap().shapes(),
            &mut OcclusionCache::default(),
        );
        let mut observed = vec![0.0; layout.length()];
        layout.write(&scene, view, &mut observed).unwrap();
        if let Some(ways) = &mut self.ways {
            ways.write(map, view, &mut observed);
        }
        let mut all = self.script.observed.lock().unwrap();
        all.entry(self.robot.clone()).or_default().push(observed);
        let action = self.script.actions[&self.robot].get(self.next).copied();
        self.next += 1;
        let command = match (action, self.script.action) {
            (None, _) => Twist2::STOP,
            (Some(action), ActionKind::Twist) => command(action, &own.model),
            (Some(action), ActionKind::Tune | ActionKind::Residual) => {
                let evader = self.evader.as_mut().unwrap();
                evader.act(action);
                evader.steering(map, view).command
            }
        };
        Steering {
            command,
            ..Steering::stop()
        }
    }
}

/// Runs an episode as an ordinary run, with planners in the place of the agents'. Returns its digest, and what its
/// planners observed.
pub fn ordinary_run(
    environments: &Environments,
    template: &Template,
    episode: &Episode,
) -> (String, BTreeMap<String, Vec<Vec<f32>>>) {
    let scenario = template.with_seed(episode.seed).unwrap();
    let agents: Vec<&RobotFacts> = environments.agents().collect();
    let mut actions: BTreeMap<String, Vec<[f32; ACTION_LENGTH]>> = BTreeMap::new();
    for (k, action) in episode.actions.chunks(2).enumerate() {
        let agent = agents[k % agents.len()];
        let list = actions.entry(agent.name.clone()).or_default();
        list.push([action[0], action[1]]);
    }
    let script = Arc::new(Script {
        actions,
        action: environments.options().action,
        observation: environments.options().observation.to_string(),
        ..Script::default()
    });
    let names: Vec<usize> = (0..scenario.processes.len())
        .filter(|&process| {
            let robots = &scenario.processes[process].robots;
            let is_agent = |&robot: &usize| {
                let name = &scenario.world.robots[robot].name;
                script.actions.contains_key(name)
            };
            scenario.processes[process].program.kind_name() != Some("perception")
                && robots.iter().any(is_agent)
        })
        .collect();
    let programs = names.into_iter().map(|process| {
        let script = Arc::clone(&script);
        let params = ScriptParams { script };
        let kind = ConfiguredKind::new::<PlannerProcess<ScriptedPlanner>>(params);
        (scenario.processes[process].name.clone(), kind)
    });
    let options = InProcessOptions {
        programs: programs.collect(),
        last_tick: Some(episode.steps),
        ..InProcessOptions::default()
    };
    let report = run(&scenario, &options).unwrap();
    let observed = std::mem::take(&mut *script.observed.lock().unwrap());
    (report.summary.digest, observed)
}
