//! Connects [`tracking::tracker::Perception`] to its topics: state and map in, sightings and
//! beliefs out.

use geometry::pose::Pose2;
use geometry::visibility::polygon::SightLimits;
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::perception::{BeliefHeader, Particle, Sighting};
use ipc_types::messages::world::WorldEvent;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Belief, Sightings};
use robot::spec::RobotSpec;
use robot::team::Role;
use runtime::declaration::{Declaration, Input, Output, When};
use runtime::grids::{blurred_map, map_grids};
use runtime::inputs::{MapInput, StateInput, reply_stamp};
use runtime::kind::{DirectProcess, ViewSpec};
use runtime::maps::Maps;
use runtime::{Clock, Process, ProcessConfig, ProcessError, ProcessKind};
use std::sync::{Arc, OnceLock};

use crate::direct::{DirectPerception, update};
use tracking::params::PerceptionParams;
use tracking::particle_filter::MotionLimits;
use tracking::space::Space;
use tracking::tracker::{Perception, TargetSetup, Track};

/// Perception of some robots: their common view, and their beliefs about opponents.
pub struct PerceptionProcess {
    config: ProcessConfig,
    params: PerceptionParams,
    observers: Vec<usize>,
    targets: Vec<usize>,
    perception: Option<Perception>,
    state: StateInput,
    map: MapInput,
    sightings: Publisher<Sightings>,
    beliefs: Publisher<Belief>,
    last_tick: Option<u64>,
}

impl ProcessKind for PerceptionProcess {
    const NAME: &'static str = "perception";
    const SUMMARY: &'static str =
        "sightings of the pursuers, and their beliefs about robots out of sight";

    type Params = PerceptionParams;

    fn presets() -> Vec<(&'static str, PerceptionParams)> {
        vec![("paper", PerceptionParams::paper())]
    }

    fn declare(params: &PerceptionParams) -> Declaration {
        let particles = Output::new::<Belief>(params.filter.particles);
        Declaration::default()
            .reads(Input::STATE)
            .reads(Input::MAP)
            .writes(Output::new::<Sightings>(0))
            .writes(particles.at(When::ThisTick).sole())
    }

    /// Its viewpoints are its robots, or all pursuers.
    fn lookout(
        params: &PerceptionParams,
        given: &[usize],
        robots: &[RobotSpec],
    ) -> Option<ViewSpec> {
        let pursuers = || (0..robots.len()).filter(|&i| robots[i].role() == Role::Pursuer);
        Some(ViewSpec {
            robots: if given.is_empty() {
                pursuers().collect()
            } else {
                given.to_vec()
            },
            points: Vec::new(),
            limits: SightLimits {
                range: params.sensor.range,
                field_of_view: params.sensor.field_of_view,
            },
        })
    }

    fn open(
        config: &ProcessConfig,
        params: &PerceptionParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let robots = &config.run.robots;
        let of_role = |role: Role| {
            (0..robots.len())
                .filter(|&i| robots[i].role == role)
                .collect::<Vec<_>>()
        };
        // Without a list of robots its viewpoints are all pursuers.
        let observers = if config.robots.is_empty() {
            of_role(Role::Pursuer)
        } else {
            config
                .robots
                .iter()
                .map(|&r| r as usize)
                .filter(|&r| r < robots.len())
                .collect()
        };
        let side = observers
            .first()
            .map_or(Role::Pursuer, |&first| robots[first].role);
        let mut targets = of_role(if side == Role::Evader {
            Role::Pursuer
        } else {
            Role::Evader
        });
        // Observers of the opposite role follow the robots that are hostile to them.
        targets.retain(|&target| {
            let side = robots[target].role.opposite();
            let mut opposite = observers.iter().filter(|&&i| Some(robots[i].role) == side);
            let is_hostile = |&i: &usize| robots[i].opponents.contains(&(target as u32));
            opposite.clone().next().is_none() || opposite.any(is_hostile)
        });
        Ok(Self {
            state: StateInput::open(bus, robots.len())?,
            map: MapInput::open(bus)?,
            sightings: bus.publisher(PublisherOptions::new(config.index, targets.len()))?,
            beliefs: bus.publisher(PublisherOptions::new(config.index, params.filter.particles))?,
            config: config.clone(),
            params: params.clone(),
            observers,
            targets,
            perception: None,
            last_tick: None,
        })
    }
}

