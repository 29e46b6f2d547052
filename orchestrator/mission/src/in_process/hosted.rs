//! External programs of a run in one thread: each is a child in a run of its own.
//!
//! The private run has the bus, barrier and supervision of a run with processes. In a tick the child gets all messages that
//! its topics have on the bus in memory, takes its step, and what it has sent is sent again there.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use ipc_types::bus::{
    AnyMessage, AnyPublisher, AnySubscriber, AnyTopic, Bus, BusError, BusOptions, LOOP_TICKS,
};
use ipc_types::topics::TopicId;
use runtime::{Process, ProcessError};

use super::super::error::MissionError;
use super::super::plan::{Launch, Plan, answering};
use super::super::resources::RunResources;
use super::super::stepped_processes::SteppedProcesses;

/// Settings of all external programs of a run.
#[derive(Debug)]
pub(super) struct Host {
    pub(super) hang_timeout: Duration,
    /// `true` to show their output.
    pub(super) echo: bool,
    pub(super) interrupted: Arc<AtomicBool>,
}

/// An external program, with those that answer its requests.
pub(super) struct Hosted {
    /// First, so that they end first.
    processes: SteppedProcesses,
    /// Its index, and those of the others.
    own: u32,
    indices: Vec<u32>,
    /// The bus of the run in one thread, muted before the branch that the program belongs to.
    bus: Bus,
    to_it: Relay,
    from_it: Relay,
    /// Must be last: the ports are closed before the private run is removed.
    resources: Rc<RunResources>,
}

impl Hosted {
    /// Starts the program of a process; `all` are the processes of the run.
    pub(super) fn start(
        launch: &Launch,
        all: &[Launch],
        bus: Bus,
        host: &Host,
    ) -> Result<Self, MissionError> {
        let asking = std::slice::from_ref(launch);
        let mut launches: Vec<Launch> = answering(asking, all).cloned().collect();
        launches.push(launch.clone());
        let plan = Plan {
            run: launch.config.run.clone(),
            launches,
            obstacle_changes: Vec::new(),
            standing: Vec::new(),
        };
        let resources = Rc::new(RunResources::of_plan(plan, |bus| BusOptions {
            // All is carried in its tick, and buffers of publishers that grow take much memory.
            recorder_ticks: LOOP_TICKS,
            ..bus
        })?);
        let launches = resources.plan.launches.clone();
        let indices = launches.iter().map(|launch| launch.config.index).collect();
        let processes = SteppedProcesses::start(
            &resources,
            launches,
            host.hang_timeout,
            host.echo,
            &host.interrupted,
        )?;
        Ok(Self {
            processes,
            own: launch.config.index,
            indices,
            bus,
            to_it: Relay::default(),
            from_it: Relay::default(),
            resources,
        })
    }

    fn carry_to_it(&mut self) -> Result<(), MissionError> {
        let indices = &self.indices;
        let is_meant = |source| !indices.contains(&source);
        self.to_it.carry(&self.resources.bus, is_meant)
    }

    fn carry_from_it(&mut self) -> Result<(), MissionError> {
        self.from_it.carry(&self.bus, |source| source == self.own)
    }

    fn connect_both(&mut self) -> Result<(), MissionError> {
        if self.processes.open()? {
            // Nothing has been sent on the bus in memory yet.
            let resources = &self.resources;
            self.to_it = Relay::open(&self.bus, |topic| resources.is_heard(topic))?;
            // All that the private run has can then be from its own processes.
            self.from_it = Relay::open(&resources.bus, |_| true)?;
            self.processes.connect()?;
            self.from_it.connect()?;
        }
        Ok(())
    }

    fn prepare_it(&mut self) -> Result<(), MissionError> {
        self.carry_to_it()?;
        self.processes.prepare()?;
        self.carry_from_it()
    }

    fn step_it(&mut self, tick: u64) -> Result<(), MissionError> {
        self.carry_to_it()?;
        self.processes.step(tick)?;
        self.carry_from_it()
    }
}

impl Process for Hosted {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.connect_both().map_err(outside)
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        self.prepare_it().map_err(outside)
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.step_it(tick).map_err(outside)
    }
}

fn outside(error: MissionError) -> ProcessError {
    ProcessError::Outside(Box::new(error))
}

/// Sends the messages of the simulated history on one bus again on another.
#[derive(Default)]
struct Relay {
    topics: Vec<(AnyTopic, Box<dyn AnySubscriber>)>,
    /// By topic and sender.
    publishers: BTreeMap<(TopicId, u32), Box<dyn AnyPublisher>>,
    message: Vec<u8>,
}

impl Relay {
    /// Subscribes to these topics.
    fn open(bus: &Bus, is_meant: impl Fn(TopicId) -> bool) -> Result<Self, MissionError> {
        let topics = AnyTopic::all().into_iter();
        let topics = topics.filter(|topic| topic.id.facts().simulated && is_meant(topic.id));
        let topics = topics.map(|topic| Ok((topic, topic.recorder(bus)?)));
        Ok(Self {
            topics: topics.collect::<Result<_, BusError>>()?,
            ..Self::default()
        })
    }

    fn connect(&self) -> Result<(), MissionError> {
        let mut topics = self.topics.iter();
        Ok(topics.try_for_each(|(_, topic)| topic.update_connections())?)
    }

    /// Sends what has come from these processes since the last call.
    fn carry(&mut self, to: &Bus, is_meant: impl Fn(u32) -> bool) -> Result<(), MissionError> {
        for (topic, subscriber) in &self.topics {
            let mut carry = |message: &AnyMessage<'_>| -> Result<(), MissionError> {
                let source = message.stamp.source;
                if !is_meant(source) {
                    return Ok(());
                }
                let publisher = match self.publishers.entry((topic.id, source)) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => new.insert(topic.repeater(to, source)?),
                };
                self.message.clear();
                message.encode(&mut self.message);
                publisher.repeat(&self.message)?;
                Ok(())
            };
            let mut carried = Ok(());
            subscriber.drain(usize::MAX, &mut |message| {
                if carried.is_ok() {
                    carried = carry(message);
                }
            })?;
            carried?;
        }
        Ok(())
    }
}
