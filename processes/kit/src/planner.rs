//! The wiring that all steering planners share: state, map, beliefs and scans in; a command and a
//! plan per robot out.

use std::sync::Arc;

use guidance::free_space::FreeSpace;
use guidance::limits::Limits;
use guidance::map::PlannerMap;
use guidance::steering::Steering;
use guidance::view::{BeliefView, ParticleView, RobotView, ScanView, View};
use guidance::waypoint::WaypointReport;
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::robot::TreeEdge;
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Commands, Plan, Scan, Tree, Waypoints};
use nalgebra::Point2;
use serde::de::DeserializeOwned;
use sim_backend::pose::{Pose2, Twist2};
use sim_backend::spec::Region;
use sim_backend::team::Team;

use crate::config::{Clock, ProcessConfig, RobotInfo};
use crate::error::ProcessError;
use crate::inputs::{
    BeliefInput, Latest, MapInput, ScanInput, ShapesInput, StateInput, reply_stamp,
};
use crate::life::Wiring;

mod grids;
mod outputs;

use outputs::Outputs;

pub use grids::{MapGrids, blurred_map, map_grids, planner_map};
pub use outputs::{MAX_PLAN_POINTS, PlannedPoint, headed_for};

/// Which topics beside state and map a planner reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlannerInputs {
    /// Beliefs about the opponents.
    pub beliefs: bool,
    /// Range scans of its robots.
    pub scans: bool,
    /// The exact pieces of the map ([`PlannerMap::space`]).
    pub shapes: bool,
}

/// A steering algorithm for one robot.
pub trait Planner: Sized {
    /// Its parameters.
    type Params: DeserializeOwned;

    /// Most edges of a tree that it publishes; 0 for a planner without trees.
    const TREE_EDGES: usize = 0;

    /// Most waypoints that may end in one tick; 0 for a planner without waypoints.
    const WAYPOINTS: usize = 0;

    /// Which topics it reads, given its parameters.
    fn inputs(params: &Self::Params) -> PlannerInputs;

    /// A planner for a robot; `seed` is its own.
    ///
    /// # Errors
    /// A text that names the parameter that does not do.
    fn new(params: &Self::Params, robot: &RobotInfo, seed: u64) -> Result<Self, String>;

    /// Takes note of the rules: where evaders get away, and the distance below which Police catch
    /// them [m] (0 if they do not). Called once, before everything else.
    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        let _ = (exits, capture_radius);
    }

    /// Opens what it needs of the bus besides the topics of [`PlannerInputs`], for the robot with
    /// this index. Called once, after [`Planner::rules`].
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        let _ = (config, bus, robot);
        Ok(())
    }

    /// Why it cannot go on, if it cannot; asked after every steering. Ends the process.
    fn failure(&mut self) -> Option<ProcessError> {
        None
    }

    /// Builds what it needs of a new map, if it wants to do that before the next tick.
    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        let _ = (map, robot);
    }

    /// What the robot does in this tick.
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering;

    /// Writes the plan behind the steering of this tick into `out`, the nearest point first; `out`
    /// is empty. By default the point headed for and the one to reach in the end.
    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        headed_for(steering, out);
    }

    /// The search tree behind the plan, each tree once: `None` while there is no new one. Edges
    /// beyond [`Self::TREE_EDGES`] are not sent.
    fn tree(&mut self) -> Option<&[TreeEdge]> {
        None
    }

    /// The waypoints that ended in this tick. Those beyond [`Self::WAYPOINTS`] are not sent.
    fn waypoints(&mut self) -> &[WaypointReport] {
        &[]
    }
}

struct Driven<P> {
    robot: u32,
    planner: P,
}

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
    config: ProcessConfig,
    map: Option<Arc<PlannerMap>>,
    exits: Vec<Point2<f64>>,
    driven: Vec<Driven<P>>,
    views: Vec<RobotView>,
    particles: Vec<ParticleView>,
    planned: Vec<PlannedPoint>,
}

