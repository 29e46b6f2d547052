//! The planner of one robot in a library, as a [`Planner`], and the process of such planners.

use core::ffi::c_void;
use std::cell::RefCell;
use std::path::Path;
use std::process::ExitCode;

use geometry::pose::Twist2;
use geometry::region::Region;
use ipc_types::bus::Bus;
use parameters::Parameters;
use planner::{
    Declaration, Input, Limits, Planner, PlannerError, PlannerMap, PlannerProcess, RobotInfo,
    Steering, View, limits,
};
use rand_chacha::ChaCha8Rng;
use runtime::config::{CONFIG_VARIABLE, ProcessConfig};
use runtime::error::ProcessError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use crate::abi::{
    self, BELIEFS, Belief, NO_ROBOT, Particle, Point, SCANS, Scan, Start, Tick, WAYS,
};
use crate::library::Library;
use crate::robots::Robots;
use crate::start_functions::StartContext;
use crate::tick_functions::TickContext;
use crate::{start_functions, tick_functions};

/// Exit code of a library that no run has started.
const EXIT_WITHOUT_RUN: u8 = 2;

/// Main function of a process whose planner is in a library: `command = ["protean", "planner", "LIBRARY"]`.
///
/// Without a run it checks the library and says how to use it, with exit code 2.
pub fn run(path: &Path) -> ExitCode {
    let library = match Library::load(path) {
        Ok(library) => library,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    let Some(config) = std::env::var_os(CONFIG_VARIABLE) else {
        eprintln!(
            "{path}: a planner that reads {}\nA run of protean starts it: name it in a scenario, command = [\"protean\", \
             \"planner\", \"{path}\"] in [[processes]].",
            library.inputs(),
            path = path.display()
        );
        return ExitCode::from(EXIT_WITHOUT_RUN);
    };
    runtime::run_with(Path::new(&config), Vec::new(), |config, values| {
        let params = LibraryParams::new(values, library);
        runtime::follow::<PlannerProcess<LibraryPlanner>>(config, &params)
    })
}

/// Parameters as written, which the library checks, and the library.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct LibraryParams {
    #[serde(flatten)]
    values: Map<String, Json>,
    #[serde(skip)]
    library: Option<Library>,
}

impl LibraryParams {
    /// Returns the parameters of a planner in this library.
    pub fn new(values: &Map<String, Json>, library: Library) -> Self {
        Self {
            values: values.clone(),
            library: Some(library),
        }
    }
}

impl Parameters for LibraryParams {}

/// The planner of one robot in a library.
#[derive(Debug)]
pub(crate) struct LibraryPlanner {
    params: LibraryParams,
    limits: Limits,
    seed: u64,
    exits: Vec<Point>,
    capture_radius: f64,
    driven: Option<Driven>,
    failure: Option<ProcessError>,
}

impl Planner for LibraryPlanner {
    const NAME: &'static str = "library";
    const SUMMARY: &'static str = "steers with a planner in C or C++";

    type Params = LibraryParams;

    fn declare(params: &LibraryParams) -> Declaration {
        let reads = |input| params.library.is_some_and(|library| library.reads(input));
        Declaration::default()
            .reads_if(reads(BELIEFS), Input::BELIEFS)
            .reads_if(reads(SCANS), Input::SCANS)
            .reads_if(reads(WAYS), Input::SHAPES.optional())
    }

    fn new(params: &LibraryParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            params: params.clone(),
            limits: limits(robot)?,
            seed,
            exits: Vec::new(),
            capture_radius: 0.0,
            driven: None,
            failure: None,
        })
    }

    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.exits = exits.iter().map(|exit| exit.center().into()).collect();
        self.capture_radius = capture_radius;
    }

    fn open(&mut self, config: &ProcessConfig, _: &Bus, robot: u32) -> Result<(), ProcessError> {
        let driven = self
            .start(config, robot)
            .map_err(|reason| ProcessError::Params {
                process: config.name.clone(),
                kind: config.kind.clone(),
                reason,
            })?;
        self.driven = Some(driven);
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take()
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(driven) = &mut self.driven else {
            return Steering::stop();
        };
        match driven.steer(map, view, &self.exits, self.limits) {
            Ok(steering) => steering,
            Err(text) => {
                let text = format!("at {} s the planner fails: {text}", view.time_s);
                self.failure = Some(ProcessError::Algorithm(text));
                Steering::stop()
            }
        }
    }
}

