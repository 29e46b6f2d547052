//! One message from one process to another, over every transport that a mission is compared with.
//!
//! The sender ([`Link`]) reads the clock before it does anything for the message, the receiver
//! ([`fn@sink`]) when it has all of it; then the receiver says so on a shared page and the next message
//! goes out. Both are processes of their own. Every byte is written.

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

/// Kind of the receiving process, as `protean process` takes it. No scenario can ask for it.
pub const SINK_KIND: &str = "latency-sink";

/// What carries a message, and how the receiver waits for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Bare iceoryx2; the receiver asks again and again.
    RawPolled = 1,
    /// Bare iceoryx2; the receiver sleeps on an event.
    RawWoken = 2,
    /// Our publisher and subscriber; the receiver sleeps on a word of shared memory, as processes of
    /// a run do.
    Bus = 3,
    /// A Unix domain stream socket.
    Socket = 4,
    /// A named pipe.
    Pipe = 5,
}

impl Transport {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 5] = [
        Self::RawPolled,
        Self::RawWoken,
        Self::Bus,
        Self::Socket,
        Self::Pipe,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::RawPolled => "raw iceoryx2, busy poll",
            Self::RawWoken => "raw iceoryx2, event wake-up",
            Self::Bus => "protean, futex wake-up",
            Self::Socket => "Unix domain socket",
            Self::Pipe => "pipe",
        }
    }

    /// The transport with this number on the page.
    fn of_word(word: u32) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|transport| *transport as u32 == word)
    }
}

/// On which processors the two processes may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// Wherever the system puts them.
    Unpinned,
    /// Both on the same one.
    OneCore,
    /// Each on one of its own.
    TwoCores,
}

impl Placement {
    /// The placements that this machine allows.
    ///
    /// # Errors
    /// [`LinkError`] if the system does not tell.
    pub fn possible() -> Result<Vec<Self>, LinkError> {
        let mut placements = vec![Self::Unpinned, Self::OneCore];
        if allowed()?.len() > 1 {
            placements.push(Self::TwoCores);
        }
        Ok(placements)
    }

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unpinned => "unpinned",
            Self::OneCore => "one core",
            Self::TwoCores => "two cores",
        }
    }
}

/// Words of the page: the [`Transport`] in use; 0: none; [`END`]: the link is over.
const MODE: usize = 0;
/// Messages received so far.
const RECEIVED: usize = LINE;
/// Latency of the last message (ns).
const LATENCY: usize = 2 * LINE;
/// Steps of its start that the receiver has taken.
const READY: usize = 3 * LINE;
/// Messages sent so far.
const SENT: usize = 4 * LINE;
const END: u32 = u32::MAX;

/// Configuration of the receiving process.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SinkConfig {
    root: PathBuf,
    prefix: String,
    /// Largest payload (bytes).
    most: usize,
    /// Processor of the receiver, if it is pinned.
    processor: Option<usize>,
    /// Whether a receiver that polls gives the processor away in between.
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
    fn a_transport_is_known_by_its_word() {
        for transport in Transport::ALL {
            assert_eq!(Transport::of_word(transport as u32), Some(transport));
        }
        assert_eq!(Transport::of_word(0), None);
        assert_eq!(Transport::of_word(END), None);
    }
}
