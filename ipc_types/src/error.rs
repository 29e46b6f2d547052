//! What can go wrong on the bus.

use std::path::PathBuf;
use std::time::Duration;

/// Why a run's bus, service or port could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The run's directory or prefix cannot be used.
    #[error("run directory {path}: {reason}")]
    Space {
        /// The directory.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// No node could be created.
    #[error("cannot join the run at {root}: {reason}")]
    Node {
        /// Root path of the run.
        root: PathBuf,
        /// What iceoryx2 said.
        reason: String,
    },
    /// The service could not be created.
    #[error("cannot create the service of topic {topic}: {reason}")]
    Create {
        /// The topic.
        topic: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
    /// The service could not be opened.
    #[error("cannot open topic {topic}: {reason}")]
    Open {
        /// The topic.
        topic: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
    /// Both sides know the topic but not the same message.
    #[error("topic {topic}: this process uses {ours}, but the service was created with {theirs}")]
    Mismatch {
        /// The topic.
        topic: &'static str,
        /// Type, size and schema of this build.
        ours: String,
        /// Type, size and schema of the service.
        theirs: String,
    },
    /// The service has no place for another port.
    #[error("cannot create a {port} of topic {topic}: {reason}")]
    Port {
        /// The topic.
        topic: &'static str,
        /// `publisher`, `subscriber`, …
        port: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
    /// A run in one process has no such thing.
    #[error("{name}: a bus in memory has no {what}, only a run of several processes has")]
    NeedsProcesses {
        /// The service or event.
        name: &'static str,
        /// `servers that are asked for requests` or `events`.
        what: &'static str,
    },
}

/// Why a message was not sent.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    /// The message has more elements than the publisher was opened for.
    #[error("topic {topic}: a message of {elements} elements exceeds the capacity of {capacity}")]
    Capacity {
        /// The topic.
        topic: &'static str,
        /// Elements asked for.
        elements: usize,
        /// Elements that fit.
        capacity: usize,
    },
    /// A receiver did not make room in time.
    #[error("topic {topic}: a receiver did not take its messages for {waited:?}")]
    Blocked {
        /// The topic.
        topic: &'static str,
        /// How long the sender waited.
        waited: Duration,
    },
    /// iceoryx2 failed.
    #[error("topic {topic}: {reason}")]
    Transport {
        /// The topic.
        topic: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
}

/// Why a message was not received.
#[derive(Debug, thiserror::Error)]
pub enum ReceiveError {
    /// iceoryx2 failed.
    #[error("topic {topic}: {reason}")]
    Transport {
        /// The topic.
        topic: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
}
