//! The simulator as a process: the world with its topics.

mod loops;

use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use geometry::blur::BlurError;
use geometry::pose::{Pose2, Twist2};
use ipc_types::bus::{Bus, Inbox, Publisher, PublisherOptions, Subscriber};
use ipc_types::clock::StampClock;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::messages::world::{MapHeader, RobotState, WorldEvent, WorldHeader};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{
    Commands, Coverage, Scan, WorldEvents, WorldMap as MapTopic, WorldShapes, WorldState,
};
use runtime::declaration::{Declaration, Input};
use runtime::lockstep::{BarrierLeader, Phase, SlotState};
use runtime::maps::{MapState, Maps};
use runtime::paced;
use runtime::{Clock, ProcessConfig, ProcessError, Setup, shapes};
use sim_backend::robot::Robot;
use sim_backend::world::{World, WorldError};

use crate::commands::CommandBoard;
use crate::event_schedule::EventSchedule;
use crate::measured::Measured;
use crate::obstacles::Obstacles;
use crate::outputs::{self, Flags};
use crate::params::SimulatorParams;

/// Runs the simulator with the configuration in a file.
pub fn run(config: &Path) -> ExitCode {
    runtime::run_with(config, Vec::new(), |config, params: &SimulatorParams| {
        let mut setup = Setup::new(config)?;
        let mut simulator = Simulator::open(config, params, &setup.bus, None)?;
        let member = setup.member(config);
        member.set_state(SlotState::Ready);
        let stop = Arc::clone(&setup.stop);
        let running = || !stop.load(Ordering::Relaxed);
        if member.wait_for_phase(Phase::Connect, running) {
            simulator.connect()?;
            setup.heartbeat.connect()?;
            setup.heartbeat.send_if_due(0, 2, None)?;
            member.set_state(SlotState::Connected);
            if member.wait_for_phase(Phase::Prepare, running) {
                member.set_state(SlotState::Prepared);
            }
            if member.wait_for_phase(Phase::Run, running) {
                let lag = (config.run.recorder_ticks as usize).saturating_sub(2);
                let leader =
                    BarrierLeader::new(Arc::clone(&setup.barrier), config.index as usize, lag);
                match config.run.clock {
                    Clock::LockStep => {
                        simulator.lock_step(&leader, &mut setup)?;
                    }
                    Clock::RealTime {
                        factor,
                        deadline_ns,
                    } => {
                        simulator.real_time(&leader, &mut setup, factor, deadline_ns)?;
                    }
                }
                if !running() && !leader.stopping() {
                    // The end of the world by a signal is not the end of the game.
                    return Err(ProcessError::Terminated);
                }
                leader.finish();
            }
            // The ports stay open until all processes have received their messages.
            member.wait_for_phase(Phase::Stop, running);
        }
        drop(simulator);
        member.set_state(SlotState::Stopped);
        Ok(())
    })
}

fn refused(config: &ProcessConfig, reason: &str) -> ProcessError {
    ProcessError::Params {
        process: config.name.clone(),
        kind: config.kind.clone(),
        reason: reason.to_owned(),
    }
}

/// The world with its topics: the steps of a tick and their order. The caller (the loops here, or a
/// run in one thread) calls [`publish`](Self::publish), waits for all answers, then calls
/// [`take_commands`](Self::take_commands) and [`advance`](Self::advance).
pub struct Simulator {
    world: World,
    clock: StampClock,
    board: CommandBoard,
    blur_sigma: f64,
    tick_period: Duration,
    tick: u64,
    obstacles: Obstacles,
    events: Vec<WorldEvent>,
    states: Vec<RobotState>,
    /// Robots without a command at the last tick; each is reported once.
    missing: Vec<bool>,
    /// Robots without a valid command, stopped at the last tick.
    stopped: Vec<bool>,
    /// Robots that were in contact in the last step.
    touching: Vec<bool>,
    /// Contacts of each robot before the step; scratch.
    touched_before: Vec<u64>,
    ranges: Vec<f32>,
    /// Scans that were recorded, in place of the robots' own.
    recorded_scans: Vec<Option<Arc<[f32]>>>,
    map_revision: Option<u32>,
    /// Components of the map, if maps are shared.
    shared: Option<(Arc<Maps>, MapState)>,
    refused_commands: u64,
    state_out: Publisher<WorldState>,
    map_out: Publisher<MapTopic>,
    shapes_out: Publisher<WorldShapes>,
    event_out: Publisher<WorldEvents>,
    scan_out: Publisher<Scan>,
    coverage_out: Publisher<Coverage>,
    commands_in: Subscriber<Commands>,
    measured: Measured,
    /// The commands that come late or not at all; `None` without links.
    inbox: Option<Rc<Inbox>>,
}