impl<P: Planner> Wiring for PlannerProcess<P> {
    fn open(config: &ProcessConfig, bus: &Bus) -> Result<Self, ProcessError> {
        let refused = |reason: String| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason,
        };
        let params: P::Params =
            serde_json::from_value(config.params.clone()).map_err(|e| refused(e.to_string()))?;
        let inputs = P::inputs(&params);
        let robots = config.run.robots.len();
        let mut driven = config
            .own_robots()
            .map(|(robot, info)| {
                let seed = planner_seed(config.run.seed, &config.kind, &info.name);
                P::new(&params, info, seed).map(|mut planner| {
                    planner.rules(&config.run.exits, config.run.capture_radius);
                    Driven { robot, planner }
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
            shapes: inputs.shapes.then(|| ShapesInput::open(bus)).transpose()?,
            beliefs: inputs
                .beliefs
                .then(|| BeliefInput::open(bus, robots))
                .transpose()?,
            scans: inputs
                .scans
                .then(|| ScanInput::open(bus, robots))
                .transpose()?,
            commands: bus.publisher(PublisherOptions::new(config.index, 1))?,
            plans: bus.publisher(PublisherOptions::new(config.index, MAX_PLAN_POINTS))?,
            trees: (P::TREE_EDGES > 0)
                .then(|| bus.publisher(PublisherOptions::new(config.index, P::TREE_EDGES)))
                .transpose()?,
            waypoints: (P::WAYPOINTS > 0)
                .then(|| bus.publisher(PublisherOptions::new(config.index, P::WAYPOINTS)))
                .transpose()?,
            config: config.clone(),
            map: None,
            exits: config.run.exits.iter().map(Region::center).collect(),
            driven,
            views: Vec::with_capacity(robots),
            particles: Vec::new(),
            planned: Vec::with_capacity(MAX_PLAN_POINTS),
        })
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
        // The state says which map holds: without another revision there is nothing to look for.
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
                let text = "it is the turn of a tick, but no sound world/map has come (with its \
                            world/shapes, if the planner needs them)";
                return Err(ProcessError::Protocol(text.into()));
            }
            // In real time a state may come before the map. No command: the robot stands.
            return Ok(());
        };
        robot_views(&self.state, &self.config.run.robots, &mut self.views);
        // Particles of all beliefs side by side; the views point into them.
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
            stamp,
        };
        for driven in &mut self.driven {
            let scan = self.scans.as_ref().and_then(|scans| scans.of(driven.robot));
            let view = View {
                time_s: self.state.header.stamp.time_ns as f64 * 1e-9,
                dt: self.config.run.tick_period(),
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
                outputs.send_tree(driven.robot, edges, P::TREE_EDGES)?;
            }
            outputs.send_waypoints(driven.robot, driven.planner.waypoints(), P::WAYPOINTS)?;
        }
        Ok(())
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
    /// Takes up a new map, once all of it is there; true if there is one.
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
                // Sent right after the map, so that this is a matter of a moment in real time.
                return Ok(false);
            }
        }
        self.map = Some(self.make_map()?);
        Ok(true)
    }

    /// The map that has come. Processes of one thread make it once.
    fn make_map(&self) -> Result<Arc<PlannerMap>, ProcessError> {
        let is_shared = self.driven.len() > 1 || self.map_input.is_shared();
        let exact = self.shapes.is_some();
        self.map_input.planner_map(exact, |input| {
            let map = planner_map(input)?;
            let map = if is_shared { map.shared() } else { map };
            Ok(match self.shapes.as_ref().map(|s| &s.pieces) {
                None => map,
                Some(Some((bounds, parts))) => {
                    let space = FreeSpace::new(parts.clone(), *bounds, input.header.resolution)
                        .map_err(|e| ProcessError::Protocol(format!("world/shapes: {e}")))?;
                    map.with_space(Arc::new(space))
                }
                Some(None) => {
                    tracing::warn!(
                        "the map has too many pieces for world/shapes: planning goes by the grid"
                    );
                    map
                }
            })
        })
    }
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

/// A robot as planners see it, from the world's state.
fn robot_view(index: usize, state: &RobotState, info: &RobotInfo) -> RobotView {
    RobotView {
        index,
        team: Team::from_code(state.team).unwrap_or(info.team),
        active: state.status == 0,
        present: state.present != 0,
        pose: Pose2::new(state.x, state.y, state.theta),
        twist: Twist2::new(state.v, state.omega),
        radius: info.model.radius,
        v_max: info.model.v_max,
    }
}

/// Replaces `views` by what planners see of the robots of the newest state.
pub fn robot_views(state: &StateInput, infos: &[RobotInfo], views: &mut Vec<RobotView>) {
    views.clear();
    let robots = state.robots.iter().zip(infos).enumerate();
    views.extend(robots.map(|(index, (state, info))| robot_view(index, state, info)));
}

/// The seed that the planner of a robot gets in a run.
pub fn planner_seed(run_seed: u64, kind: &str, robot: &str) -> u64 {
    use rand::Rng as _;
    crate::seed::stream(run_seed, kind, robot, "planner").next_u64()
}

/// The limits of a robot as its planner sees them.
///
/// # Errors
/// A text that names the limit that does not do.
pub fn limits(robot: &RobotInfo) -> Result<Limits, String> {
    let model = &robot.model;
    Limits::new(model.v_max, model.v_reverse_max, model.omega_max)
        .map_err(|e| format!("{}: {e}", robot.name))
}
