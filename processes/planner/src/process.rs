//! Process of all steering planners: state, map, beliefs and scans in; a command and a plan per
//! robot out.

use std::sync::Arc;

use geometry::map::MapSpec;
use geometry::pose::Pose2;
use geometry::region::Region;
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::stamp::Stamp;
use ipc_types::topics::{Commands, Plan, RobotEvents, Scan, Tree, Waypoints};
use nalgebra::Point2;
use planner_view::map::PlannerMap;
use planner_view::view::{BeliefView, ParticleView, RobotView, ScanView, View};
use robot::spec::RobotSpec;
use robot::team::Team;
use runtime::config::{Clock, ProcessConfig};
use runtime::declaration::{Declaration, Flow, Input, Output};
use runtime::error::ProcessError;
use runtime::inputs::{
    BeliefInput, Latest, MapInput, ScanInput, ShapesInput, StateInput, reply_stamp,
};
use runtime::kind::{DirectProcess, Process, ProcessKind, Remark, Task, TaskFault, TaskSketch};
use runtime::maps::Maps;

use crate::direct::{DirectPlanners, PlannerSlot};
use crate::error::PlannerError;
use crate::maps::planner_map;
use crate::outputs::{MAX_PLAN_POINTS, Outputs, PlannedPoint};
use crate::planner::{Planner, planner_seed};
use crate::views::{robot_views, teams};

/// Runs one planner per robot of the process.
pub struct PlannerProcess<P: Planner> {
    state: StateInput,
    map_input: MapInput,
    shapes: Option<ShapesInput>,
    beliefs: Option<BeliefInput>,
    scans: Option<ScanInput>,
    commands: Publisher<Commands>,
    plans: Publisher<Plan>,
    trees: Option<Publisher<Tree>>,
    waypoints: Option<Publisher<Waypoints>>,
    events: Option<Publisher<RobotEvents>>,
    /// `true` if its planners need no messages but state, map and beliefs.
    is_direct: bool,
    config: ProcessConfig,
    map: Option<Arc<PlannerMap>>,
    exits: Vec<Point2<f64>>,
    driven: Vec<PlannerSlot<P>>,
    teams: Vec<Team>,
    views: Vec<RobotView>,
    particles: Vec<ParticleView>,
    planned: Vec<PlannedPoint>,
}

impl<P: Planner> ProcessKind for PlannerProcess<P> {
    const NAME: &'static str = P::NAME;
    const SUMMARY: &'static str = P::SUMMARY;

