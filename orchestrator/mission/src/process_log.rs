//! Messages of the supervisor for the log: exits and restarts of processes, and their output.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::time::Duration;

use ipc_types::bus::{Publisher, PublisherOptions};
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{ProcessEvents, ProcessLog};
use platform::output_lines::{MAX_TEXT_BYTES, OutputLine, begins_panic};

use super::error::MissionError;
use super::launch::Launch;
use super::plan::Plan;
use super::recorder_thread::DrainRequests;
use super::resources::RunResources;
use scenario::ScenarioRemark;

/// Maximum number of lines that wait for the next check of the supervisor.
const MAX_WAITING: usize = 4096;
/// Maximum number of lines sent in one check, so that a process that writes without end does not delay the
/// supervision of the others.
const MAX_AT_ONCE: usize = 1024;
/// Maximum wait for a subscriber without room; after that the line is dropped.
const MAX_WAIT: Duration = Duration::from_millis(100);

/// Publishers of process events and lines, and access to the recorder.
pub(super) struct ProcessEventLog {
    events: Publisher<ProcessEvents>,
    lines: Publisher<ProcessLog>,
    line_receiver: Receiver<OutputLine>,
    line_sender: SyncSender<OutputLine>,
    recorder: Arc<DrainRequests>,
    tick_period_ns: u64,
}

impl ProcessEventLog {
    /// Opens the topics. `recorder` receives all messages of a process before its resources are freed.
    ///
    /// # Errors
    /// [`MissionError`] if the topics cannot be opened.
    pub(super) fn open(
        resources: &RunResources,
        recorder: Arc<DrainRequests>,
    ) -> Result<Self, MissionError> {
        let (bus, plan) = (&resources.bus, &resources.plan);
        let options = |capacity: usize| PublisherOptions {
            patience: MAX_WAIT,
            ..PublisherOptions::new(plan.orchestrator_index(), capacity)
        };
        let (line_sender, line_receiver) = mpsc::sync_channel(MAX_WAITING);
        Ok(Self {
            events: bus.publisher(options(1))?,
            lines: bus.publisher(options(MAX_TEXT_BYTES))?,
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

    /// Returns the sender for the output lines of the processes.
    pub(super) fn line_sender(&self) -> SyncSender<OutputLine> {
        self.line_sender.clone()
    }

    /// Lets the recorder receive all messages sent so far.
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

    /// Sends the received lines in tick `tick`.
    pub(super) fn forward_lines(&self, tick: u64) {
        for line in self.line_receiver.try_iter().take(MAX_AT_ONCE) {
            let header = line_header(self.stamp(tick), &line);
            // A missing line in the log does not justify ending the run. A failed recorder ends the run itself.
            let _ = self.lines.send(header, line.text.as_bytes());
        }
    }

    /// Sends an event of a process in tick `now`.
    pub(super) fn publish_event(&self, now: u64, event: ProcessEvent) {
        let stamp = self.stamp(now);
        if let Err(error) = self.events.send(PlainHeader { stamp }, &[event]) {
            tracing::warn!("process/event: {error}");
        }
    }
}

/// Returns remarks about tasks as lines of their processes.
pub(super) fn remark_lines(plan: &Plan, remarks: &[ScenarioRemark]) -> Vec<OutputLine> {
    let line = |remark: &ScenarioRemark| {
        let (process, robot) = (remark.process.as_ref()?, remark.robot.as_ref()?);
        let of_process = |launch: &&Launch| launch.config.name == *process;
        let slot = plan.launches.iter().find(of_process)?.config.index as usize;
        let text = format!("{}: {robot}: {}", remark.severity, remark.message);
        Some(OutputLine { slot, text })
    };
    remarks.iter().filter_map(line).collect()
}

/// Returns the header of a line in `process/log`.
pub(super) fn line_header(stamp: Stamp, line: &OutputLine) -> LogHeader {
    LogHeader {
        stamp,
        process: line.slot as u32,
        level: level_of(&line.text),
    }
}

/// Returns the severity of a line, by the first word as Protean's processes write it.
fn level_of(line: &str) -> u32 {
    match line.split_whitespace().next().unwrap_or_default() {
        "TRACE" | "DEBUG" => 1,
        "INFO" | "note:" => 2,
        "WARN" | "warning:" => 3,
        "ERROR" | "error:" | "Error:" => 4,
        _ if begins_panic(line) => 4,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_follow_the_first_word_of_a_line() {
        assert_eq!(level_of(" WARN the map has too many pieces"), 3);
        assert_eq!(level_of("ERROR it is the turn of tick 3"), 4);
        assert_eq!(level_of("thread 'main' panicked at src/x.rs:3:1:"), 4);
        assert_eq!(level_of("Traceback (most recent call last):"), 0);
        assert_eq!(level_of("note: guard: α = 1.000 m"), 2);
        assert_eq!(level_of(""), 0);
    }
}
