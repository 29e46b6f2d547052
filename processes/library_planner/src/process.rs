//! The planner of one robot in a library, as a [`Planner`], and the calls of a library.

use core::ffi::c_void;
use std::cell::RefCell;

use geometry::pose::Twist2;
use geometry::region::Region;
use ipc_types::bus::Bus;
use planner::{
    Declaration, Input, Limits, Planner, PlannerError, PlannerMap, RawOutput, RobotInfo, Steering,
    View, limits, planner_reads,
};
use rand_chacha::ChaCha8Rng;
use runtime::config::ProcessConfig;
use runtime::error::ProcessError;
use runtime::raw_inputs::RawInputs;

use crate::abi::{
    self, BELIEFS, Belief, NO_ROBOT, Particle, Point, SCANS, Scan, Start, Tick, WAYS,
};
use crate::error::{CallError, Unexpected};
use crate::library::Library;
use crate::params::LibraryParams;
use crate::records::Records;
use crate::robots::Robots;
use crate::start_functions::StartContext;
use crate::tick_functions::{RobotTask, TickContext};
use crate::{start_functions, tick_functions, topics};

/// The planner of one robot in a library.
#[derive(Debug)]
pub struct LibraryPlanner {
    params: LibraryParams,
    limits: Limits,
    seed: u64,
    exits: Vec<Point>,
    capture_radius: f64,
    driven: Option<LibraryInstance>,
    inputs: RawInputs,
    failure: Option<ProcessError>,
}

impl Planner for LibraryPlanner {
    const NAME: &'static str = "library";
    const SUMMARY: &'static str = "steers with a planner in C or C++";

    type Params = LibraryParams;

    fn declare(params: &LibraryParams) -> Declaration {
        let uses = |input| params.library.is_some_and(|library| library.uses(input));
        planner_reads(&names(params))
            .reads_if(uses(BELIEFS), Input::BELIEFS)
            .reads_if(uses(SCANS), Input::SCANS)
            .reads_if(uses(WAYS), Input::SHAPES.optional())
    }

    fn new(params: &LibraryParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            params: params.clone(),
            limits: limits(robot)?,
            seed,
            exits: Vec::new(),
            capture_radius: 0.0,
            driven: None,
            inputs: RawInputs::default(),
            failure: None,
        })
    }

    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.exits = exits.iter().map(|exit| exit.center().into()).collect();
        self.capture_radius = capture_radius;
    }

    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        self.inputs = RawInputs::open(&names(&self.params), config, bus)?;
        let rules = Rules {
            exits: &self.exits,
            capture_radius: self.capture_radius,
        };
        let driven = LibraryInstance::open(config, &self.params, Some(robot), &rules, self.seed)?;
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
        let tick = (view.time_s / view.dt).round() as u64;
        let received = self.inputs.receive(tick);
        let steered = received.and_then(|()| {
            let records = Records::new(&self.inputs);
            let steered = driven.steer(map, view, &self.exits, self.limits, &records);
            steered.map_err(|error| ProcessError::Algorithm(error.to_string()))
        });
        match steered {
            Ok(steering) => steering,
            Err(error) => {
                let text = format!("at {} s the planner fails: {error}", view.time_s);
                self.failure = Some(ProcessError::Algorithm(text));
                Steering::stop()
            }
        }
    }
}

/// Returns the names of the topics that a library reads.
fn names(params: &LibraryParams) -> Vec<String> {
    let names = params.library.map(Library::reads);
    // The library was checked.
    names.and_then(Result::ok).unwrap_or_default()
}

/// Rules of a run.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// Centres of the exits.
    pub exits: &'a [Point],
    /// Distance of a capture (m); 0 without captures.
    pub capture_radius: f64,
}

/// A planner, or a process, that a library has created.
#[derive(Debug)]
pub struct LibraryInstance {
    pub library: Library,
    pub planner: *mut c_void,
    robots: Robots,
    random: RefCell<ChaCha8Rng>,
    particles: Vec<Particle>,
    beliefs: Vec<Belief>,
}