impl LibraryPlanner {
    /// Returns the started planner of a robot.
    ///
    /// # Errors
    /// The reason of the library, or an unknown parameter.
    pub fn start(&self, config: &ProcessConfig, robot: u32) -> Result<Driven, String> {
        let library = self.params.library.ok_or("no library is loaded")?;
        let robots = Robots::new(&config.run.robots, robot as usize);
        let robots = robots.ok_or_else(|| format!("the run has no robot {robot}"))?;
        let context = StartContext::new(&self.params.values);
        let start = Start {
            own: robots.own(),
            robots: robots.all().as_ptr(),
            robot_count: robots.all().len(),
            exits: self.exits.as_ptr(),
            exit_count: self.exits.len(),
            capture_radius: self.capture_radius,
            dt: config.step_period(),
            seed: self.seed,
            functions: &raw const start_functions::FUNCTIONS,
            context: (&raw const context).cast(),
        };
        let name = &config.run.robots.get(robot as usize);
        let name = name.map_or("", |info| info.name.as_str());
        let random = runtime::seed::stream(config.run.seed, Self::NAME, name, "random");
        let driven = Driven {
            planner: library.create(&start),
            library,
            robots,
            random: RefCell::new(random),
            particles: Vec::new(),
            beliefs: Vec::new(),
        };
        match context.refusal(!driven.planner.is_null()) {
            Some(reason) => Err(reason),
            None => Ok(driven),
        }
    }
}

/// A planner that a library has created.
#[derive(Debug)]
pub(crate) struct Driven {
    library: Library,
    planner: *mut c_void,
    robots: Robots,
    random: RefCell<ChaCha8Rng>,
    particles: Vec<Particle>,
    beliefs: Vec<Belief>,
}

impl Driven {
    /// Returns the steering of a tick.
    ///
    /// # Errors
    /// The failure that the library reports, or numbers that are not finite.
    pub fn steer(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        exits: &[Point],
        limits: Limits,
    ) -> Result<Steering, String> {
        self.robots.update(view.robots);
        self.take_beliefs(view);
        let scan = view.scan.map(|scan| Scan {
            angle_min: scan.angle_min,
            angle_increment: scan.angle_increment,
            range_min: scan.range_min,
            range_max: scan.range_max,
            ranges: scan.ranges.as_ptr(),
            range_count: scan.ranges.len(),
        });
        let context = TickContext {
            map,
            own: self.robots.own(),
            limits,
            dt: view.dt,
            random: &self.random,
            failure: RefCell::default(),
        };
        let tick = Tick {
            time: view.time_s,
            dt: view.dt,
            own: self.robots.own(),
            robots: self.robots.all().as_ptr(),
            robot_count: self.robots.all().len(),
            exits: exits.as_ptr(),
            exit_count: exits.len(),
            beliefs: self.beliefs.as_ptr(),
            belief_count: self.beliefs.len(),
            scan: scan.as_ref().map_or(std::ptr::null(), std::ptr::from_ref),
            map_revision: map.revision(),
            functions: &raw const tick_functions::FUNCTIONS,
            context: (&raw const context).cast(),
        };
        let mut out = abi::Steering::STOP;
        self.library.steer(self.planner, &tick, &mut out);
        if let Some(text) = context.failure.into_inner() {
            return Err(text);
        }
        let command = Twist2::new(out.v, out.omega);
        if !command.is_finite() {
            let (v, omega) = (out.v, out.omega);
            return Err(format!("v = {v}, omega = {omega}; expected finite numbers"));
        }
        Ok(Steering {
            command: limits.clip(command),
            target: (out.target != NO_ROBOT).then_some(out.target as usize),
            aim: out.aim.finite(),
            waypoint: out.waypoint.finite(),
            ..Steering::stop()
        })
    }

    /// Copies the beliefs of a tick.
    fn take_beliefs(&mut self, view: &View<'_>) {
        self.particles.clear();
        self.beliefs.clear();
        let all = view.beliefs.iter().flat_map(|belief| belief.particles);
        self.particles.extend(all.map(|p| Particle {
            x: p.x,
            y: p.y,
            theta: p.theta,
            weight: p.weight,
        }));
        let mut rest = &self.particles[..];
        for belief in view.beliefs {
            let (particles, behind) = rest.split_at(belief.particles.len());
            rest = behind;
            self.beliefs.push(Belief {
                x: belief.mean.x,
                y: belief.mean.y,
                theta: belief.mean.theta,
                position_std: belief.position_std,
                particles: particles.as_ptr(),
                particle_count: particles.len(),
                robot: belief.robot as u32,
                seen: belief.seen,
            });
        }
    }
}

impl Drop for Driven {
    fn drop(&mut self) {
        if !self.planner.is_null() {
            self.library.destroy(self.planner);
        }
    }
}