impl Simulator {
    /// Builds the world and opens its topics; `maps` are those that the processes of a thread share.
    ///
    /// # Errors
    /// [`ProcessError`] if the parameters are invalid, or a topic cannot be opened.
    pub fn open(
        config: &ProcessConfig,
        params: &SimulatorParams,
        bus: &Bus,
        maps: Option<Arc<Maps>>,
    ) -> Result<Self, ProcessError> {
        let world =
            World::new(params.world.clone()).map_err(|e| refused(config, &e.to_string()))?;
        let shared = maps.map(|maps| {
            let map_state = MapState {
                spec: Arc::new(params.world.map.clone()),
                changes: Vec::new(),
                blur_sigma: params.blur_sigma,
            };
            (maps, map_state)
        });
        let robots = world.robots().len();
        if params.drivers.len() != robots {
            let reason = format!("{} drivers for {robots} robots", params.drivers.len());
            return Err(refused(config, &reason));
        }
        let event_schedule =
            EventSchedule::new(params.event_schedule.clone(), &params.world.robots)
                .map_err(|e| refused(config, &e.to_string()))?;
        let inbox = paced::inbox(config, &Declaration::of_simulator());
        let port = |capacity: usize| PublisherOptions::new(config.index, capacity);
        let beams = config.run.robots.iter().map(|r| r.beams).max().unwrap_or(0);
        Ok(Self {
            clock: bus.clock(),
            board: CommandBoard::new(params.drivers.clone()).holding(&params.holds),
            blur_sigma: params.blur_sigma,
            tick_period: Duration::from_nanos(config.run.tick_period_ns),
            tick: 0,
            obstacles: Obstacles::open(bus, config.index, event_schedule)?,
            events: Vec::new(),
            states: Vec::with_capacity(robots),
            missing: vec![false; robots],
            stopped: vec![false; robots],
            touching: vec![false; robots],
            touched_before: Vec::with_capacity(robots),
            ranges: Vec::new(),
            recorded_scans: vec![None; robots],
            map_revision: None,
            shared,
            refused_commands: 0,
            state_out: bus.publisher(port(robots))?,
            map_out: bus.publisher(port(world.map().frame().len()))?,
            // Without the capacity the map has too many pieces at some time, and is sent whole at others.
            shapes_out: bus.publisher(port(
                config
                    .run
                    .capacity(Input::SHAPES.flow)
                    .unwrap_or(shapes::MAX_POINTS),
            ))?,
            event_out: bus.publisher(port(outputs::max_events(
                robots,
                config.run.events as usize,
            )))?,
            scan_out: bus.publisher(port(beams as usize))?,
            coverage_out: bus.publisher(port(1))?,
            commands_in: match &inbox {
                Some(inbox) => bus.through(inbox, || bus.subscriber())?,
                None => bus.subscriber()?,
            },
            measured: Measured::open(bus, robots)?,
            inbox,
            world,
        })
    }

