//! Latency of one message between two processes, over all transports that are compared.
//!
//! The sender ([`Link`]) reads the clock before any work on the message; the receiver ([`fn@sink`])
//! reads it after the whole message has been received. Then the receiver acknowledges on a shared
//! page, and the next message is sent. Sender and receiver are separate processes. Every byte is
//! written.

mod error;
mod pinning;
mod sender;
mod sink;
mod transport;
mod words;

pub use error::LinkError;
pub use pinning::{allowed, pin};
pub use sender::Link;
pub use sink::sink;
pub use transport::raw_node;
pub use words::{LINE, SharedWords, sleep_while, store_and_wake, wake};

use std::path::{Path, PathBuf};

use ipc_types::bus::{BusOptions, RunSpace};
use ipc_types::topics::RunSize;
use serde::{Deserialize, Serialize};

/// Kind of the receiving process, as `protean process` takes it; not available in scenarios.
pub const SINK_KIND: &str = "latency-sink";

/// Transport of a message, and the way in which the receiver waits for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Bare iceoryx2; the receiver polls.
    RawPolled = 1,
    /// Bare iceoryx2; the receiver sleeps on an event.
    RawWoken = 2,
    /// Publisher and subscriber of Protean; the receiver sleeps on a word of shared memory, as
    /// processes of a run do.
    Bus = 3,
    /// A Unix domain stream socket.
    Socket = 4,
    /// A named pipe.
    Pipe = 5,
}

impl Transport {
    /// All transports, in the order of reports.
    pub const ALL: [Self; 5] = [
        Self::RawPolled,
        Self::RawWoken,
        Self::Bus,
        Self::Socket,
        Self::Pipe,
    ];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::RawPolled => "raw iceoryx2, busy poll",
            Self::RawWoken => "raw iceoryx2, event wake-up",
            Self::Bus => "protean, futex wake-up",
            Self::Socket => "Unix domain socket",
            Self::Pipe => "pipe",
        }
    }

    /// Returns the transport with this number on the page.
    fn of_word(word: u32) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|transport| *transport as u32 == word)
    }
}

/// Placement of the two processes on processors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// Decided by the operating system.
    Unpinned,
    /// Both on the same processor.
    OneCore,
    /// Each on its own processor.
    TwoCores,
}

impl Placement {
    /// Returns the placements that this machine supports.
    ///
    /// # Errors
    /// [`LinkError`] if the operating system does not report its processors.
    pub fn possible() -> Result<Vec<Self>, LinkError> {
        let mut placements = vec![Self::Unpinned, Self::OneCore];
        if allowed()?.len() > 1 {
            placements.push(Self::TwoCores);
        }
        Ok(placements)
    }

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unpinned => "unpinned",
            Self::OneCore => "one core",
            Self::TwoCores => "two cores",
        }
    }
}

/// Index of the word of the page for the mode: the [`Transport`] in use; 0: none; [`END`]: the link
/// has ended.
const MODE: usize = 0;
/// Index of the word for the number of messages received.
const RECEIVED: usize = LINE;
/// Index of the word for the latency of the last message (ns).
const LATENCY: usize = 2 * LINE;
/// Index of the word for the number of finished start steps of the receiver.
const READY: usize = 3 * LINE;
/// Index of the word for the number of messages sent.
const SENT: usize = 4 * LINE;
const END: u32 = u32::MAX;

/// Configuration of the receiving process.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SinkConfig {
    root: PathBuf,
    prefix: String,
    /// Maximum payload (bytes).
    most: usize,
    /// Processor of the receiver, if it is pinned.
    processor: Option<usize>,
    /// `true` if a polling receiver yields its processor between polls.
    yields: bool,
}

impl SinkConfig {
    fn load(path: &Path) -> Result<Self, LinkError> {
        std::fs::read(path)
            .and_then(|text| serde_json::from_slice(&text).map_err(Into::into))
            .map_err(LinkError::system(path.display().to_string()))
    }

    fn space(&self) -> Result<RunSpace, LinkError> {
        Ok(RunSpace::new(&self.root, &self.prefix)?)
    }

    fn bus_options() -> BusOptions {
        BusOptions {
            size: RunSize {
                robots: 1,
                processes: 2,
                events: 1,
            },
            recorder_ticks: 2,
            overflow: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transport_is_identified_by_its_word() {
        for transport in Transport::ALL {
            assert_eq!(Transport::of_word(transport as u32), Some(transport));
        }
        assert_eq!(Transport::of_word(0), None);
        assert_eq!(Transport::of_word(END), None);
    }
}
