//! What the supervisor hands on to the log: which processes left and came back, and what all of them
//! wrote to stderr.

use std::sync::mpsc::{self, Receiver, SyncSender};
use std::time::Duration;

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::process::{LogHeader, ProcessEvent};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{ProcessEvents, ProcessLog};

use super::error::MissionError;
use super::stderr_lines::{StderrLine, TEXT_BYTES};

/// Lines that may wait for the supervisor's next look.
const WAITING: usize = 4096;
/// Most lines that are handed on at one look, so that a process that writes without end does not
/// keep the supervisor from the others.
const AT_ONCE: usize = 1024;
/// How long a reader may take to make room before a line is left out.
const PATIENCE: Duration = Duration::from_millis(100);

/// Tells the log of the processes.
pub(super) struct Chronicle {
    events: Publisher<ProcessEvents>,
    lines: Publisher<ProcessLog>,
    heard: Receiver<StderrLine>,
    ear: SyncSender<StderrLine>,
    tick_period_ns: u64,
}

impl Chronicle {
    /// Opens its topics for the process with index `source`.
    pub(super) fn open(bus: &Bus, source: u32, tick_period_ns: u64) -> Result<Self, MissionError> {
        let options = |capacity: usize| PublisherOptions {
            patience: PATIENCE,
            ..PublisherOptions::new(source, capacity)
        };
        let (ear, heard) = mpsc::sync_channel(WAITING);
        Ok(Self {
            events: bus.publisher(options(1))?,
            lines: bus.publisher(options(TEXT_BYTES))?,
            heard,
            ear,
            tick_period_ns,
        })
    }

    /// Connects to the recorder.
    pub(super) fn connect(&self) -> Result<(), MissionError> {
        self.events.update_connections()?;
        Ok(self.lines.update_connections()?)
    }

    /// Where the processes' lines go.
    pub(super) fn ear(&self) -> SyncSender<StderrLine> {
        self.ear.clone()
    }

    fn stamp(&self, tick: u64) -> Stamp {
        Stamp {
            tick,
            time_ns: tick.saturating_mul(self.tick_period_ns),
            ..Stamp::default()
        }
    }

    /// Hands on the lines that came, in tick `tick`.
    pub(super) fn hand_on(&self, tick: u64) {
        for line in self.heard.try_iter().take(AT_ONCE) {
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

    /// Tells what became of a process, in tick `now`.
    pub(super) fn tell(&self, now: u64, event: ProcessEvent) {
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
