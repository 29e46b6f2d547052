//! Messages of the supervisor for the log: which processes left and came back, and what all of them wrote to stderr.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::time::Duration;

use ipc_types::bus::{Publisher, PublisherOptions};
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{ProcessEvents, ProcessLog};

use super::error::MissionError;
use super::recorder_thread::DrainRequests;
use super::resources::RunResources;
use super::stderr_lines::{StderrLine, TEXT_BYTES};

/// Lines that may wait for the supervisor's next look.
const MAX_WAITING: usize = 4096;
/// Most lines that are sent at one look, so that a process that writes without end does not keep the supervisor from
/// the others.
const MAX_AT_ONCE: usize = 1024;
/// Longest wait for a subscriber without room before a line is left out.
const PATIENCE: Duration = Duration::from_millis(100);

/// The publishers of process events and lines, and the recorder that takes them.
pub(super) struct ProcessEventLog {
    events: Publisher<ProcessEvents>,
    lines: Publisher<ProcessLog>,
    line_receiver: Receiver<StderrLine>,
    line_sender: SyncSender<StderrLine>,
    recorder: Arc<DrainRequests>,
    tick_period_ns: u64,
}

impl ProcessEventLog {
    /// Opens the topics; `recorder` is to take what a process has sent before it is cleaned up.
    ///
    /// # Errors
    /// [`MissionError`] if they cannot be opened.
    pub(super) fn open(
        resources: &RunResources,
        recorder: Arc<DrainRequests>,
    ) -> Result<Self, MissionError> {
        let (bus, plan) = (&resources.bus, &resources.plan);
        let options = |capacity: usize| PublisherOptions {
            patience: PATIENCE,
            ..PublisherOptions::new(plan.orchestrator_index(), capacity)
        };
        let (line_sender, line_receiver) = mpsc::sync_channel(MAX_WAITING);
        Ok(Self {
            events: bus.publisher(options(1))?,
            lines: bus.publisher(options(TEXT_BYTES))?,
            line_receiver,
            line_sender,
            recorder,
            tick_period_ns: plan.run.tick_period_ns,
        })
    }

    /// Connects to the recorder.
    pub(super) fn connect(&self) -> Result<(), MissionError> {
        self.events.update_connections()?;
        Ok(self.lines.update_connections()?)
    }

    /// The sender for the lines of the processes.
    pub(super) fn line_sender(&self) -> SyncSender<StderrLine> {
        self.line_sender.clone()
    }

    /// Lets the recorder take what has been sent.
    pub(super) fn drain(&self) {
        self.recorder.drain();
    }

    fn stamp(&self, tick: u64) -> Stamp {
        Stamp {
            tick,
            time_ns: tick.saturating_mul(self.tick_period_ns),
            ..Stamp::default()
        }
    }

    /// Sends the lines that came, in tick `tick`.
    pub(super) fn forward_lines(&self, tick: u64) {
        for line in self.line_receiver.try_iter().take(MAX_AT_ONCE) {
            let header = LogHeader {
                stamp: self.stamp(tick),
                process: line.slot as u32,
                level: level_of(&line.text),
            };
            // A log that lacks a line is no reason to end a run, and a recorder that has failed
            // ends it by itself.
            let _ = self.lines.send(header, line.text.as_bytes());
        }
    }

    /// Sends an event of a process, in tick `now`.
    pub(super) fn publish_event(&self, now: u64, event: ProcessEvent) {
        let stamp = self.stamp(now);
        if let Err(error) = self.events.send(PlainHeader { stamp }, &[event]) {
            tracing::warn!("process/event: {error}");
        }
    }
}

/// How severe a line is, by its first word as our own processes write it.
fn level_of(line: &str) -> u32 {
    match line.split_whitespace().next().unwrap_or_default() {
        "TRACE" | "DEBUG" => 1,
        "INFO" => 2,
        "WARN" | "warning:" => 3,
        "ERROR" | "error:" | "Error:" => 4,
        _ if line.contains("panicked at") => 4,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_our_own_processes_lines() {
        assert_eq!(level_of(" WARN the map has too many pieces"), 3);
        assert_eq!(level_of("ERROR it is the turn of tick 3"), 4);
        assert_eq!(level_of("thread 'main' panicked at src/x.rs:3:1:"), 4);
        assert_eq!(level_of("Traceback (most recent call last):"), 0);
        assert_eq!(level_of(""), 0);
    }
}
