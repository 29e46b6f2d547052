//! The bus of one run: its isolation, and the ports of its topics.
//!
//! The orchestrator *creates* every service and holds it for the whole run; every other process only
//! *opens* services. (A process killed during service creation would leave an unusable service;
//! processes that only open can die at any time.) A run has its own iceoryx2 prefix and root path:
//! services of two runs do not see each other.
//!
//! A run in one thread has a bus in memory with the same ports ([`Bus::local`]).

mod any_message;
mod any_queue;
mod any_topic;
mod inbox;
mod local;
mod publisher;
mod raw;
mod request_response;
mod subscriber;

pub use crate::transport::error::{BusError, ReceiveError, SendError};
pub use crate::transport::{
    Listener, MemoryUse, Notifier, RunSpace, TopicHolder, TransportConfig, quiet_transport,
};
pub use any_message::{AnyMessage, AnyPublisher, AnySubscriber, SharedElements};
pub use any_topic::AnyTopic;
pub use inbox::{Arrivals, Inbox};
pub use publisher::{Publisher, PublisherOptions};
pub use raw::RawPublisher;
pub use request_response::{ActiveRequest, Attendant, Client, PendingResponse, Server};
pub use subscriber::{ReceivedMessage, Subscriber};

use core::cell::{Cell, RefCell};
use std::rc::Rc;

use crate::clock::{StampClock, StepStart};
use crate::schema;
use crate::topics::{MAX_EVENT_ID, Qos, RunSize, Service, Topic, TopicFacts};
use crate::transport::{self, Home, Limits, TopicIdentity};
use local::LocalTopics;

/// Layout of the buffers of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BusOptions {
    /// Numbers of robots, processes and events of the run.
    pub size: RunSize,
    /// Number of ticks that the recorder may lag before it blocks the simulator (lock-step) or loses
    /// messages (real time), ≥ 2.
    pub recorder_ticks: usize,
    /// `true` if a full buffer drops its oldest message (real time) instead of blocking the sender
    /// (lock-step).
    pub overflow: bool,
}

/// Number of nodes of a run with this many processes: one each and one of its successor after a crash,
/// the orchestrator's, its recorder's, and the external subscribers'.
fn nodes(size: &RunSize) -> usize {
    2 * size.processes + 2 + crate::topics::EXTERNAL_SUBSCRIBERS
}

/// Size of the buffer with which a subscriber holds `ticks` ticks of one publisher.
fn buffer(qos: &Qos, ticks: usize) -> usize {
    qos.per_tick.saturating_mul(ticks).max(2)
}

fn agreed<'a>(topic: &'static str, schema: &'a str) -> TopicIdentity<'a> {
    TopicIdentity { topic, schema }
}

/// Header and elements of an answer, copied from shared memory.
pub type Answer<S> =
    crate::transport::Answer<<S as Service>::ResponseHeader, <S as Service>::ResponseElement>;

/// Number of ticks that a process in the loop may leave unread without losing messages or blocking.
pub const LOOP_TICKS: usize = 4;

/// A process's connection to the topics of one run.
#[derive(Debug)]
pub struct Bus {
    backend: Backend,
    options: BusOptions,
    turn: StepStart,
    /// The inbox of the process that opens its ports now.
    inbox: RefCell<Option<Rc<Inbox>>>,
    /// The mute of the process that opens its ports now.
    mute: RefCell<Option<Rc<Cell<bool>>>>,
}

#[derive(Debug)]
enum Backend {
    Ipc {
        node: Box<dyn Home>,
        space: RunSpace,
    },
    Local(Rc<LocalTopics>),
}

impl Bus {
    /// Joins the run as the process with this name (shown by iceoryx2's own tools).
    ///
    /// # Errors
    /// [`BusError::Node`] if iceoryx2 cannot create a node there.
    pub fn join(space: &RunSpace, options: BusOptions, process: &str) -> Result<Self, BusError> {
        let node = transport::join(space, nodes(&options.size), process)?;
        Ok(Self {
            backend: Backend::Ipc {
                node,
                space: space.clone(),
            },
            options,
            turn: StepStart::default(),
            inbox: RefCell::default(),
            mute: RefCell::default(),
        })
    }

    /// Creates the bus of a run whose processes are all in this thread. It reads no clock: the
    /// clocks in the stamps of its messages are 0.
    pub fn local(options: BusOptions) -> Self {
        Self {
            backend: Backend::Local(Rc::default()),
            options,
            turn: StepStart::default(),
            inbox: RefCell::default(),
            mute: RefCell::default(),
        }
    }

    /// Opens ports for a process with an inbox: its inputs get their messages from there, and its outputs belong to the
    /// tick of the inbox.
    pub fn through<R>(&self, inbox: &Rc<Inbox>, open: impl FnOnce() -> R) -> R {
        let before = self.inbox.replace(Some(Rc::clone(inbox)));
        let opened = open();
        self.inbox.replace(before);
        opened
    }

