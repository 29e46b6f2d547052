//! The wiring that all steering planners share: state, map, beliefs and scans in; a command and a
//! plan per robot out.

use guidance::limits::Limits;
use guidance::map::PlannerMap;
use guidance::steering::Steering;
use guidance::view::{BeliefView, ParticleView, RobotView, ScanView, View};
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::robot::{Command, PlanHeader, PlanPoint};
use ipc_types::messages::world::{RobotState, WorldEvent};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Commands, Plan, Scan};
use nalgebra::Point2;
use serde::de::DeserializeOwned;
use sim_backend::blur::BlurredMap;
use sim_backend::grid::{Grid, GridFrame};
use sim_backend::pose::{Pose2, Twist2};
use sim_backend::team::Team;

use crate::config::{Clock, ProcessConfig, RobotInfo};
use crate::error::ProcessError;
use crate::inputs::{BeliefInput, Latest, MapInput, ScanInput, StateInput, reply_stamp};
use crate::life::Wiring;

/// Which topics beside state and map a planner reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlannerInputs {
    /// Beliefs about the opponents.
    pub beliefs: bool,
    /// Range scans of its robots.
    pub scans: bool,
}

/// A steering algorithm for one robot.
pub trait Planner: Sized {
    /// Its parameters.
    type Params: DeserializeOwned;

    /// Which topics it reads, given its parameters.
    fn inputs(params: &Self::Params) -> PlannerInputs;

    /// A planner for a robot; `seed` is its own.
    ///
    /// # Errors
    /// A text that names the parameter that does not do.
    fn new(params: &Self::Params, robot: &RobotInfo, seed: u64) -> Result<Self, String>;

    /// Builds what it needs of a new map, if it wants to do that before the next tick.
    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        let _ = (map, robot);
    }

    /// What the robot does in this tick.
    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering;
}

struct Driven<P> {
    robot: u32,
    planner: P,
}

/// Runs one planner per robot of the process.
pub struct PlannerProcess<P: Planner> {
    state: StateInput,
    map_input: MapInput,
    beliefs: Option<BeliefInput>,
    scans: Option<ScanInput>,
    commands: Publisher<Commands>,
    plans: Publisher<Plan>,
    config: ProcessConfig,
    map: Option<PlannerMap>,
    exits: Vec<Point2<f64>>,
    driven: Vec<Driven<P>>,
    views: Vec<RobotView>,
    particles: Vec<ParticleView>,
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
        let driven = config
            .own_robots()
            .map(|(robot, info)| {
                use rand::Rng as _;
                let seed =
                    crate::seed::stream(config.run.seed, &config.kind, &info.name, "planner")
                        .next_u64();
                P::new(&params, info, seed).map(|planner| Driven { robot, planner })
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        Ok(Self {
            state: StateInput::open(bus, robots)?,
            map_input: MapInput::open(bus)?,
            beliefs: inputs
                .beliefs
                .then(|| BeliefInput::open(bus, robots))
                .transpose()?,
            scans: inputs
                .scans
                .then(|| ScanInput::open(bus, robots))
                .transpose()?,
            commands: bus.publisher(PublisherOptions::new(config.index, 1))?,
            plans: bus.publisher(PublisherOptions::new(config.index, 2))?,
            config: config.clone(),
            map: None,
            exits: config
                .run
                .exits
                .iter()
                .map(sim_backend::spec::Region::center)
                .collect(),
            driven,
            views: Vec::with_capacity(robots),
            particles: Vec::new(),
        })
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map_input.connect()?;
        if let Some(beliefs) = &self.beliefs {
            beliefs.connect()?;
        }
        if let Some(scans) = &self.scans {
            scans.connect()?;
        }
        self.commands.update_connections()?;
        self.plans.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.take_map()
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        if self.config.run.clock == Clock::LockStep {
            self.state.update_to(tick)?;
        } else {
            self.state.update()?;
        }
        if self.config.run.clock == Clock::LockStep && self.state.header.stamp.tick != tick {
            return Err(ProcessError::Protocol(format!(
                "it is the turn of tick {tick}, but the newest world/state is of tick {}",
                self.state.header.stamp.tick
            )));
        }
        // The state says which map holds: without another revision there is nothing to look for.
        let has_changed = self.state.header.map_revision != self.map_input.header.revision;
        if has_changed && self.map_input.update()? {
            self.map = Some(planner_map(&self.map_input)?);
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
                let text = "it is the turn of a tick, but no sound world/map has come";
                return Err(ProcessError::Protocol(text.into()));
            }
            // In real time a state may come before the map. No command: the robot stands.
            return Ok(());
        };
        self.views.clear();
        self.views.extend(
            self.state
                .robots
                .iter()
                .zip(&self.config.run.robots)
                .enumerate()
                .map(|(index, (state, info))| robot_view(index, state, info)),
        );
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
            outputs.send(driven.robot, &driven.planner.steer(map, &view))?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
            + self.map_input.rejected
            + self.beliefs.as_ref().map_or(0, |b| b.rejected)
            + self.scans.as_ref().map_or(0, |s| s.rejected)
    }
}

