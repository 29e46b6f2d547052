//! Where a log is played: the bus of a run as its orchestrator makes it, and a voice for everybody
//! who spoke.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusError, BusOptions, Publisher, PublisherOptions, RunSpace};
use ipc_types::bus::{SendError, TopicHolder};
use ipc_types::cdr::{self, DecodeError};
use ipc_types::clock;
use ipc_types::stamp::{Header as _, Stamp};
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};

use super::source::Logged;
use crate::mission::plan::Plan;
use crate::mission::spaces::{self, OwnedSpace};
use crate::mission::{MissionError, create_services, room};
use crate::scenario::ResolvedScenario;

/// How often the dead are looked for: a reader that died must not hold the replay back for long.
const BURIAL_EVERY: Duration = Duration::from_millis(250);

/// How often it is looked whether anybody listens still.
const ATTENTION: Duration = Duration::from_millis(1);

/// Why a message of the log cannot be said again.
#[derive(Debug, thiserror::Error)]
pub(super) enum SayError {
    /// It is not one of its topic.
    #[error(transparent)]
    Decode(#[from] DecodeError),
    /// The topic has no port for its sender.
    #[error(transparent)]
    Port(#[from] BusError),
    /// It was not sent.
    #[error(transparent)]
    Send(#[from] SendError),
}

/// What becomes of the clocks in the stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Clocks {
    /// As they were.
    Recorded,
    /// As if the message had been sent now, what led to it as long before as it was.
    Now,
}

/// Says again what was said on a topic.
trait Voice {
    /// Opens a port for the sender of a message; true if there was none.
    fn open(&mut self, bus: &Bus, source: u32) -> Result<bool, BusError>;
    fn say(&mut self, data: &[u8], clocks: Clocks) -> Result<(), SayError>;
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

    fn say(&mut self, data: &[u8], clocks: Clocks) -> Result<(), SayError> {
        let mut header = cdr::decode_into::<T>(data, &mut self.elements)?;
        if clocks == Clocks::Now {
            renew(header.stamp_mut());
        }
        if let Some(port) = self.ports.get(&header.stamp().source) {
            port.repeat(header, &self.elements)?;
        }
        Ok(())
    }

    fn greet(&self) -> Result<(), SendError> {
        self.ports
            .values()
            .try_for_each(ipc_types::bus::Publisher::update_connections)
    }
}

/// Moves the clocks so that the message is sent now. A clock that never ran stays at 0.
fn renew(stamp: &mut Stamp) {
    let shift = clock::monotonic_ns().wrapping_sub(stamp.sent_ns);
    for clock in stamp.clocks_mut() {
        if *clock != 0 {
            *clock = clock.wrapping_add(shift);
        }
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
    pub(super) fn open(&mut self, bus: &Bus, rank: usize, source: u32) -> Result<bool, BusError> {
        match self.voices.get_mut(rank) {
            Some(voice) => voice.open(bus, source),
            None => Ok(false),
        }
    }

    /// Sends a message; its port must be open.
    pub(super) fn say(&mut self, message: &Logged, clocks: Clocks) -> Result<(), SayError> {
        match self.voices.get_mut(message.rank) {
            Some(voice) => voice.say(&message.data, clocks),
            None => Ok(()),
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
    _undertaker: Undertaker,
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
        let undertaker = Undertaker::start(space.space().clone(), options)?;
        Ok(Self {
            plan,
            bus,
            services,
            _undertaker: undertaker,
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

/// Frees what readers that died have left, on a thread of its own: a sender with a full buffer
/// towards a dead reader waits until somebody does.
struct Undertaker {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Undertaker {
    fn start(space: RunSpace, options: BusOptions) -> Result<Self, MissionError> {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = std::thread::Builder::new()
            .name("undertaker".into())
            .spawn(move || {
                let Ok(bus) = Bus::join(&space, options, "undertaker") else {
                    return;
                };
                while !stopped.load(Ordering::SeqCst) {
                    bus.clean_up_dead();
                    std::thread::park_timeout(BURIAL_EVERY);
                }
            })
            .map_err(|source| MissionError::System {
                what: "cannot start a thread".into(),
                source,
            })?;
        Ok(Self {
            stop,
            thread: Some(thread),
        })
    }
}

impl Drop for Undertaker {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}