    /// Opens ports for a process in this thread whose messages reach no subscriber while `mute` is set. Afterwards they continue
    /// the sequence numbers of the process with the same index, whose ports are closed by then.
    pub fn muted<R>(&self, mute: &Rc<Cell<bool>>, open: impl FnOnce() -> R) -> R {
        self.mute.replace(Some(Rc::clone(mute)));
        let opened = open();
        self.mute.replace(None);
        opened
    }

    /// Returns another handle of a bus in memory, with the mute of the process that opens its ports now; `None` for a bus
    /// between processes.
    pub fn handle(&self) -> Option<Self> {
        let Backend::Local(topics) = &self.backend else {
            return None;
        };
        Some(Self {
            backend: Backend::Local(Rc::clone(topics)),
            options: self.options,
            turn: self.turn.clone(),
            inbox: RefCell::default(),
            mute: self.mute.clone(),
        })
    }

    /// Returns `true` if the run is in one thread ([`Bus::local`]).
    pub fn is_local(&self) -> bool {
        matches!(self.backend, Backend::Local(_))
    }

    /// The clock for the stamps of this run's messages.
    pub fn clock(&self) -> StampClock {
        match self.backend {
            Backend::Ipc { .. } => StampClock::MONOTONIC,
            Backend::Local(_) => StampClock::STANDING,
        }
    }

    /// Marks the begin of a step of this process: all later messages of its publishers carry the
    /// time.
    pub fn begin_turn(&self) {
        self.turn.set(self.clock().now_ns());
    }

    /// The run space; `None` for a run in memory.
    pub fn space(&self) -> Option<&RunSpace> {
        match &self.backend {
            Backend::Ipc { space, .. } => Some(space),
            Backend::Local(_) => None,
        }
    }

    /// Layout of the buffers.
    pub fn options(&self) -> &BusOptions {
        &self.options
    }

    /// Frees shared memory of dead processes of the run; returns the number of cleaned nodes.
    ///
    /// Call it at once after the death of a process: a sender with a full buffer towards a dead
    /// receiver waits until then.
    pub fn clean_up_dead(&self) -> u64 {
        match &self.backend {
            Backend::Ipc { node, .. } => node.clean_up_dead(),
            Backend::Local(_) => 0,
        }
    }

    /// The node of a bus between processes; an error for a bus in memory.
    fn node(&self, name: &'static str, what: &'static str) -> Result<&dyn Home, BusError> {
        match &self.backend {
            Backend::Ipc { node, .. } => Ok(&**node),
            Backend::Local(_) => Err(BusError::NeedsProcesses { name, what }),
        }
    }

    /// Creates the service of a topic and holds it (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the topic and the reason.
    pub fn create<T: Topic>(&self) -> Result<TopicHolder, BusError> {
        match &self.backend {
            Backend::Ipc { node, .. } => {
                let limits = self.limits(T::FACTS);
                let schema = schema::hash::<T>();
                (T::ports().create)(node.node(), &agreed(T::NAME, &schema), &limits)
            }
            // The local topics hold it already.
            Backend::Local(local_topics) => {
                local_topics.channel::<T::Header, T::Element>(T::FACTS, &self.options)?;
                Ok(TopicHolder::new(T::NAME, ()))
            }
        }
    }

    /// Limits of the service of a topic.
    fn limits(&self, facts: &TopicFacts) -> Limits {
        let qos = (facts.qos)(&self.options.size);
        Limits {
            history: qos.history,
            buffer: buffer(&qos, self.options.recorder_ticks.max(LOOP_TICKS)),
            publishers: qos.publishers,
            subscribers: qos.subscribers,
            nodes: nodes(&self.options.size),
            overflow: self.options.overflow,
        }
    }

    /// Creates a request–response service with its events, and holds them (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the service or event and the reason.
    pub fn create_service<S: Service>(&self) -> Result<Vec<TopicHolder>, BusError> {
        match &self.backend {
            Backend::Ipc { node, .. } => {
                let size = &self.options.size;
                // A process that drives several robots may have one request for each.
                let clients = size.processes + size.robots + 1;
                let layout = request_response::layout::<S>();
                let agreed = agreed(S::NAME, &layout);
                let service = (S::ports().create)(node.node(), &agreed, clients, nodes(size))?;
                let events = [
                    self.create_event(S::ASKED)?,
                    self.create_event(S::ANSWERED)?,
                ];
                Ok([service].into_iter().chain(events).collect())
            }
            // The local topics hold it already.
            Backend::Local(local_topics) => {
                local_topics.endpoint::<S>()?;
                Ok(vec![TopicHolder::new(S::NAME, ())])
            }
        }
    }