impl<P: Planner> PlannerProcess<P> {
    fn take_map(&mut self) -> Result<(), ProcessError> {
        if self.map_input.update()? {
            let map = planner_map(&self.map_input)?;
            for driven in &mut self.driven {
                if let Some(robot) = self.config.run.robots.get(driven.robot as usize) {
                    driven.planner.prepare(&map, robot);
                }
            }
            self.map = Some(map);
        }
        Ok(())
    }
}

/// Where a tick's results go.
struct Outputs<'a> {
    commands: &'a Publisher<Commands>,
    plans: &'a Publisher<Plan>,
    stamp: Stamp,
}

impl Outputs<'_> {
    fn send(&self, robot: u32, steering: &Steering) -> Result<(), ProcessError> {
        let stamp = self.stamp;
        let Twist2 { v, omega } = steering.command;
        let command = Command {
            v,
            omega,
            robot,
            reserved: 0,
        };
        self.commands.send(PlainHeader { stamp }, &[command])?;
        let target = steering
            .target
            .map_or(WorldEvent::NONE, |target| target as u32);
        let points = [steering.waypoint, steering.aim];
        let count = points.iter().flatten().count();
        let mut points = points.into_iter().flatten();
        self.plans.send_with(
            PlanHeader {
                stamp,
                robot,
                target,
            },
            count,
            |_| {
                let p = points.next().unwrap_or_default();
                PlanPoint {
                    x: p.x,
                    y: p.y,
                    ..PlanPoint::default()
                }
            },
        )?;
        Ok(())
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

/// Lays a map message out as grids.
pub struct MapGrids {
    /// Gaussian blur of the free map, not masked.
    pub blurred: Grid<f32>,
    /// Cells whose centre is in an obstacle.
    pub occupied: Grid<bool>,
    /// Distance from the cell's centre to the nearest obstacle [m].
    pub clearance: Grid<f32>,
}

/// The grids of the newest map.
pub fn map_grids(map: &MapInput) -> MapGrids {
    let frame = GridFrame {
        width: map.header.width as usize,
        height: map.header.height as usize,
        resolution: map.header.resolution,
        origin: Point2::new(map.header.origin_x, map.header.origin_y),
    };
    MapGrids {
        blurred: Grid {
            frame,
            cells: map.cells.iter().map(|c| c.blurred).collect(),
        },
        occupied: Grid {
            frame,
            cells: map.cells.iter().map(|c| c.occupied != 0).collect(),
        },
        clearance: Grid {
            frame,
            cells: map.cells.iter().map(|c| c.clearance).collect(),
        },
    }
}

/// The blurred map of the newest map message.
///
/// # Errors
/// [`ProcessError::Protocol`] if the message makes no map.
pub fn blurred_map(grids: &MapGrids) -> Result<BlurredMap, ProcessError> {
    BlurredMap::from_parts(grids.blurred.clone(), grids.occupied.clone())
        .map_err(|e| ProcessError::Protocol(format!("world/map: {e}")))
}

fn planner_map(input: &MapInput) -> Result<PlannerMap, ProcessError> {
    let grids = map_grids(input);
    let blurred = blurred_map(&grids)?;
    PlannerMap::new(blurred, grids.clearance, u64::from(input.header.revision))
        .map_err(|e| ProcessError::Protocol(format!("world/map: {e}")))
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