    const FILES: &'static [&'static str] = P::FILES;

    type Params = P::Params;

    fn presets() -> Vec<(&'static str, P::Params)> {
        P::presets()
    }

    fn declare(params: &P::Params) -> Declaration {
        P::declare(params)
            .reads(Input::STATE)
            .reads(Input::MAP)
            .writes(Output::new::<Commands>(1))
            .writes(Output::new::<Plan>(MAX_PLAN_POINTS))
    }

    fn sketch(params: &P::Params, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        P::sketch(params, robot, map)
    }

    fn check_task(params: &P::Params, task: &Task<'_>) -> Result<(), TaskFault> {
        let seed = planner_seed(task.run_seed, P::NAME, &task.robot.name);
        P::check_task(params, task, seed)
    }

    fn remarks(params: &P::Params, task: &Task<'_>) -> Vec<Remark> {
        let seed = planner_seed(task.run_seed, P::NAME, &task.robot.name);
        P::remarks(params, task, seed)
    }

    fn open(config: &ProcessConfig, params: &P::Params, bus: &Bus) -> Result<Self, ProcessError> {
        let refused = |error: PlannerError| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason: error.to_string(),
        };
        let declaration = P::declare(params);
        let reads = |input: Input| declaration.input(input.flow).is_some();
        let most = |flow: Flow| declaration.output(flow).map(|output| output.elements);
        let (edges, waypoints, events) = (
            most(Flow::for_topic::<Tree>()),
            most(Flow::for_topic::<Waypoints>()),
            most(Flow::for_topic::<RobotEvents>()),
        );
        let mut inputs = declaration.inputs.iter();
        let is_direct =
            inputs.all(|input| [Input::SHAPES.flow, Input::BELIEFS.flow].contains(&input.flow));
        let robots = config.run.robots.len();
        let mut driven = config
            .own_robots()
            .map(|(robot, info)| {
                let seed = planner_seed(config.run.seed, &config.kind, &info.name);
                P::new(params, info, seed).map(|mut planner| {
                    planner.rules(&config.run.exits, config.run.capture_radius);
                    PlannerSlot { robot, planner }
                })
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        for driven in &mut driven {
            driven.planner.open(config, bus, driven.robot)?;
        }
        Ok(Self {
            state: StateInput::open(bus, robots)?,
            map_input: MapInput::open(bus)?,
            shapes: reads(Input::SHAPES)
                .then(|| ShapesInput::open(bus))
                .transpose()?,
            beliefs: reads(Input::BELIEFS)
                .then(|| BeliefInput::open(bus, robots))
                .transpose()?,
            scans: reads(Input::SCANS)
                .then(|| ScanInput::open(bus, robots))
                .transpose()?,
            commands: bus.publisher(PublisherOptions::new(config.index, 1))?,
            plans: bus.publisher(PublisherOptions::new(config.index, MAX_PLAN_POINTS))?,
            trees: edges
                .map(|edges| bus.publisher(PublisherOptions::new(config.index, edges)))
                .transpose()?,
            waypoints: waypoints
                .map(|most| bus.publisher(PublisherOptions::new(config.index, most)))
                .transpose()?,
            events: events
                .map(|most| bus.publisher(PublisherOptions::new(config.index, most)))
                .transpose()?,
            teams: teams(&config.run.robots),
            is_direct,
            config: config.clone(),
            map: None,
            exits: config.run.exits.iter().map(Region::center).collect(),
            driven,
            views: Vec::with_capacity(robots),
            particles: Vec::new(),
            planned: Vec::with_capacity(MAX_PLAN_POINTS),
        })
    }
}