    /// Creates a wake-up event and holds it (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the event and the reason; [`BusError::NeedsProcesses`] on a bus in
    /// memory.
    pub fn create_event(&self, name: &'static str) -> Result<TopicHolder, BusError> {
        let node = self.node(name, "events")?.node();
        let nodes = nodes(&self.options.size);
        // A process that drives several robots may have one port for each.
        let ports = nodes + self.options.size.robots;
        transport::create_event(node, name, ports, nodes, MAX_EVENT_ID)
    }

    /// Opens a topic for publishing.
    ///
    /// # Errors
    /// [`BusError::Open`] if the service is missing, [`BusError::Mismatch`] if this build and the
    /// service's creator disagree on its type (names both), [`BusError::Port`] if it has no free
    /// publisher.
    pub fn publisher<T: Topic>(&self, options: PublisherOptions) -> Result<Publisher<T>, BusError> {
        let opened = match &self.backend {
            Backend::Ipc { node, .. } => {
                Publisher::open(&**node, &self.options, options, self.turn.clone())
            }
            Backend::Local(local_topics) => {
                let mute = self.mute.borrow().clone();
                Publisher::open_local(local_topics, &self.options, options, mute)
            }
        };
        Ok(opened?.dated_by(self.inbox.borrow().clone()))
    }

    /// Opens a topic for reading with the buffer of a process in the loop.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn subscriber<T: Topic>(&self) -> Result<Subscriber<T>, BusError> {
        let subscriber = self.subscribe(LOOP_TICKS)?;
        Ok(match &*self.inbox.borrow() {
            Some(inbox) => subscriber.through(inbox),
            None => subscriber,
        })
    }

    /// Opens a topic for reading with the deep buffer of the recorder.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn recorder<T: Topic>(&self) -> Result<Subscriber<T>, BusError> {
        self.subscribe(self.options.recorder_ticks)
    }

    fn subscribe<T: Topic>(&self, ticks: usize) -> Result<Subscriber<T>, BusError> {
        match &self.backend {
            Backend::Ipc { node, .. } => Subscriber::open(&**node, &self.options, ticks),
            Backend::Local(local_topics) => {
                Subscriber::open_local(local_topics, &self.options, ticks)
            }
        }
    }

    /// Opens a client of a request–response service, for the process with index `source` and
    /// requests of up to `capacity` elements.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn client<S: Service>(&self, source: u32, capacity: usize) -> Result<Client<S>, BusError> {
        let client = match &self.backend {
            Backend::Ipc { node, .. } => Client::open(&**node, source, capacity)?,
            Backend::Local(local_topics) => {
                Client::open_local(local_topics.endpoint()?, source, capacity)
            }
        };
        Ok(client.dated_by(self.inbox.borrow().clone()))
    }

    /// Opens a server of a request–response service, for the process with index `source` and answers
    /// of up to `capacity` elements.
    ///
    /// # Errors
    /// As [`Bus::publisher`]; [`BusError::NeedsProcesses`] on a bus in memory; use [`Bus::attend`]
    /// there.
    pub fn server<S: Service>(&self, source: u32, capacity: usize) -> Result<Server<S>, BusError> {
        let node = self.node(S::NAME, "servers that are asked for requests")?;
        Server::open(node, source, capacity)
    }

    /// Answers the requests of a service on a bus in memory, each at once.
    ///
    /// # Errors
    /// [`BusError::Port`] if the service has a server already, or the bus is between processes.
    pub fn attend<S: Service>(
        &self,
        handler: impl FnMut(&S::RequestHeader, &[S::RequestElement]) -> Answer<S> + 'static,
    ) -> Result<Attendant<S>, BusError> {
        let Backend::Local(local_topics) = &self.backend else {
            return Err(BusError::Port {
                topic: S::NAME,
                port: "attendant",
                reason: "only a bus in memory calls who answers".to_owned(),
            });
        };
        let endpoint = local_topics.endpoint::<S>()?;
        endpoint.serve(Box::new(handler))?;
        Ok(Attendant::new(endpoint))
    }

    /// Opens the notifying side of an event.
    ///
    /// # Errors
    /// As [`Bus::publisher`]; [`BusError::NeedsProcesses`] on a bus in memory.
    pub fn notifier(&self, name: &'static str) -> Result<Notifier, BusError> {
        Notifier::open(self.node(name, "events")?.node(), name)
    }

    /// Opens the waiting side of an event.
    ///
    /// # Errors
    /// As [`Bus::publisher`]; [`BusError::NeedsProcesses`] on a bus in memory.
    pub fn listener(&self, name: &'static str) -> Result<Listener, BusError> {
        Listener::open(self.node(name, "events")?.node(), name)
    }
}
