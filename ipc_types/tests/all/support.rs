//! Common parts of the tests of the bus.

use std::time::Duration;

use ipc_types::bus::{Bus, BusOptions, PublisherOptions, RunSpace};
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Drawing, RunSize};

/// A separate run space that is wiped at the end of the test, also after a panic.
pub struct Space(
    pub RunSpace,
    #[expect(dead_code, reason = "removed when dropped")] tempfile::TempDir,
);

impl Space {
    /// Names the space without creating it; names must be unique among the tests of the program.
    pub fn new(name: &str) -> Self {
        let directory = tempfile::Builder::new()
            .prefix("pt")
            .tempdir_in("/tmp")
            .unwrap();
        let prefix = format!("pt_{}_{name}_", std::process::id());
        Self(
            RunSpace::new(directory.path().join("r"), prefix).unwrap(),
            directory,
        )
    }
}

impl Drop for Space {
    fn drop(&mut self) {
        let _ = self.0.wipe();
    }
}

/// A bus for two robots and three processes.
pub fn options(overflow: bool) -> BusOptions {
    BusOptions {
        size: RunSize {
            robots: 2,
            processes: 3,
            events: 1,
        },
        recorder_ticks: 8,
        overflow,
    }
}

/// A bus in memory.
pub fn local(overflow: bool) -> Bus {
    Bus::local(options(overflow))
}

/// Options of a port whose sender does not wait long.
pub fn port(source: u32, capacity: usize) -> PublisherOptions {
    PublisherOptions {
        patience: Duration::from_millis(20),
        ..PublisherOptions::new(source, capacity)
    }
}

/// The header of the state of a tick.
pub fn state(tick: u64) -> WorldHeader {
    let mut header = WorldHeader::default();
    header.stamp.tick = tick;
    header
}

ipc_types::topic! {
    /// A topic of another crate.
    Echoes = "typed/echo": Many, "echoes", PlainHeader, Command,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers(),
        drawing Drawing::points("v", "omega");
    /// The topic of commands with another element, as a process of another build would open it.
    OtherCommands = "robot/command": One, "command", PlainHeader, RobotState,
        simulated true, latched false, timed true,
        may_be_infinite [],
        qos |s| per_tick s.robots, publishers s.processes, subscribers s.readers();
}
