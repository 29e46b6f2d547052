//! One message from one process to another: over our publisher and subscriber, bare iceoryx2, a Unix
//! domain socket or a pipe, the receiver polling or asleep, on cores of our choice.
//!
//! The sender ([`Link`]) takes the clock before it does anything for the message, the receiver
//! ([`sink`]) when it has all of it in hands; then it says so on a shared page and the next message
//! goes out. Both are real processes. Blocks of different [`Way`]s take turns, so that what else the
//! machine does is in all of them.

mod blocks;
mod crowd;
mod sender;
mod sink;
mod transport;

pub use blocks::{Blocks, OfWay};
pub use crowd::crowd;
pub use sender::{Link, Taken};
pub use sink::sink;

use std::path::PathBuf;

use ipc_types::bus::{BusOptions, RunSpace};
use ipc_types::topics::RunSize;
use serde::{Deserialize, Serialize};

use super::BenchError;
use super::shared::LINE;

/// What carries the bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Carrier {
    /// Our publisher and subscriber.
    Ours = 1,
    /// Bare iceoryx2.
    Raw = 2,
    /// A Unix domain stream socket.
    Socket = 3,
    /// A pipe.
    Pipe = 4,
}

/// What the receiver does until a message comes, and the sender until it has arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Idle {
    /// Asks again and again.
    Spin = 1,
    /// Asks again and again, and lets others run in between.
    Yield = 2,
    /// Sleeps on a word of shared memory, as processes of a run do.
    Futex = 3,
    /// Sleeps on an event of iceoryx2.
    Event = 4,
    /// Sleeps in reading a socket or a pipe.
    Read = 5,
}

/// One way for a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Way {
    /// What carries it.
    pub carrier: Carrier,
    /// What the receiver does until it comes.
    pub idle: Idle,
    /// Whether every byte is written; if not, memory is handed over as it is.
    pub written: bool,
}

impl Way {
    /// A way on which every byte is written.
    pub fn new(carrier: Carrier, idle: Idle) -> Self {
        Self {
            carrier,
            idle,
            written: true,
        }
    }

    /// The same, with memory handed over as it is.
    #[must_use]
    pub fn untouched(self) -> Self {
        Self {
            written: false,
            ..self
        }
    }

    /// What it is called in reports.
    pub fn name(self) -> String {
        let carrier = match self.carrier {
            Carrier::Ours => "protean",
            Carrier::Raw => "raw iceoryx2",
            Carrier::Socket => return "Unix domain socket".to_owned(),
            Carrier::Pipe => return "pipe".to_owned(),
        };
        let idle = match self.idle {
            Idle::Spin => "busy poll",
            Idle::Yield => "poll and yield",
            Idle::Futex => "futex wake-up",
            Idle::Event | Idle::Read => "event wake-up",
        };
        format!("{carrier}, {idle}")
    }

    /// As a word of the page.
    fn word(self) -> u32 {
        self.carrier as u32 | (self.idle as u32) << 8
    }

    /// What a word of the page says; the receiver does not care who writes what.
    fn of_word(word: u32) -> Option<Self> {
        let carrier = match word & 0xff {
            1 => Carrier::Ours,
            2 => Carrier::Raw,
            3 => Carrier::Socket,
            4 => Carrier::Pipe,
            _ => return None,
        };
        let idle = match word >> 8 {
            1 => Idle::Spin,
            2 => Idle::Yield,
            3 => Idle::Futex,
            4 => Idle::Event,
            5 => Idle::Read,
            _ => return None,
        };
        Some(Self::new(carrier, idle))
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
    /// What it is called in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unpinned => "unpinned",
            Self::OneCore => "one core",
            Self::TwoCores => "two cores",
        }
    }
}

/// How a link is laid out.
#[derive(Debug, Clone, Copy)]
pub struct LinkOptions {
    /// Largest payload [bytes].
    pub most: usize,
    /// Subscribers beside the one that is measured: processes of their own, which sleep.
    pub crowd: usize,
    /// On which processors.
    pub placement: Placement,
}

/// What the receiver does: 0 nothing, or a [`Way`], or the end.
const MODE: usize = 0;
/// Messages received so far.
const RECEIVED: usize = LINE;
/// How long the last one took [ns].
const LATENCY: usize = 2 * LINE;
/// How many processes have opened their ports.
const READY: usize = 3 * LINE;
/// Messages sent so far.
const SENT: usize = 4 * LINE;
const END: u32 = u32::MAX;

/// Name of the event that wakes the receiver.
const EVENT: &str = "bench/link";

/// What the processes of a link are told.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SinkConfig {
    root: PathBuf,
    prefix: String,
    /// Processes beside sender and receiver.
    crowd: usize,
    most: usize,
    processor: Option<usize>,
}

impl SinkConfig {
    fn load(path: &std::path::Path) -> Result<Self, BenchError> {
        let failed = BenchError::system(format!("{}", path.display()));
        std::fs::read(path)
            .and_then(|text| serde_json::from_slice(&text).map_err(Into::into))
            .map_err(failed)
    }

    fn space(&self) -> Result<RunSpace, BenchError> {
        Ok(RunSpace::new(&self.root, &self.prefix)?)
    }

    fn bus_options(&self) -> BusOptions {
        BusOptions {
            size: RunSize {
                robots: 1,
                processes: 2 + self.crowd,
                events: 1,
            },
            recorder_ticks: 2,
            // Sleepers never read.
            overflow: self.crowd > 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_survives_the_page() {
        for carrier in [Carrier::Ours, Carrier::Raw, Carrier::Socket, Carrier::Pipe] {
            for idle in [
                Idle::Spin,
                Idle::Yield,
                Idle::Futex,
                Idle::Event,
                Idle::Read,
            ] {
                let way = Way::new(carrier, idle);
                assert_eq!(Way::of_word(way.word()), Some(way));
            }
        }
        assert_eq!(Way::of_word(0), None);
        assert_eq!(Way::of_word(END), None);
    }
}
