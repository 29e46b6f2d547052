//! Where a log is played: the bus of a run as its orchestrator makes it, and a voice for everybody
//! who spoke.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use ipc_types::bus::TopicHolder;
use ipc_types::bus::{Bus, BusError, BusOptions, Publisher, PublisherOptions, SendError};
use ipc_types::cdr;
use ipc_types::stamp::Header as _;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};

use super::super::source::Logged;
use crate::mission::plan::Plan;
use crate::mission::spaces::{self, OwnedSpace};
use crate::mission::{MissionError, create_services, room};
use crate::scenario::ResolvedScenario;

/// How often it is looked whether anybody listens still.
const ATTENTION: Duration = Duration::from_millis(1);

/// Says again what was said on a topic.
trait Voice {
    /// Opens a port for the sender of a message; true if there was none.
    fn open(&mut self, bus: &Bus, source: u32) -> Result<bool, BusError>;
    /// Sends a message, byte for byte; false if it is not one of the topic.
    fn say(&mut self, data: &[u8]) -> Result<bool, SendError>;
    /// Connects to those who came, who get what lasts.
    fn greet(&self) -> Result<(), SendError>;
}

struct TopicVoice<T: Topic> {
    ports: BTreeMap<u32, Publisher<T>>,
    elements: Vec<T::Element>,
}

impl<T: Topic> Voice for TopicVoice<T> {
    fn open(&mut self, bus: &Bus, source: u32) -> Result<bool, BusError> {
        if self.ports.contains_key(&source) {
            return Ok(false);
        }
        let port = bus.publisher(PublisherOptions::growing(source))?;
        self.ports.insert(source, port);
        Ok(true)
    }

    fn say(&mut self, data: &[u8]) -> Result<bool, SendError> {
        let Ok(header) = cdr::decode_into::<T>(data, &mut self.elements) else {
            return Ok(false);
        };
        if let Some(port) = self.ports.get(&header.stamp().source) {
            port.repeat(header, &self.elements)?;
        }
        Ok(true)
    }

    fn greet(&self) -> Result<(), SendError> {
        self.ports
            .values()
            .try_for_each(Publisher::update_connections)
    }
}

/// A voice for every topic.
pub(super) struct Choir {
    voices: Vec<Box<dyn Voice>>,
}

impl Choir {
    pub(super) fn new() -> Self {
        struct Collect(Vec<Box<dyn Voice>>);
        impl TopicVisitor for Collect {
            type Error = core::convert::Infallible;
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
                self.0.push(Box::new(TopicVoice::<T> {
                    ports: BTreeMap::new(),
                    elements: Vec::new(),
                }));
                Ok(())
            }
        }
        let mut collect = Collect(Vec::new());
        let Ok(()) = for_each_topic(&mut collect);
        Self { voices: collect.0 }
    }

    /// Opens the port that a message needs; true if it was not open.
    pub(super) fn open(
        &mut self,
        bus: &Bus,
        rank: usize,
        source: u32,
    ) -> Result<bool, MissionError> {
        match self.voices.get_mut(rank) {
            Some(voice) => Ok(voice.open(bus, source)?),
            None => Ok(false),
        }
    }

    /// Sends a message; its port must be open. False if it is not one of its topic.
    pub(super) fn say(&mut self, message: &Logged) -> Result<bool, MissionError> {
        match self.voices.get_mut(message.rank) {
            Some(voice) => Ok(voice.say(&message.data)?),
            None => Ok(true),
        }
    }

    /// Connects to those who came since the last time.
    pub(super) fn greet(&self) -> Result<(), SendError> {
        self.voices.iter().try_for_each(|voice| voice.greet())
    }
}

/// The bus of a run that is played; everything of it goes when it is dropped.
pub(super) struct Stage {
    pub(super) plan: Plan,
    pub(super) bus: Bus,
    services: Vec<TopicHolder>,
    // Last: nothing of the run may be in use when it is wiped.
    pub(super) space: OwnedSpace,
}

impl Stage {
    /// Makes the run's directory and services, of the size that the scenario asks for. A reader
    /// without room holds the sender back, also where the run itself would have dropped messages.
    pub(super) fn build(scenario: &ResolvedScenario) -> Result<Self, MissionError> {
        let _ = spaces::clean();
        room::check_start()?;
        let space = OwnedSpace::create()?;
        let (root, prefix) = (space.space().root(), space.space().prefix());
        let plan = Plan::new(scenario, root, prefix, "warn")?;
        let options = BusOptions {
            overflow: false,
            ..plan.run.bus_options()
        };
        let bus = Bus::join(space.space(), options, "replay")?;
        let services = create_services(&bus, &plan)?;
        Ok(Self {
            plan,
            bus,
            services,
            space,
        })
    }

    /// Gives those who listen this long, but no longer than there are any: whether they have taken
    /// what was sent, or are connected to who sends it, only they know.
    pub(super) fn attend(&self, limit: Duration) {
        let deadline = Instant::now() + limit;
        while self.services.iter().any(|topic| topic.listeners() > 0) && Instant::now() < deadline {
            std::thread::park_timeout(ATTENTION);
        }
    }

    /// Where it lives.
    pub(super) fn root(&self) -> &Path {
        self.space.space().root()
    }
}
