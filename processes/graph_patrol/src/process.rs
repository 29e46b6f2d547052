//! Connects the patrol to its topics: state, map, scan and intentions in; command, plan, waypoints and intentions out.

use std::sync::Arc;

use geometry::map::{MapSpec, WorldMap};
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::stamp::PlainHeader;
use nalgebra::Point2;
use patrol_chain::{Chain, ChainError};
use patrol_graph::{Attacks, GraphParams, OfMapError, PatrolGraph, Strategy};
use planner::{Declaration, Input, Output, Planner, PlannerError, PlannerProcess, limits};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use robot::spec::RobotSpec;
use runtime::config::{Clock, ProcessConfig, RobotInfo};
use runtime::declaration::{Flow, When};
use runtime::error::ProcessError;
use runtime::kind::{GraphSketch, Process, ProcessKind, Remark, Task, TaskFault, TaskSketch};
use runtime::maps::Maps;

use crate::chain;
use crate::messages::{Intention, Intentions};
use crate::params::GraphPatrolParams;
use crate::patrol::{GraphPatrol, graph};

/// Deviation of the blurred map, which the graph does not use (m).
const BLUR_SIGMA: f64 = 0.2;

/// Returns the graph on the map of a scenario; `None` if the map is invalid.
fn graph_on(
    params: &GraphPatrolParams,
    map: &WorldMap,
    radius: f64,
) -> Option<Result<GraphParams, OfMapError>> {
    if !params.graph.nodes.is_empty() {
        return Some(Ok(params.graph.clone()));
    }
    let map = PlannerMap::of_world(map, BLUR_SIGMA, 1).ok()?;
    Some(graph(params, &map, radius))
}

/// The attacks of the strategy `markov` on the map of a scenario; `None` for another one, or without a graph.
fn markov_on(params: &GraphPatrolParams, task: &Task<'_>) -> Option<Result<Attacks, ChainError>> {
    if params.strategy != Strategy::Markov {
        return None;
    }
    let model = task.robot.model();
    let graph = graph_on(params, task.world_map, model.radius)?.ok()?;
    let graph = PatrolGraph::new(&graph).ok()?;
    Some(chain::attacks(params, &graph, &model))
}

/// Planner of one robot that patrols a graph.
#[derive(Debug)]
pub struct GraphPatrolPlanner {
    patrol: GraphPatrol,
    revision: Option<u64>,
    failure: Option<ProcessError>,
}

impl GraphPatrolPlanner {
    fn enter(&mut self, map: &PlannerMap) {
        if self.revision.replace(map.revision()) != Some(map.revision())
            && let Err(error) = self.patrol.enter(map)
        {
            self.failure = Some(ProcessError::Algorithm(error.to_string()));
        }
    }
}

impl Planner for GraphPatrolPlanner {
    const NAME: &'static str = "patrol_graph";
    const SUMMARY: &'static str = "patrols a graph by a strategy of the literature";

    type Params = GraphPatrolParams;

    fn declare(_: &GraphPatrolParams) -> Declaration {
        Declaration::default()
            .reads(Input::SHAPES)
            .reads(Input::SCANS.optional())
            .writes(Output::waypoints(64))
    }

    fn sketch(params: &GraphPatrolParams, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        let graph = WorldMap::recent(map)
            .ok()
            .and_then(|map| graph_on(params, &map, robot.model().radius)?.ok());
        TaskSketch {
            graph: graph.map(|graph| GraphSketch {
                nodes: graph.nodes,
                edges: graph.edges,
                visit_m: params.visit,
            }),
            ..TaskSketch::default()
        }
    }

    fn check_task(params: &GraphPatrolParams, task: &Task<'_>, _: u64) -> Result<(), TaskFault> {
        let radius = task.robot.model().radius;
        if let Some(Err(error)) = graph_on(params, task.world_map, radius) {
            return Err(TaskFault::param("spacing", &error.to_string()));
        }
        if let Some(Err(error)) = markov_on(params, task) {
            return Err(TaskFault::param("markov.attack_s", &error.to_string()));
        }
        for (index, &[x, y]) in params.graph.nodes.iter().enumerate() {
            if !task.world_map.is_clear(Point2::new(x, y), radius) {
                let message = format!(
                    "`graph.nodes[{index}]` is ({x}, {y}): expected room for the robot of radius \
                     {radius} m; move it into the free space of the map"
                );
                return Err(TaskFault::param(&format!("graph.nodes[{index}]"), &message));
            }
        }
        Ok(())
    }