impl LibraryInstance {
    /// Returns [`Self::start`], after a check of the topics that the library reads.
    ///
    /// # Errors
    /// Ends the process before it is ready.
    pub fn open(
        config: &ProcessConfig,
        params: &LibraryParams,
        robot: Option<u32>,
        rules: &Rules<'_>,
        seed: u64,
    ) -> Result<Self, ProcessError> {
        if let Some(library) = params.library {
            let checked = topics::check_reads(library.table);
            checked.map_err(|error| ProcessError::Algorithm(error.to_string()))?;
        }
        let started = Self::start(config, params, robot, rules, seed);
        started.map_err(|error| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason: error.to_string(),
        })
    }

    /// Returns the started planner of a robot, or a process without a robot.
    ///
    /// # Errors
    /// The reason of the library, or an unknown parameter.
    pub fn start(
        config: &ProcessConfig,
        params: &LibraryParams,
        robot: Option<u32>,
        rules: &Rules<'_>,
        seed: u64,
    ) -> Result<Self, CallError> {
        let library = params.library.ok_or(CallError::NoLibrary)?;
        let own = robot.map(|robot| robot as usize);
        let robots = Robots::new(&config.run.robots, own);
        let robots = robots.ok_or(CallError::NoRobot(robot.unwrap_or_default()))?;
        let context = StartContext::new(&params.values);
        let start = Start {
            own: robots.own().map_or(std::ptr::null(), std::ptr::from_ref),
            robots: robots.all().as_ptr(),
            robot_count: robots.all().len(),
            exits: rules.exits.as_ptr(),
            exit_count: rules.exits.len(),
            capture_radius: rules.capture_radius,
            dt: config.step_period(),
            seed,
            functions: &raw const start_functions::FUNCTIONS,
            context: (&raw const context).cast(),
        };
        let info = own.and_then(|own| config.run.robots.get(own));
        let (name, purpose) = match info {
            Some(info) => (&info.name, "random"),
            None => (&config.name, "random of a process"),
        };
        let random = runtime::seed::stream(config.run.seed, LibraryPlanner::NAME, name, purpose);
        let driven = Self {
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

    /// Calls the library in a tick; a planner has a map and limits.
    ///
    /// # Errors
    /// The failure that the library reports.
    pub fn call(
        &mut self,
        view: &View<'_>,
        exits: &[Point],
        task: Option<(&PlannerMap, Limits)>,
        records: &Records,
        outputs: &mut [RawOutput],
        call: impl FnOnce(&Self, &Tick),
    ) -> Result<(), CallError> {
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
        let own = self.robots.own();
        let task = own.zip(task);
        let context = TickContext {
            task: task.map(|(own, (map, limits))| RobotTask { map, own, limits }),
            dt: view.dt,
            random: &self.random,
            records,
            outputs: RefCell::new(outputs),
            failure: RefCell::default(),
        };
        let tick = Tick {
            time: view.time_s,
            dt: view.dt,
            own: own.map_or(std::ptr::null(), std::ptr::from_ref),
            robots: self.robots.all().as_ptr(),
            robot_count: self.robots.all().len(),
            exits: exits.as_ptr(),
            exit_count: exits.len(),
            beliefs: self.beliefs.as_ptr(),
            belief_count: self.beliefs.len(),
            scan: scan.as_ref().map_or(std::ptr::null(), std::ptr::from_ref),
            map_revision: task.map_or(0, |(_, (map, _))| map.revision()),
            functions: &raw const tick_functions::FUNCTIONS,
            context: (&raw const context).cast(),
        };
        call(self, &tick);
        context.failure.into_inner().map_or(Ok(()), Err)
    }

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
        records: &Records,
    ) -> Result<Steering, CallError> {
        let mut out = abi::Steering::STOP;
        let task = Some((map, limits));
        self.call(view, exits, task, records, &mut [], |driven, tick| {
            driven.library.steer(driven.planner, tick, &mut out);
        })?;
        let command = Twist2::new(out.v, out.omega);
        if !command.is_finite() {
            let (v, omega) = (out.v, out.omega);
            let found = format!("v = {v}, omega = {omega}");
            return Err(Unexpected::new(found, "finite numbers").into());
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

impl Drop for LibraryInstance {
    fn drop(&mut self) {
        if !self.planner.is_null() {
            self.library.destroy(self.planner);
        }
    }
}