impl<P: Planner> Process for PlannerProcess<P> {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        self.map_input.share(maps);
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map_input.connect()?;
        if let Some(shapes) = &self.shapes {
            shapes.connect()?;
        }
        if let Some(beliefs) = &self.beliefs {
            beliefs.connect()?;
        }
        if let Some(scans) = &self.scans {
            scans.connect()?;
        }
        self.commands.update_connections()?;
        self.plans.update_connections()?;
        if let Some(trees) = &self.trees {
            trees.update_connections()?;
        }
        if let Some(waypoints) = &self.waypoints {
            waypoints.update_connections()?;
        }
        if let Some(events) = &self.events {
            events.update_connections()?;
        }
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        if self.take_map()?
            && let Some(map) = &self.map
        {
            for driven in &mut self.driven {
                if let Some(robot) = self.config.run.robots.get(driven.robot as usize) {
                    driven.planner.prepare(map, robot);
                }
            }
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.state.take_turn(tick, self.config.run.clock)?;
        // The state names the revision of the map: without a new revision there is no message to
        // look for.
        let known = self.map.as_ref().map_or(0, |map| map.revision());
        if u64::from(self.state.header.map_revision) != known {
            self.take_map()?;
        }
        let mut received_ns = self.state.received_ns;
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.update()?;
            received_ns = received_ns.max(beliefs.received_ns);
        }
        if let Some(scans) = &mut self.scans {
            scans.update()?;
            received_ns = received_ns.max(scans.received_ns);
        }
        let Some(map) = &self.map else {
            if self.config.run.clock == Clock::LockStep {
                return Err(no_map());
            }
            // In real time a state may arrive before the map. Without a command the robot stands.
            return Ok(());
        };
        robot_views(
            &self.state,
            &self.config.run.robots,
            &self.teams,
            &mut self.views,
        );
        // Particles of all beliefs in one buffer; the views refer to it.
        self.particles.clear();
        let beliefs = self.beliefs.as_ref().map_or(&[][..], |b| &b.latest);
        for belief in beliefs {
            self.particles
                .extend(belief.elements.iter().map(|p| ParticleView {
                    x: p.x,
                    y: p.y,
                    theta: p.theta,
                    weight: p.weight,
                }));
        }
        let mut rest = &self.particles[..];
        let belief_views: Vec<BeliefView<'_>> = beliefs
            .iter()
            .map(|belief| {
                let (particles, behind) = rest.split_at(belief.elements.len());
                rest = behind;
                let h = &belief.header;
                BeliefView {
                    robot: h.robot as usize,
                    particles,
                    mean: Pose2::new(h.mean_x, h.mean_y, h.mean_theta),
                    position_std: (h.covariance_xx + h.covariance_yy).max(0.0).sqrt(),
                    seen: h.seen != 0,
                }
            })
            .collect();
        let stamp = reply_stamp(&self.state.header, received_ns);
        let outputs = Outputs {
            commands: &self.commands,
            plans: &self.plans,
            trees: self.trees.as_ref(),
            waypoints: self.waypoints.as_ref(),
            events: self.events.as_ref(),
            stamp,
        };
        for driven in &mut self.driven {
            let scan = self
                .scans
                .as_ref()
                .and_then(|scans| scans.latest(driven.robot));
            let view = View {
                time_s: self.state.header.stamp.time_ns as f64 * 1e-9,
                dt: self.config.step_period(),
                me: driven.robot as usize,
                robots: &self.views,
                beliefs: &belief_views,
                exits: &self.exits,
                scan: scan.map(scan_view),
            };
            let steering = driven.planner.steer(map, &view);
            if let Some(error) = driven.planner.failure() {
                return Err(error);
            }
            self.planned.clear();
            driven.planner.plan(&steering, &mut self.planned);
            outputs.send(driven.robot, &steering, &self.planned)?;
            if let Some(edges) = driven.planner.tree() {
                outputs.send_tree(driven.robot, edges)?;
            }
            outputs.send_waypoints(driven.robot, driven.planner.waypoints())?;
            outputs.send_events(driven.robot, driven.planner.events())?;
        }
        Ok(())
    }

    fn is_direct(&self) -> bool {
        self.is_direct
    }

    fn into_direct(self: Box<Self>) -> Option<Box<dyn DirectProcess>> {
        Some(Box::new(DirectPlanners {
            map: self.map.filter(|_| self.is_direct)?,
            dt: self.config.step_period(),
            reads_beliefs: self.beliefs.is_some(),
            driven: self.driven,
        }))
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
            + self.map_input.rejected
            + self.shapes.as_ref().map_or(0, |s| s.rejected)
            + self.beliefs.as_ref().map_or(0, |b| b.rejected)
            + self.scans.as_ref().map_or(0, |s| s.rejected)
    }
}

impl<P: Planner> PlannerProcess<P> {
    /// The planners of its robots, in their order, for a process with more topics.
    pub fn planners(&mut self) -> impl Iterator<Item = &mut P> {
        self.driven.iter_mut().map(|driven| &mut driven.planner)
    }

    /// The stamp of outputs of the last tick.
    pub fn stamp(&self) -> Stamp {
        reply_stamp(&self.state.header, self.state.received_ns)
    }

    /// Receives a new map, once all its messages have arrived; returns `true` if there is one.
    fn take_map(&mut self) -> Result<bool, ProcessError> {
        self.map_input.update()?;
        let revision = self.map_input.header.revision;
        let known = self.map.as_ref().map_or(0, |map| map.revision());
        if u64::from(revision) == known {
            return Ok(false);
        }
        if let Some(shapes) = &mut self.shapes {
            shapes.update()?;
            if shapes.header.revision != revision {
                // Sent right after the map, so that the wait is short in real time.
                return Ok(false);
            }
        }
        let (shapes, is_shared) = (self.shapes.as_ref(), self.driven.len() > 1);
        self.map = Some(planner_map(&self.map_input, shapes, is_shared)?);
        Ok(true)
    }
}

fn no_map() -> ProcessError {
    let text = "it is the turn of a tick, but no sound world/map has come (with its world/shapes, if \
                the planner needs them)";
    ProcessError::Protocol(text.into())
}

fn scan_view(scan: &Latest<Scan>) -> ScanView<'_> {
    ScanView {
        angle_min: scan.header.angle_min,
        angle_increment: scan.header.angle_increment,
        range_min: scan.header.range_min,
        range_max: scan.header.range_max,
        ranges: &scan.elements,
    }
}
