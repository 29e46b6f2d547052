//! Connects ROS 2 nodes to a run: its topics out, commands of the robots in.

use core::time::Duration;
use std::time::Instant;

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::WorldHeader;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Commands, MeasuredPoses};
use ros_messages::messages::{Clock as RosClock, Time};
use runtime::declaration::{Declaration, Flow, Input, Output, When};
use runtime::inputs::reply_stamp;
use runtime::{Clock, Process, ProcessConfig, ProcessError, ProcessKind};

use crate::answers::{Answers, RobotCommand};
use crate::convert;
use crate::data::{RunTopics, read_by_name};
use crate::error::BridgeError;
use crate::params::{CommandType, Order, Ros2BridgeParams};
use crate::session::{Kept, RosPublisher, Session};
use crate::source::Sources;

/// Pause between two looks at the nodes of a domain.
const LOOK: Duration = Duration::from_millis(20);
/// Time for which the first state waits for its answers before it is sent again: the other side of a connection
/// may not have found its writer yet.
const FIRST_ANSWER: Duration = Duration::from_secs(2);

/// A robot that ROS 2 nodes steer.
struct Robot {
    index: usize,
    answers: Answers,
}

/// The process of kind `ros2_bridge`.
pub struct Ros2BridgeProcess {
    config: ProcessConfig,
    params: Ros2BridgeParams,
    topics: RunTopics,
    commands: Option<Publisher<Commands>>,
    robots: Vec<Robot>,
    sources: Option<Sources>,
    clock: RosPublisher<RosClock>,
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

    fn declare(params: &Ros2BridgeParams) -> Declaration {
        let declared = Declaration::default()
            .reads(Input::STATE)
            .reads(Input::MAP)
            .reads(Input::SCANS.optional())
            .reads(Input::BELIEFS.optional())
            .reads_named(read_by_name(params));
        let declared = match params.commands {
            CommandType::None => declared,
            _ => declared.writes(Output::new::<Commands>(1)),
        };
        match params.source.len() {
            0 => declared,
            sources => declared
                .reads(Input::new(Flow::for_topic::<Commands>(), When::Event))
                .writes(Output::new::<MeasuredPoses>(sources)),
        }
    }

    fn open(
        config: &ProcessConfig,
        params: &Ros2BridgeParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let mut session = Session::join(params.domain, &config.name, params.loopback)?;
        let topics = RunTopics::open(config, params, bus, &mut session)?;
        let mut robots = Vec::new();
        for (index, _) in config.own_robots() {
            let index = index as usize;
            let topic = topics.robots[index].namespace.topic("cmd_vel");
            if let Some(answers) = Answers::open(&mut session, topic, params.commands)? {
                robots.push(Robot { index, answers });
            }
        }
        let commands = PublisherOptions::new(config.index, 1);
        Ok(Self {
            commands: (!robots.is_empty())
                .then(|| bus.publisher(commands))
                .transpose()?,
            sources: Sources::open(config, params, bus, &mut session)?,
            clock: session.publisher("/clock", Kept::Nothing)?,
            last: Time::default(),
            has_answer: false,
            config: config.clone(),
            params: params.clone(),
            topics,
            robots,
            session,
        })
    }
}

impl Process for Ros2BridgeProcess {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.topics.connect()?;
        if let Some(commands) = &self.commands {
            commands.update_connections()?;
        }
        if let Some(sources) = &self.sources {
            sources.connect()?;
        }
        Ok(())
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.topics.send_first()?;
        if self.config.run.clock == Clock::LockStep {
            self.wait_for_nodes()?;
        }
        if let Some(sources) = &mut self.sources {
            sources.wait()?;
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let clock = self.config.run.clock;
        let begun = Instant::now();
        self.topics.state.take_turn(tick, clock)?;
        let header = self.topics.state.header;
        let received_ns = self.topics.receive(tick)?;
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
        self.topics.send(&stamp)?;
        if self.params.order == Order::DataFirst {
            self.clock.send(RosClock {
                clock: stamp.clone(),
            })?;
        }
        let header_out = PlainHeader {
            stamp: reply_stamp(&header, received_ns),
        };
        if let Some(sources) = &mut self.sources {
            sources.measure(header_out.stamp)?;
        }
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
                    robot: self.robots[at].index as u32,
                    reserved: 0,
                };
                if let Some(commands) = &self.commands {
                    commands.send(header_out, &[command])?;
                }
            }
        }
        if let Some(sources) = &mut self.sources {
            // Half of a step is left for the messages on their way.
            let until = begun + Duration::from_secs_f64(self.config.step_period() / 2.0);
            sources.steer(tick, &self.last, until)?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.topics.rejected()
    }
}

impl Ros2BridgeProcess {
    /// Waits until each robot has a node that reads its odometry and writes its commands.
    fn wait_for_nodes(&self) -> Result<(), BridgeError> {
        let timeout = Duration::from_secs_f64(self.params.start_timeout_s);
        let until = Instant::now() + timeout;
        for robot in &self.robots {
            let topics = &self.topics.robots[robot.index];
            loop {
                let is_written = robot.answers.is_written(&self.session)?;
                let is_read = topics
                    .odometry
                    .as_ref()
                    .is_some_and(|out| out.readers(&self.session) > 0);
                if is_written && is_read {
                    break;
                }
                if Instant::now() >= until {
                    let odometry = topics.namespace.topic("odom");
                    let answers = &robot.answers;
                    return Err(answers.no_node(&self.session, odometry, !is_written, timeout));
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
                        let index = self.robots[at].index;
                        self.topics.send_odometry(index, stamp)?;
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
}
