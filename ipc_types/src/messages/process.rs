//! State of processes, and messages of the run to them.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// Heartbeat of a process, in `process/status`; outside the digest.
    pub struct ProcessStatus = "protean/ProcessStatus" {
        ticks: u64 = "ticks stepped so far",
        step_last_ns: u64 = "duration of the last step [ns]",
        step_max_ns: u64 = "longest step so far [ns]",
        step_total_ns: u64 = "sum of all steps [ns]",
        overruns: u64 = "real time: ticks that came before the last step had ended",
        rejected: u64 = "messages that failed the receiver's checks",
        resident_bytes: u64 = "resident memory of the process [bytes]; 0 if unknown",
        process: u32 = "index of the process in the run",
        phase: u32 = "0 starting, 1 ready, 2 connected, 3 running, 4 stopping, 5 failed",
        error: [u8; 192] = "last error as UTF-8, zero-filled; empty if none",
    }
}

impl ProcessStatus {
    /// Stores an error text, cut at the last whole character that fits.
    pub fn set_error(&mut self, text: &str) {
        store(text, &mut self.error);
    }
}

message! {
    /// Command of the orchestrator to all processes of the run, in `run/control`.
    pub struct RunControl = "protean/RunControl" {
        rate: f64 = "real-time factor; 0 in lock-step",
        command: u32 = "0 ready, 1 start, 2 pause, 3 step, 4 stop",
        reserved: u32 = "always 0",
    }
}

impl RunControl {
    /// `command` at the start of time.
    pub const START: u32 = 1;
}

message! {
    /// A process left the run or came back, in `process/event`; outside the digest.
    pub struct ProcessEvent = "protean/ProcessEvent" {
        tick: u64 = "left: the first tick that it did not do; back: the first that it does again",
        process: u32 = "index of the process in the run",
        kind: u32 = "0 left, 1 back, 2 given up: it will not be started again",
        failures: u32 = "how often it has left so far",
        reserved: u32 = "always 0",
        reason: [u8; 232] = "why, as UTF-8, zero-filled; empty if it came back",
    }
}

impl ProcessEvent {
    /// `kind` of a process that left.
    pub const LEFT: u32 = 0;
    /// `kind` of a process that is back.
    pub const BACK: u32 = 1;
    /// `kind` of a process that will not return.
    pub const GIVEN_UP: u32 = 2;

    /// Reason; empty if the process is back. Bytes that are not UTF-8 are replaced.
    pub fn reason_text(&self) -> String {
        text_of(&self.reason)
    }

    /// Stores the reason, cut at the last whole character that fits.
    pub fn set_reason(&mut self, text: &str) {
        store(text, &mut self.reason);
    }
}

message! {
    /// A line that a process wrote to stderr, in `process/log`; outside the digest. The elements are
    /// its bytes.
    pub struct LogHeader = "protean/LogHeader" {
        stamp: Stamp = "when and by whom it was handed on",
        process: u32 = "index of the process in the run",
        level: u32 = "0 unknown, 1 debug, 2 info, 3 warning, 4 error",
    }
}
headers!(LogHeader);

/// The text in bytes padded with zeros.
fn text_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

/// Stores a text, cut at the last whole character that fits.
fn store(text: &str, bytes: &mut [u8]) {
    let mut end = text.len().min(bytes.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    bytes.fill(0);
    bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_texts_are_cut_at_a_character() {
        let mut status = ProcessStatus::default();
        status.set_error("short");
        assert_eq!(text_of(&status.error), "short");
        status.set_error(&"ä".repeat(150));
        assert_eq!(text_of(&status.error), "ä".repeat(96));
        status.set_error("");
        assert_eq!(text_of(&status.error), "");
    }
}
