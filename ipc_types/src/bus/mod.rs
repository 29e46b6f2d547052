//! The bus of one run: its isolation, and the ports of its topics.
//!
//! The orchestrator *creates* every service and holds it for the whole run; every other process
//! only *opens* (a process killed inside service creation would leave a wreck that nobody can
//! open; open-only processes can die at any moment). A run has its own iceoryx2 prefix and root
//! path: services of two runs do not see each other.

mod error;
mod event;
mod publisher;
mod request_response;
mod run_space;
mod service;
mod subscriber;

pub use error::{BusError, ReceiveError, SendError};
pub use event::{Listener, Notifier};
pub use publisher::{Publisher, PublisherOptions};
pub use request_response::{ActiveRequest, Answer, Client, PendingResponse, Server};
pub use run_space::RunSpace;
pub use service::TopicHolder;
pub use subscriber::{Received, Subscriber};

use iceoryx2::prelude::{Config, Node, NodeBuilder, NodeName, SignalHandlingMode, ipc};

use crate::topics::{RunSize, Service, Topic};

/// How the buffers of a run are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BusOptions {
    /// Robots, processes and events of the run.
    pub size: RunSize,
    /// Ticks that the recorder may lag behind before it must hold the simulator back (lock-step)
    /// or would lose messages (real time), ≥ 2.
    pub recorder_ticks: usize,
    /// Whether a full buffer drops its oldest message (real time) instead of blocking the sender
    /// (lock-step).
    pub overflow: bool,
}

/// Nodes that the orchestrator's own process joins with: itself, its recorder, its bridge.
const OWN_NODES: usize = 3;

/// Ticks that a process in the loop may have unread without losing or blocking.
pub const LOOP_TICKS: usize = 4;

/// A process's connection to the services of one run.
#[derive(Debug)]
pub struct Bus {
    node: Node<ipc::Service>,
    space: RunSpace,
    options: BusOptions,
}

impl Bus {
    /// Joins the run as the process with this name (shown by iceoryx2's own tools).
    ///
    /// # Errors
    /// [`BusError::Node`] if iceoryx2 cannot create a node there.
    pub fn join(space: &RunSpace, options: BusOptions, process: &str) -> Result<Self, BusError> {
        let failed = |reason: String| BusError::Node {
            root: space.root().to_owned(),
            reason,
        };
        let name = NodeName::new(process).map_err(|e| failed(format!("{e:?}")))?;
        let node = NodeBuilder::new()
            .config(&space.config()?)
            .name(&name)
            // The processes handle their signals themselves.
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<ipc::Service>()
            .map_err(|e| failed(format!("{e:?}")))?;
        Ok(Self {
            node,
            space: space.clone(),
            options,
        })
    }

    /// Where the run lives.
    pub fn space(&self) -> &RunSpace {
        &self.space
    }

    /// How its buffers are laid out.
    pub fn options(&self) -> &BusOptions {
        &self.options
    }

    /// Frees what dead processes of the run left in shared memory; returns how many were cleaned.
    ///
    /// Needed at once when a process died: a sender with a full buffer towards a dead receiver
    /// waits until then.
    pub fn clean_up_dead(&self) -> u64 {
        self.node.try_cleanup_dead_nodes().cleanups
    }

    /// Creates the service of a topic and holds it (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the topic and the reason.
    pub fn create<T: Topic>(&self) -> Result<TopicHolder, BusError> {
        service::create::<T>(&self.node, &self.options)
    }

    /// Creates a request–response service and holds it (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the service and the reason.
    pub fn create_service<S: Service>(&self) -> Result<TopicHolder, BusError> {
        request_response::create::<S>(&self.node, &self.options)
    }

    /// Creates a wake-up event and holds it (orchestrator only).
    ///
    /// # Errors
    /// [`BusError::Create`] names the event and the reason.
    pub fn create_event(&self, name: &'static str) -> Result<TopicHolder, BusError> {
        event::create(&self.node, &self.options, name)
    }

    /// Opens a topic for publishing.
    ///
    /// # Errors
    /// [`BusError::Open`] if the service is missing, [`BusError::Mismatch`] if this build and the
    /// service's creator disagree on its type (names both), [`BusError::Port`] if it has no free
    /// publisher.
    pub fn publisher<T: Topic>(&self, options: PublisherOptions) -> Result<Publisher<T>, BusError> {
        Publisher::open(&self.node, &self.options, options)
    }

    /// Opens a topic for reading with the buffer of a process in the loop.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn subscriber<T: Topic>(&self) -> Result<Subscriber<T>, BusError> {
        Subscriber::open(&self.node, &self.options, LOOP_TICKS)
    }

    /// Opens a topic for reading with the deep buffer of the recorder.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn recorder<T: Topic>(&self) -> Result<Subscriber<T>, BusError> {
        Subscriber::open(&self.node, &self.options, self.options.recorder_ticks)
    }

    /// Opens the asking side of a request–response service.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn client<S: Service>(&self, capacity: usize) -> Result<Client<S>, BusError> {
        Client::open(&self.node, capacity)
    }

    /// Opens the answering side of a request–response service.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn server<S: Service>(&self, capacity: usize) -> Result<Server<S>, BusError> {
        Server::open(&self.node, capacity)
    }

    /// Opens the waking side of an event.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn notifier(&self, name: &'static str) -> Result<Notifier, BusError> {
        Notifier::open(&self.node, name)
    }

    /// Opens the waiting side of an event.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn listener(&self, name: &'static str) -> Result<Listener, BusError> {
        Listener::open(&self.node, name)
    }
}

/// The iceoryx2 configuration type, for tools that look at a run from outside.
pub type TransportConfig = Config;

/// Lets iceoryx2 report errors only; its warnings speak of what the run space does on purpose.
pub fn quiet_transport() {
    iceoryx2::prelude::set_log_level(iceoryx2::prelude::LogLevel::Error);
}
