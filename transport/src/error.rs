//! Errors of the bus.

use std::path::PathBuf;
use std::time::Duration;

/// Reason why a run's bus, service or port could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The run's directory or prefix is invalid.
    #[error("run directory {path}: {reason}")]
    Space {
        /// The directory.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// No node could be created.
    #[error("cannot join the run at {root}: {reason}")]
    Node {
        /// Root path of the run.
        root: PathBuf,
        /// Error of iceoryx2.
        reason: String,
    },
    /// The service could not be created.
    #[error("cannot create the service of topic {topic}: {reason}")]
    Create {
        /// The topic.
        topic: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
    /// The service could not be opened.
    #[error("cannot open topic {topic}: {reason}")]
    Open {
        /// The topic.
        topic: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
    /// Both sides know the topic but with different messages.
    #[error("topic {topic}: this process uses {ours}, but the service was created with {theirs}")]
    Mismatch {
        /// The topic.
        topic: &'static str,
        /// Type, size and schema of this build.
        ours: String,
        /// Type, size and schema of the service.
        theirs: String,
    },
    /// The service has no free port.
    #[error("cannot create a {port} of topic {topic}: {reason}")]
    Port {
        /// The topic.
        topic: &'static str,
        /// `publisher`, `subscriber`, …
        port: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
    /// A run in one process does not have it.
    #[error("{name}: a bus in memory has no {what}, only a run of several processes has them")]
    NeedsProcesses {
        /// The service or event.
        name: &'static str,
        /// `servers that are asked for requests` or `events`.
        what: &'static str,
    },
}

/// Reason why a message was not sent.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    /// The message exceeds the capacity of the publisher.
    #[error("topic {topic}: a message of {elements} elements exceeds the capacity of {capacity}")]
    Capacity {
        /// The topic.
        topic: &'static str,
        /// Actual number of elements.
        elements: usize,
        /// Capacity (elements).
        capacity: usize,
    },
    /// A receiver did not make room in time.
    #[error("topic {topic}: a receiver did not take its messages for {waited:?}")]
    Blocked {
        /// The topic.
        topic: &'static str,
        /// Time that the sender waited.
        waited: Duration,
    },
    /// iceoryx2 failed.
    #[error("topic {topic}: {reason}")]
    Transport {
        /// The topic.
        topic: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
}

/// Reason why a message was not received.
#[derive(Debug, thiserror::Error)]
pub enum ReceiveError {
    /// iceoryx2 failed.
    #[error("topic {topic}: {reason}")]
    Transport {
        /// The topic.
        topic: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
}
