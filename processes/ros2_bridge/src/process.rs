//! Connects ROS 2 nodes to a run: state, map, scans and beliefs out, commands of the robots in.

use core::time::Duration;
use std::time::Instant;

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::WorldHeader;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Belief, Commands};
use ros_messages::messages::{
    Clock as RosClock, LaserScan, OccupancyGrid, Odometry, PoseArray, TFMessage, Time,
};
use runtime::declaration::{Declaration, Flow, Input, Output};
use runtime::inputs::{BeliefInput, MapInput, ScanInput, StateInput, reply_stamp};
use runtime::{Clock, Process, ProcessConfig, ProcessError, ProcessKind};

use crate::answers::{Answers, RobotCommand};
use crate::convert;
use crate::error::BridgeError;
use crate::params::{Order, Ros2BridgeParams};
use crate::session::{RosPublisher, Session};

/// Pause between two looks at the nodes of a domain.
const LOOK: Duration = Duration::from_millis(20);
/// Time for which the first state waits for its answers before it is sent again: the other side of a connection
/// may not have found its writer yet.
const FIRST_ANSWER: Duration = Duration::from_secs(2);

/// A robot that ROS 2 nodes steer.
struct Robot {
    index: u32,
    name: String,
    odometry: RosPublisher<Odometry>,
    scan: Option<RosPublisher<LaserScan>>,
    answers: Answers,
}

/// The process of kind `ros2_bridge`.
pub struct Ros2BridgeProcess {
    config: ProcessConfig,
    params: Ros2BridgeParams,
    state: StateInput,
    map: MapInput,
    scans: Option<ScanInput>,
    beliefs: Option<BeliefInput>,
    commands: Publisher<Commands>,
    robots: Vec<Robot>,
    clock: RosPublisher<RosClock>,
    transforms: RosPublisher<TFMessage>,
    static_transforms: RosPublisher<TFMessage>,
    grid: RosPublisher<OccupancyGrid>,
    /// Publishers of beliefs, by the robot that they are about.
    believed: Vec<(u32, RosPublisher<PoseArray>)>,
    /// Revision of the map that was sent last.
    sent_map: u32,
    /// Time of the last state.
    last: Time,
    has_answer: bool,
    /// The last member: it ends after all that use it.
    session: Session,
}

impl From<BridgeError> for ProcessError {
    fn from(error: BridgeError) -> Self {
        Self::Algorithm(error.to_string())
    }
}

impl ProcessKind for Ros2BridgeProcess {
    const NAME: &'static str = "ros2_bridge";
    const SUMMARY: &'static str = "steers robots with ROS 2 nodes";

    type Params = Ros2BridgeParams;

    fn declare(_: &Ros2BridgeParams) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .reads(Input::MAP)
            .reads(Input::SCANS.optional())
            .reads(Input::BELIEFS.optional())
            .writes(Output::new::<Commands>(1))
    }

    fn open(
        config: &ProcessConfig,
        params: &Ros2BridgeParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let all = config.run.robots.len();
        let mut session = Session::join(params.domain, &config.name, params.loopback)?;
        let mut robots = Vec::new();
        for (index, info) in config.own_robots() {
            let name = namespace(&info.name)?;
            robots.push(Robot {
                index,
                odometry: session.publisher(&format!("/{name}/odom"), false)?,
                scan: (info.beams > 0)
                    .then(|| session.publisher(&format!("/{name}/scan"), false))
                    .transpose()?,
                answers: Answers::open(&mut session, &name, params.commands)?,
                name,
            });
        }
        let has_beliefs = config.run.capacity(Flow::for_topic::<Belief>()).is_some();
        Ok(Self {
            state: StateInput::open(bus, all)?,
            map: MapInput::open(bus)?,
            scans: robots
                .iter()
                .any(|robot| robot.scan.is_some())
                .then(|| ScanInput::open(bus, all))
                .transpose()?,
            beliefs: has_beliefs
                .then(|| BeliefInput::open(bus, all))
                .transpose()?,
            commands: bus.publisher(PublisherOptions::new(config.index, 1))?,
            clock: session.publisher("/clock", false)?,
            transforms: session.publisher("/tf", false)?,
            static_transforms: session.publisher("/tf_static", true)?,
            grid: session.publisher("/map", true)?,
            believed: Vec::new(),
            sent_map: 0,
            last: Time::default(),
            has_answer: false,
            config: config.clone(),
            params: params.clone(),
            robots,
            session,
        })
    }
}

impl Process for Ros2BridgeProcess {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map.connect()?;
        if let Some(scans) = &self.scans {
            scans.connect()?;
        }
        if let Some(beliefs) = &self.beliefs {
            beliefs.connect()?;
        }
        self.commands.update_connections()?;
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        let names: Vec<String> = self.robots.iter().map(|robot| robot.name.clone()).collect();
        self.static_transforms
            .send(convert::static_transforms(&names))?;
        self.send_map(Time::default())?;
        if self.config.run.clock == Clock::LockStep {
            self.wait_for_nodes()?;
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let clock = self.config.run.clock;
        self.state.take_turn(tick, clock)?;
        let header = self.state.header;
        let mut received_ns = self.state.received_ns;
        if let Some(scans) = &mut self.scans {
            scans.update()?;
            received_ns = received_ns.max(scans.received_ns);
        }
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.update()?;
            received_ns = received_ns.max(beliefs.received_ns);
        }
        let stamp = convert::time(&header);
        if clock == Clock::LockStep {
            for robot in &self.robots {
                robot.answers.expect_none(tick.saturating_sub(1))?;
            }
        }
        if self.params.order == Order::ClockFirst {
            self.clock.send(RosClock {
                clock: stamp.clone(),
            })?;
        }
        self.send_map(stamp.clone())?;
        self.send_data(&stamp)?;
        if self.params.order == Order::DataFirst {
            self.clock.send(RosClock {
                clock: stamp.clone(),
            })?;
        }
        let header_out = PlainHeader {
            stamp: reply_stamp(&header, received_ns),
        };
        let before = core::mem::replace(&mut self.last, stamp.clone());
        if header.phase == WorldHeader::OVER {
            return Ok(());
        }
        let times = [stamp, before];
        for at in 0..self.robots.len() {
            let command = match clock {
                Clock::LockStep => Some(self.answer(at, tick, &times)?),
                Clock::RealTime { .. } => self.robots[at].answers.newest()?,
            };
            if let Some(RobotCommand { v, omega, .. }) = command {
                let command = Command {
                    v,
                    omega,
                    robot: self.robots[at].index,
                    reserved: 0,
                };
                self.commands.send(header_out, &[command])?;
            }
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
            + self.map.rejected
            + self.scans.as_ref().map_or(0, |scans| scans.rejected)
            + self.beliefs.as_ref().map_or(0, |beliefs| beliefs.rejected)
    }
}

