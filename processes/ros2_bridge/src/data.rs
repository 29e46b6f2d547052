//! All that the bridge publishes: the run as topics of ROS 2.

use ipc_types::bus::Bus;
use ipc_types::consumer::LoggedMessage;
use ipc_types::event_names::EventNames;
use ipc_types::messages::world::WorldEvent;
use ipc_types::topics::{Belief, Plan, TopicId};
use ros_messages::messages::{
    LaserScan, Log, OccupancyGrid, Odometry, Path, PoseArray, TFMessage, Time,
};
use runtime::declaration::Flow;
use runtime::inputs::{BeliefInput, MapInput, ScanInput, StateInput};
use runtime::raw_inputs::{RawInput, RawInputs};
use runtime::{ProcessConfig, ProcessError};

use crate::convert;
use crate::error::BridgeError;
use crate::named::NamedTopic;
use crate::names::Namespace;
use crate::params::Ros2BridgeParams;
use crate::session::{Kept, RosPublisher, Session};

/// Topics of which each message becomes one of a type of ROS 2.
const CONVERTED: [TopicId; 3] = [TopicId::Plan, TopicId::WorldEvents, TopicId::RobotEvents];

/// A robot of the run.
pub struct RobotTopics {
    /// Names of its topics and frames.
    pub namespace: Namespace,
    /// Publisher of its odometry; `None` for a robot that sends it itself.
    pub odometry: Option<RosPublisher<Odometry>>,
    scan: Option<RosPublisher<LaserScan>>,
    plan: Option<RosPublisher<Path>>,
    /// Publisher of the belief about it.
    belief: Option<RosPublisher<PoseArray>>,
}

/// The messages of a run, and their publishers.
pub struct RunTopics {
    /// State of the world.
    pub state: StateInput,
    map: MapInput,
    scans: Option<ScanInput>,
    beliefs: Option<BeliefInput>,
    /// Plans, events, and the topics of `topics`.
    others: RawInputs,
    /// The robots, by index.
    pub robots: Vec<RobotTopics>,
    transforms: RosPublisher<TFMessage>,
    static_transforms: RosPublisher<TFMessage>,
    grid: RosPublisher<OccupancyGrid>,
    log: RosPublisher<Log>,
    named: Vec<NamedTopic>,
    names: EventNames,
    /// Revision of the map that was sent last.
    sent_map: u32,
    period_s: f64,
}

/// Returns the names of the topics that the bridge reads by their names: those of `topics`, and those converted.
pub fn read_by_name(params: &Ros2BridgeParams) -> impl Iterator<Item = &str> {
    let named = params.topics.iter().map(String::as_str);
    CONVERTED.iter().map(|topic| topic.name()).chain(named)
}

