//! How processes are and what the run tells them.

use iceoryx2::prelude::ZeroCopySend;

use crate::message;

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
    /// The last error; empty if none. Bytes that are not UTF-8 are replaced.
    pub fn error_text(&self) -> String {
        let end = self
            .error
            .iter()
            .position(|&b| b == 0)
            .unwrap_or(self.error.len());
        String::from_utf8_lossy(&self.error[..end]).into_owned()
    }

    /// Stores an error text, cut at the last whole character that fits.
    pub fn set_error(&mut self, text: &str) {
        let mut end = text.len().min(self.error.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        self.error.fill(0);
        self.error[..end].copy_from_slice(&text.as_bytes()[..end]);
    }
}

message! {
    /// What the orchestrator tells the run, in `run/control`.
    pub struct RunControl = "protean/RunControl" {
        rate: f64 = "real-time factor; 0 in lock-step",
        command: u32 = "0 ready, 1 start, 2 pause, 3 step, 4 stop",
        reserved: u32 = "always 0",
    }
}

impl RunControl {
    /// `command` with which time starts.
    pub const START: u32 = 1;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_texts_are_cut_at_a_character() {
        let mut status = ProcessStatus::default();
        status.set_error("short");
        assert_eq!(status.error_text(), "short");
        status.set_error(&"ä".repeat(150));
        assert_eq!(status.error_text(), "ä".repeat(96));
        status.set_error("");
        assert_eq!(status.error_text(), "");
    }
}