impl Ros2BridgeProcess {
    /// Waits until each robot has a node that reads its odometry and writes its commands.
    fn wait_for_nodes(&self) -> Result<(), BridgeError> {
        let timeout = Duration::from_secs_f64(self.params.start_timeout_s);
        let until = Instant::now() + timeout;
        for robot in &self.robots {
            loop {
                let lack = if !robot.answers.is_written(&self.session)? {
                    format!("writes /{}/cmd_vel", robot.name)
                } else if robot.odometry.readers(&self.session) == 0 {
                    format!("reads /{}/odom", robot.name)
                } else {
                    break;
                };
                if Instant::now() >= until {
                    return Err(robot.answers.no_node(&self.session, &lack, timeout));
                }
                std::thread::sleep(LOOK);
            }
        }
        if self.session.is_written_elsewhere("/clock") {
            return Err(BridgeError::SecondClock {
                domain: self.params.domain,
            });
        }
        Ok(())
    }

    /// The command of a robot for a tick. The first state is sent again until its node has answered once.
    fn answer(
        &mut self,
        at: usize,
        tick: u64,
        times: &[Time; 2],
    ) -> Result<RobotCommand, BridgeError> {
        let timeout = Duration::from_secs_f64(self.params.answer_timeout_s);
        let stamp = &times[0];
        if !self.has_answer {
            let until = Instant::now() + timeout;
            while Instant::now() + FIRST_ANSWER < until {
                match self.robots[at]
                    .answers
                    .wait(&self.session, tick, times, FIRST_ANSWER)
                {
                    Err(BridgeError::NoCommand { .. }) => {
                        self.send_odometry(at, stamp)?;
                        self.clock.send(RosClock {
                            clock: stamp.clone(),
                        })?;
                    }
                    answer => {
                        self.has_answer = at + 1 == self.robots.len();
                        return answer;
                    }
                }
            }
        }
        self.robots[at]
            .answers
            .wait(&self.session, tick, times, timeout)
    }

    /// Sends the map if it is a new one.
    fn send_map(&mut self, stamp: Time) -> Result<(), ProcessError> {
        self.map.update()?;
        let revision = self.map.header.revision;
        if revision != self.sent_map {
            let grid = convert::grid(&self.map.header, self.map.cells(), stamp);
            self.grid.send(grid)?;
            self.sent_map = revision;
        }
        Ok(())
    }

    /// Sends the odometry of a robot.
    fn send_odometry(&self, at: usize, stamp: &Time) -> Result<(), BridgeError> {
        let robot = &self.robots[at];
        let state = &self.state.robots[robot.index as usize];
        let odometry = convert::odometry(&robot.name, state, stamp.clone());
        robot.odometry.send(odometry)
    }

    /// Sends what the run says about a tick: beliefs, scans, transforms, then odometry.
    fn send_data(&mut self, stamp: &Time) -> Result<(), BridgeError> {
        let beliefs = self.beliefs.as_ref().map_or(&[][..], |b| &b.latest);
        for belief in beliefs {
            let about = belief.header.robot;
            if !self.believed.iter().any(|(robot, _)| *robot == about) {
                let name = &self.config.run.robots[about as usize].name;
                let topic = format!("/belief/{}", namespace(name)?);
                self.believed
                    .push((about, self.session.publisher(&topic, false)?));
            }
            let publishers = self.believed.iter().filter(|(robot, _)| *robot == about);
            for (_, publisher) in publishers {
                publisher.send(convert::belief(&belief.elements, stamp.clone()))?;
            }
        }
        let period_s = self.config.step_period();
        for robot in &self.robots {
            let scan = self.scans.as_ref().and_then(|s| s.latest(robot.index));
            if let (Some(publisher), Some(scan)) = (&robot.scan, scan) {
                let scan = convert::scan(&robot.name, scan, stamp.clone(), period_s);
                publisher.send(scan)?;
            }
        }
        let transform = |robot: &Robot| {
            let state = &self.state.robots[robot.index as usize];
            convert::transform(&robot.name, state, stamp.clone())
        };
        let transforms = self.robots.iter().map(transform).collect();
        self.transforms.send(TFMessage { transforms })?;
        for at in 0..self.robots.len() {
            self.send_odometry(at, stamp)?;
        }
        Ok(())
    }
}

/// The namespace of a robot: its name, if ROS 2 accepts it.
fn namespace(name: &str) -> Result<String, BridgeError> {
    let mut letters = name.chars();
    let first = letters
        .next()
        .is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if first && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        Ok(name.to_owned())
    } else {
        Err(BridgeError::Name {
            name: name.to_owned(),
        })
    }
}