    fn remarks(params: &GraphPatrolParams, task: &Task<'_>, _: u64) -> Vec<Remark> {
        let graph = graph_on(params, task.world_map, task.robot.model().radius);
        let is_made = params.graph.nodes.is_empty();
        let made = graph.and_then(Result::ok).filter(|_| is_made);
        let text = made.map(|graph| {
            let (nodes, edges) = (graph.nodes.len(), graph.edges.len());
            Remark::Note(format!(
                "the map has a graph of {nodes} nodes and {edges} edges"
            ))
        });
        let floor = markov_on(params, task)
            .and_then(Result::ok)
            .and_then(|attacks| {
                let caught = |chain: &Chain| Some(100.0 * attacks.best(chain).ok()?.probability);
                let chain = chain::chain(attacks.clone()).ok()?;
                Some((caught(&chain)?, caught(&attacks.random_walk())?))
            });
        let floor = floor.map(|(floor, walk)| {
            Remark::Note(format!(
                "an attack of {} s is caught by each robot with a probability of at least {floor:.1} %; a random walk: \
                 {walk:.1} %",
                params.markov.attack_s
            ))
        });
        text.into_iter().chain(floor).collect()
    }

    fn new(params: &GraphPatrolParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        let patrol = GraphPatrol::new(params, &robot.model, limits(robot)?, seed)?;
        Ok(Self {
            patrol,
            revision: None,
            failure: None,
        })
    }

    fn open(&mut self, config: &ProcessConfig, _: &Bus, robot: u32) -> Result<(), ProcessError> {
        let info = config.run.robots.get(robot as usize);
        let team = info.map_or(&[][..], |info| &info.companions);
        self.patrol.join(robot, team);
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take()
    }

    fn prepare(&mut self, map: &PlannerMap, _: &RobotInfo) {
        self.enter(map);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.enter(map);
        self.patrol.steer(map, view)
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        self.patrol.reports()
    }
}

/// Process of robots that patrol a graph and tell each other their intentions.
pub struct GraphPatrolProcess {
    planners: PlannerProcess<GraphPatrolPlanner>,
    publisher: Publisher<Intentions>,
    subscriber: Subscriber<Intentions>,
    /// Intentions that count later, with their times (ns).
    waiting: Vec<(u64, Vec<Intention>)>,
    clock: Clock,
    period_s: f64,
}

impl ProcessKind for GraphPatrolProcess {
    const NAME: &'static str = GraphPatrolPlanner::NAME;
    const SUMMARY: &'static str = GraphPatrolPlanner::SUMMARY;

    type Params = GraphPatrolParams;

    fn declare(params: &GraphPatrolParams) -> Declaration {
        PlannerProcess::<GraphPatrolPlanner>::declare(params)
            .reads(Input::new(Flow::for_topic::<Intentions>(), When::NextTick))
            .writes(Output::new::<Intentions>(0))
    }

    fn sketch(params: &GraphPatrolParams, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        GraphPatrolPlanner::sketch(params, robot, map)
    }

    fn check_task(params: &GraphPatrolParams, task: &Task<'_>) -> Result<(), TaskFault> {
        GraphPatrolPlanner::check_task(params, task, 0)
    }

    fn remarks(params: &GraphPatrolParams, task: &Task<'_>) -> Vec<Remark> {
        GraphPatrolPlanner::remarks(params, task, 0)
    }

    fn open(
        config: &ProcessConfig,
        params: &GraphPatrolParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let robots = config.own_robots().count();
        Ok(Self {
            planners: PlannerProcess::open(config, params, bus)?,
            publisher: bus.publisher(PublisherOptions::new(config.index, robots))?,
            subscriber: bus.subscriber()?,
            waiting: Vec::new(),
            clock: config.run.clock,
            period_s: config.run.tick_period(),
        })
    }
}

impl Process for GraphPatrolProcess {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        self.planners.share_maps(maps);
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.planners.connect()?;
        self.publisher.update_connections()?;
        self.subscriber.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.planners.prepare()
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.hear(tick)?;
        self.planners.step(tick)?;
        let intentions: Vec<Intention> = self
            .planners
            .planners()
            .map(|planner| planner.patrol.intention())
            .collect();
        let stamp = self.planners.stamp();
        self.publisher.send(PlainHeader { stamp }, &intentions)?;
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.planners.rejected()
    }
}

impl GraphPatrolProcess {
    /// Takes the intentions of earlier ticks. In lock-step those of the same tick, of which some have come, wait.
    fn hear(&mut self, tick: u64) -> Result<(), ProcessError> {
        while let Some(message) = self.subscriber.receive()? {
            let stamp = message.header().stamp;
            self.waiting.push((stamp.tick, message.elements().to_vec()));
        }
        let is_lock_step = self.clock == Clock::LockStep;
        let counts = |message: &mut (u64, Vec<Intention>)| !is_lock_step || message.0 < tick;
        let mut counted: Vec<_> = self.waiting.extract_if(.., counts).collect();
        counted.sort_by_key(|(tick, _)| *tick);
        for (tick, intentions) in counted {
            let time_s = tick as f64 * self.period_s;
            for planner in self.planners.planners() {
                for intention in &intentions {
                    planner.patrol.hear(intention, time_s);
                }
            }
        }
        Ok(())
    }
}