impl RunTopics {
    /// Opens the inputs and the publishers.
    ///
    /// # Errors
    /// [`BridgeError::Create`], [`BridgeError::Name`]; the error of a topic that cannot be opened.
    pub fn open(
        config: &ProcessConfig,
        params: &Ros2BridgeParams,
        bus: &Bus,
        session: &mut Session,
    ) -> Result<Self, ProcessError> {
        let run = &config.run;
        let all = run.robots.len();
        let is_written = |flow| run.capacity(flow).is_some();
        let has_plans = is_written(Flow::for_topic::<Plan>());
        let has_beliefs = is_written(Flow::for_topic::<Belief>());
        let mut robots = Vec::with_capacity(all);
        for robot in &run.robots {
            let namespace = Namespace::new(&robot.name, &params.root)?;
            let nothing = Kept::Nothing;
            let is_simulated = !params.source.contains(&robot.name);
            robots.push(RobotTopics {
                odometry: is_simulated
                    .then(|| session.publisher(&namespace.topic("odom"), nothing))
                    .transpose()?,
                scan: (is_simulated && robot.beams > 0)
                    .then(|| session.publisher(&namespace.topic("scan"), nothing))
                    .transpose()?,
                plan: has_plans
                    .then(|| session.publisher(&namespace.topic("plan"), nothing))
                    .transpose()?,
                belief: has_beliefs
                    .then(|| session.publisher(&format!("/belief/{}", robot.name), nothing))
                    .transpose()?,
                namespace,
            });
        }
        let mut read: Vec<String> = read_by_name(params).map(str::to_owned).collect();
        read.sort_unstable();
        read.dedup();
        let others = RawInputs::open(&read, config, bus)?;
        let named = others.topics().iter().map(RawInput::topic);
        let named = named.filter(|topic| params.topics.iter().any(|name| name == topic.name()));
        let named = named
            .map(|topic| NamedTopic::open(session, topic))
            .collect::<Result<_, _>>()?;
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
            others,
            transforms: session.publisher("/tf", Kept::Nothing)?,
            static_transforms: session.publisher("/tf_static", Kept::Last)?,
            grid: session.publisher("/map", Kept::Last)?,
            log: session.publisher("/rosout", Kept::Events)?,
            named,
            names: EventNames {
                robots: run.robots.iter().map(|robot| robot.name.clone()).collect(),
                ..EventNames::default()
            },
            robots,
            sent_map: 0,
            period_s: config.step_period(),
        })
    }

    /// Connects all inputs.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn connect(&self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.map.connect()?;
        if let Some(scans) = &self.scans {
            scans.connect()?;
        }
        if let Some(beliefs) = &self.beliefs {
            beliefs.connect()?;
        }
        self.others.connect()
    }

    /// Sends what never changes, and the first map.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`]; [`ProcessError`] if the transport fails.
    pub fn send_first(&mut self) -> Result<(), ProcessError> {
        let simulated = self.robots.iter().filter(|robot| robot.odometry.is_some());
        let namespaces = simulated.map(|robot| &robot.namespace);
        self.static_transforms
            .send(convert::static_transforms(namespaces))?;
        self.send_map(Time::default())
    }

    /// Receives the messages of a tick, after its state; returns the monotonic clock at the receipt of the newest (ns).
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn receive(&mut self, tick: u64) -> Result<u64, ProcessError> {
        let mut received_ns = self.state.received_ns;
        if let Some(scans) = &mut self.scans {
            scans.update()?;
            received_ns = received_ns.max(scans.received_ns);
        }
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.update()?;
            received_ns = received_ns.max(beliefs.received_ns);
        }
        self.others.receive(tick)?;
        Ok(received_ns)
    }

    /// Sends the data of a tick: map, beliefs, plans, events, topics by name, scans, transforms, then odometry.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`]; [`ProcessError`] if the transport fails.
    pub fn send(&mut self, stamp: &Time) -> Result<(), ProcessError> {
        self.send_map(stamp.clone())?;
        self.send_beliefs(stamp)?;
        self.send_others(stamp)?;
        for (index, robot) in self.robots.iter().enumerate() {
            let scan = self.scans.as_ref().and_then(|s| s.latest(index as u32));
            if let (Some(publisher), Some(scan)) = (&robot.scan, scan) {
                let frame = robot.namespace.frame("scan");
                publisher.send(convert::scan(frame, scan, stamp.clone(), self.period_s))?;
            }
        }
        let robots = self.robots.iter().zip(&self.state.robots);
        let transforms = robots
            .filter(|(robot, _)| robot.odometry.is_some())
            .map(|(robot, state)| convert::transform(&robot.namespace, state, stamp.clone()))
            .collect();
        self.transforms.send(TFMessage { transforms })?;
        for index in 0..self.robots.len() {
            self.send_odometry(index, stamp)?;
        }
        Ok(())
    }

    /// Sends the odometry of a robot.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`].
    pub fn send_odometry(&self, index: usize, stamp: &Time) -> Result<(), BridgeError> {
        let (Some(robot), Some(state)) = (self.robots.get(index), self.state.robots.get(index))
        else {
            return Ok(());
        };
        let odometry = convert::odometry(&robot.namespace, state, stamp.clone());
        robot
            .odometry
            .iter()
            .try_for_each(|out| out.send(odometry.clone()))
    }

    /// Number of rejected messages so far.
    pub fn rejected(&self) -> u64 {
        self.state.rejected
            + self.map.rejected
            + self.scans.as_ref().map_or(0, |scans| scans.rejected)
            + self.beliefs.as_ref().map_or(0, |beliefs| beliefs.rejected)
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

    fn send_beliefs(&self, stamp: &Time) -> Result<(), BridgeError> {
        let beliefs = self.beliefs.as_ref().map_or(&[][..], |b| &b.latest);
        for belief in beliefs {
            let robot = self.robots.get(belief.header.robot as usize);
            if let Some(publisher) = robot.and_then(|robot| robot.belief.as_ref()) {
                publisher.send(convert::belief(&belief.elements, stamp.clone()))?;
            }
        }
        Ok(())
    }

    fn send_others(&self, stamp: &Time) -> Result<(), BridgeError> {
        for input in self.others.topics() {
            let topic = input.topic();
            let named = self.named.iter().find(|named| named.topic == topic);
            for message in input.messages() {
                let bytes = message.cdr(topic);
                if let Some(named) = named {
                    named.send(&bytes)?;
                }
                let Some(message) = LoggedMessage::new(topic, 0, &bytes) else {
                    continue;
                };
                if let Some((header, points)) = message.view::<Plan>() {
                    let robot = self.robots.get(header.robot as usize);
                    if let Some(publisher) = robot.and_then(|robot| robot.plan.as_ref()) {
                        publisher.send(convert::plan(points, stamp.clone()))?;
                    }
                }
                for event in message.events() {
                    self.log.send(self.line(&event, stamp.clone()))?;
                }
            }
        }
        Ok(())
    }

    /// An event as a line of `/rosout`.
    fn line(&self, event: &WorldEvent, stamp: Time) -> Log {
        /// `INFO` of `rcl_interfaces/Log`.
        const INFO: u8 = 20;
        Log {
            stamp,
            level: INFO,
            name: "world".to_owned(),
            msg: self.names.words(event),
            ..Log::default()
        }
    }
}
