//! Heartbeat: the state of a process, on `process/status`.

use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusError, Publisher, PublisherOptions, SendError};
use ipc_types::messages::process::ProcessStatus;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::Status;

/// Maximum time between two heartbeats.
pub const HEARTBEAT_INTERVAL: Duration = Duration::from_millis(100);

/// Publishes the status of a process.
#[derive(Debug)]
pub struct Heartbeat {
    publisher: Publisher<Status>,
    status: ProcessStatus,
    tick_period_ns: u64,
    last: Option<Instant>,
}

impl Heartbeat {
    /// Opens `process/status` for the process with this index.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn open(bus: &Bus, process: u32, tick_period_ns: u64) -> Result<Self, BusError> {
        Ok(Self {
            publisher: bus.publisher(PublisherOptions::new(process, 1))?,
            status: ProcessStatus {
                process,
                ..ProcessStatus::default()
            },
            tick_period_ns,
            last: None,
        })
    }

    /// Connects to the orchestrator.
    ///
    /// # Errors
    /// [`SendError`] if the transport fails.
    pub fn connect(&self) -> Result<(), SendError> {
        self.publisher.update_connections()
    }

    /// Counts a finished step.
    pub fn stepped(&mut self, duration_ns: u64, overruns: u64, rejected: u64) {
        self.status.ticks += 1;
        self.status.step_last_ns = duration_ns;
        self.status.step_max_ns = self.status.step_max_ns.max(duration_ns);
        self.status.step_total_ns = self.status.step_total_ns.saturating_add(duration_ns);
        self.status.overruns = overruns;
        self.status.rejected = rejected;
    }

    /// Returns `true` if a heartbeat is due. It reads the clock: call it between steps only.
    pub fn is_due(&self) -> bool {
        self.is_due_at(Instant::now())
    }

    /// Returns `true` if a heartbeat is due at a given moment.
    pub fn is_due_at(&self, now: Instant) -> bool {
        self.last
            .is_none_or(|last| now.saturating_duration_since(last) >= HEARTBEAT_INTERVAL)
    }

    /// Sends a heartbeat that belongs to tick `tick` (the current or the next one).
    ///
    /// # Errors
    /// [`SendError`] if the transport fails.
    pub fn send_if_due(
        &mut self,
        tick: u64,
        phase: u32,
        error: Option<&str>,
    ) -> Result<(), SendError> {
        self.status.phase = phase;
        if let Some(error) = error {
            self.status.set_error(error);
        }
        self.status.resident_bytes = resident_bytes();
        self.last = Some(Instant::now());
        let mut header = PlainHeader::default();
        header.stamp.tick = tick;
        header.stamp.time_ns = tick.saturating_mul(self.tick_period_ns);
        self.publisher.send(header, &[self.status]).map(drop)
    }
}

/// Returns the resident memory of this process (bytes); 0 if the system does not report it.
fn resident_bytes() -> u64 {
    std::fs::read_to_string("/proc/self/statm")
        .ok()
        .and_then(|text| text.split_whitespace().nth(1)?.parse::<u64>().ok())
        .map_or(0, |pages| pages * rustix::param::page_size() as u64)
}