    /// Connects every port and sends the map.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn connect(&mut self) -> Result<(), ProcessError> {
        self.connect_ports()?;
        // All processes build their data of the map before time starts.
        self.publish_map(Stamp {
            origin_ns: self.clock.now_ns(),
            ..Stamp::default()
        })
    }

    /// Connects every port; processes that have joined since receive the newest map.
    fn connect_ports(&mut self) -> Result<(), ProcessError> {
        self.state_out.update_connections()?;
        self.map_out.update_connections()?;
        self.shapes_out.update_connections()?;
        self.event_out.update_connections()?;
        self.scan_out.update_connections()?;
        self.coverage_out.update_connections()?;
        self.commands_in.update_connections()?;
        self.measured.connect()?;
        self.obstacles.connect()
    }

    /// Publishes the map if it has changed since the last time.
    fn publish_map(&mut self, stamp: Stamp) -> Result<(), ProcessError> {
        let revision = outputs::revision(self.world.map());
        if self.map_revision != Some(revision) {
            let draw = || outputs::map_message(self.world.map(), self.blur_sigma, stamp);
            let failed = |e: BlurError| ProcessError::Algorithm(e.to_string());
            if let Some((maps, map_state)) = &mut self.shared {
                let (header, cells) = maps.message(map_state, draw).map_err(failed)?;
                self.map_out
                    .send_shared(MapHeader { stamp, ..header }, &cells)?;
            } else {
                let (header, cells) = draw().map_err(failed)?;
                self.map_out.send(header, &cells)?;
            }
            self.publish_shapes(stamp)?;
            self.map_revision = Some(revision);
        }
        Ok(())
    }

    fn publish_shapes(&self, stamp: Stamp) -> Result<(), ProcessError> {
        let map = self.world.map();
        let capacity = self.shapes_out.capacity();
        let (header, points) =
            shapes::to_message(map.shapes(), outputs::revision(map), stamp, capacity);
        if header.complete == 0 {
            tracing::warn!(
                "tick {}: the map has {} pieces, more than the {capacity} points of world/shapes \
                 hold: planners that search for paths use the grid",
                self.tick,
                map.parts().len()
            );
        }
        self.shapes_out.send(header, &points)?;
        Ok(())
    }

    /// The current tick.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Continues with other parameters from the current tick on ([`World::continue_by`]). The drivers and the schedule of
    /// events stay.
    ///
    /// # Errors
    /// [`ProcessError::Algorithm`]: a value is out of its range.
    pub fn continue_by(&mut self, params: &SimulatorParams) -> Result<(), ProcessError> {
        self.board.hold(&params.holds);
        let continued = self.world.continue_by(&params.world);
        continued.map_err(|error| ProcessError::Algorithm(error.to_string()))
    }

    /// Moves robots to other poses, from the state on that is published next ([`World::shift`]).
    ///
    /// # Errors
    /// [`WorldError`]: a robot cannot be there.
    pub fn shift(&mut self, places: &[(usize, Pose2)]) -> Result<(), WorldError> {
        self.world.shift(places)
    }

    /// Gives a robot a command in place of its driver's, from the current tick on, for a number of ticks.
    pub fn give(&mut self, robot: usize, twist: Twist2, ticks: u64) {
        let until = self.tick.saturating_add(ticks);
        self.board.give(robot, twist, until);
    }

    /// Puts a robot where a recording has it at the state that is published next, with its velocity and its scan: one range
    /// (m) for each beam of its scanner; `None`: the scan is simulated.
    pub fn follow(&mut self, robot: usize, pose: Pose2, twist: Twist2, scan: Option<Arc<[f32]>>) {
        self.world.place(robot, pose, twist);
        if let Some(recorded) = self.recorded_scans.get_mut(robot) {
            *recorded = scan;
        }
    }

    /// Publishes all messages of the current tick, the state last; returns `true` if the game is
    /// over.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn publish(&mut self) -> Result<bool, ProcessError> {
        self.apply_obstacles()?;
        let stamp = Stamp {
            tick: self.tick,
            time_ns: self.time_ns(),
            origin_ns: self.clock.now_ns(),
            received_ns: self.board.received_ns(),
            ..Stamp::default()
        };
        self.publish_map(stamp)?;
        for robot in 0..self.world.robots().len() {
            let recorded = self.recorded_scans.get(robot).and_then(Option::as_deref);
            let (spec, ranges) = match recorded {
                Some(ranges) => (self.world.scan_spec(robot), ranges),
                None => (
                    self.world.scan(robot, &mut self.ranges),
                    self.ranges.as_slice(),
                ),
            };
            if let Some(spec) = spec {
                let header = ScanHeader {
                    stamp,
                    angle_min: spec.angle_min,
                    angle_increment: spec.angle_increment,
                    range_min: spec.range_min,
                    range_max: spec.range_max,
                    robot: robot as u32,
                    reserved: 0,
                };
                self.scan_out.send(header, ranges)?;
            }
        }
        if !self.events.is_empty() {
            self.event_out.send(PlainHeader { stamp }, &self.events)?;
            self.events.clear();
        }
        let over = self.world.is_over();
        self.publish_coverage(stamp, over)?;
        self.states.clear();
        for (index, robot) in self.world.robots().iter().enumerate() {
            let flags = Flags {
                in_contact: self.touching[index],
                fail_safe: self.stopped[index],
                present: self.world.is_present(index),
            };
            self.states.push(outputs::robot_state(index, robot, flags));
        }
        let header = WorldHeader {
            stamp,
            tick_period_ns: self.tick_period.as_nanos() as u64,
            map_revision: outputs::revision(self.world.map()),
            phase: if over {
                WorldHeader::OVER
            } else {
                WorldHeader::RUNNING
            },
        };
        self.state_out.send(header, &self.states)?;
        Ok(over)
    }

    /// Reports the visited area once per period, and at the end.
    fn publish_coverage(&mut self, stamp: Stamp, over: bool) -> Result<(), ProcessError> {
        let Some(coverage) = self.world.coverage() else {
            return Ok(());
        };
        let ticks = coverage.spec().period / self.tick_period.as_secs_f64();
        if over || self.tick.is_multiple_of((ticks.round() as u64).max(1)) {
            let state = outputs::coverage_state(coverage, self.world.time());
            self.coverage_out.send(PlainHeader { stamp }, &[state])?;
        }
        Ok(())
    }

    /// Applies the obstacle changes of the current tick.
    fn apply_obstacles(&mut self) -> Result<(), ProcessError> {
        let stamp = Stamp {
            tick: self.tick,
            time_ns: self.time_ns(),
            origin_ns: self.clock.now_ns(),
            ..Stamp::default()
        };
        let shared = &mut self.shared;
        self.obstacles.apply(&mut self.world, stamp, |change| {
            if let Some((_, map_state)) = shared {
                map_state.changes.push(change);
            }
        })?;
        // They apply from this tick on and are published with it.
        let changes: Vec<_> = self.world.take_pending().collect();
        let robots = self.world.robots();
        let told = changes
            .iter()
            .map(|kind| outputs::world_event(kind, robots));
        self.events.extend(told);
        Ok(())
    }

    /// Returns the simulated time of the current tick (ns).
    fn time_ns(&self) -> u64 {
        self.tick.saturating_mul(self.tick_period.as_nanos() as u64)
    }

    /// Receives the pending commands and measured poses; counts and logs rejected ones.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn take_commands(&mut self) -> Result<(), ProcessError> {
        if let Some(inbox) = &self.inbox {
            inbox.begin(self.tick)?;
        }
        self.refused_commands += self.measured.take(&mut self.world, self.tick)?;
        while let Some(message) = self.commands_in.receive()? {
            let now = self.clock.now_ns();
            for command in message.elements() {
                let taken = self
                    .board
                    .take(&message.header().stamp, command, self.tick, now);
                if let Err(refusal) = taken {
                    self.refused_commands += 1;
                    tracing::warn!(
                        "tick {}: command for robot {} from process {} rejected: {refusal:?}",
                        self.tick,
                        command.robot,
                        message.header().stamp.source
                    );
                }
            }
        }
        Ok(())
    }

    /// Returns the world without its topics.
    pub fn into_world(self) -> World {
        self.world
    }

    /// Steps the world to the next tick with the commands in force: those at most `max_age` ticks
    /// old (0 in lock-step).
    pub fn advance(&mut self, max_age: u64) {
        let commands = self.board.in_force(self.tick, max_age);
        let touched = |robot: &Robot| robot.contacts.wall_ticks + robot.contacts.robot_ticks;
        self.touched_before.clear();
        self.touched_before
            .extend(self.world.robots().iter().map(touched));
        self.world.step(commands, self.tick_period);
        let robots = self.world.robots();
        let happened = self.world.events().iter();
        self.events
            .extend(happened.map(|event| outputs::world_event(&event.kind, robots)));
        for (index, robot) in robots.iter().enumerate() {
            let is_active = robot.status.code() == 0;
            let missing = is_active && self.board.is_missing(index);
            let is_lost = self.measured.is_lost(index, self.tick, max_age);
            self.stopped[index] = is_active && (is_lost || self.board.is_stopped(index));
            if missing && !self.missing[index] {
                self.events.push(outputs::missing_command(index, robots));
            }
            self.missing[index] = missing;
            let before = self.touched_before.get(index).copied();
            self.touching[index] = before.is_some_and(|before| touched(robot) > before);
        }
        self.tick += 1;
    }
}