impl Process for PerceptionProcess {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        self.map.share(maps);
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map.connect()?;
        self.sightings.update_connections()?;
        self.beliefs.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        if self.map.update()? {
            self.take_map()?;
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let clock = self.config.run.clock;
        self.state.take_turn(tick, clock)?;
        let newest = self.state.header.stamp.tick;
        self.prepare()?;
        let Some(perception) = &mut self.perception else {
            if clock == Clock::LockStep {
                let text = "it is the turn of a tick, but no sound world/map has come";
                return Err(ProcessError::Protocol(text.into()));
            }
            return Ok(());
        };
        // In real time ticks may have been missed: the motion model covers the whole gap.
        let ticks = self
            .last_tick
            .map_or(1, |last| newest.saturating_sub(last).max(1));
        self.last_tick = Some(newest);
        let dt = self.config.run.tick_period() * ticks as f64;
        let pose = |robot: usize| {
            let r = self.state.robots.get(robot).filter(|r| r.status == 0);
            r.map(|r| Pose2::new(r.x, r.y, r.theta))
        };
        // The best view is named by its place among the active observers.
        let active = self
            .observers
            .iter()
            .filter(|&&robot| pose(robot).is_some());
        let viewpoints: Vec<u32> = active.map(|&robot| robot as u32).collect();
        let tracks = update(perception, &self.observers, &self.targets, pose, dt)?;
        let stamp = reply_stamp(&self.state.header, self.state.received_ns);
        let mut active_tracks = tracks.iter().filter(|track| track.is_active());
        let count = active_tracks.clone().count();
        self.sightings
            .send_with(PlainHeader { stamp }, count, |_| {
                active_tracks
                    .next()
                    .map(|track| sighting(track, &viewpoints))
                    .unwrap_or_default()
            })?;
        for track in tracks.iter().filter(|track| track.is_active()) {
            let mut particles = track.particles();
            let count = particles.len();
            self.beliefs
                .send_with(belief_header(track, stamp), count, |_| {
                    particles
                        .next()
                        .map_or_else(Particle::default, |p| Particle {
                            x: p.x,
                            y: p.y,
                            theta: p.theta,
                            weight: p.weight,
                        })
                })?;
        }
        Ok(())
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn into_direct(self: Box<Self>) -> Option<Box<dyn DirectProcess>> {
        Some(Box::new(DirectPerception {
            perception: self.perception?,
            dt: self.config.run.tick_period(),
            observers: self.observers,
            targets: self.targets,
            particles: Vec::new(),
        }))
    }

    fn rejected(&self) -> u64 {
        self.state.rejected + self.map.rejected
    }
}

impl PerceptionProcess {
    fn take_map(&mut self) -> Result<(), ProcessError> {
        let make = || {
            let grids = map_grids(&self.map.header, self.map.cells());
            let map = blurred_map(grids.blurred, grids.occupied)?;
            Ok::<_, ProcessError>(Arc::new(Space::new(&map)))
        };
        // Processes of one thread build it once.
        let space = match self.map.derived::<OnceLock<Arc<Space>>>() {
            None => make()?,
            Some(shared) => {
                if let Some(known) = shared.get() {
                    Arc::clone(known)
                } else {
                    let made = make()?;
                    Arc::clone(shared.get_or_init(|| made))
                }
            }
        };
        if let Some(perception) = &mut self.perception {
            perception.set_map(space);
            return Ok(());
        }
        let setups = self
            .targets
            .iter()
            .map(|&robot| {
                let info = &self.config.run.robots[robot];
                TargetSetup {
                    robot,
                    limits: MotionLimits {
                        v_max: info.model.v_max,
                        v_reverse_max: info.model.v_reverse_max,
                        omega_max: info.model.omega_max,
                    },
                    start: self.params.filter.known_start(info.start),
                    rng: runtime::seed::stream(
                        self.config.run.seed,
                        &self.config.name,
                        &info.name,
                        "perception",
                    ),
                }
            })
            .collect();
        let perception = Perception::new(&self.params, space, setups)
            .map_err(|e| ProcessError::Algorithm(e.to_string()))?;
        self.perception = Some(perception);
        Ok(())
    }
}

fn sighting(track: &Track, viewpoints: &[u32]) -> Sighting {
    let seen = track.sighting();
    let mut message = Sighting {
        sigma: f64::INFINITY,
        visibility: seen.visibility,
        robot: track.robot() as u32,
        observer: seen
            .observer
            .and_then(|at| viewpoints.get(at).copied())
            .unwrap_or(WorldEvent::NONE),
        ..Sighting::default()
    };
    if let Some(measurement) = &seen.measurement {
        message.x = measurement.position.x;
        message.y = measurement.position.y;
        message.sigma = measurement.sigma;
        message.seen = 1;
        if let Some((heading, _)) = measurement.heading {
            message.theta = heading;
            message.heading_known = 1;
        }
    }
    message
}

fn belief_header(track: &Track, stamp: Stamp) -> BeliefHeader {
    let belief = track.belief();
    BeliefHeader {
        stamp,
        mean_x: belief.mean.x,
        mean_y: belief.mean.y,
        mean_theta: belief.mean.theta,
        covariance_xx: belief.covariance_xx,
        covariance_xy: belief.covariance_xy,
        covariance_yy: belief.covariance_yy,
        heading_spread: belief.heading_spread,
        effective_sample_size: belief.effective_sample_size,
        robot: track.robot() as u32,
        seen: u32::from(belief.seen),
    }
}
