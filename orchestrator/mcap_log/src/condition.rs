//! Condition of a log file.

use std::collections::BTreeMap;

use serde::Serialize;

/// Maximum number of described faults; further ones are only counted.
const MAX_FAULTS: usize = 64;

/// A fault of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// Offset in the file (bytes).
    pub at: u64,
    /// Description of the fault.
    pub what: String,
}

/// Chunks with the same compression.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Chunks {
    /// Number of chunks.
    pub count: u64,
    /// Their size in the file (bytes).
    pub compressed_bytes: u64,
    /// Their contents (bytes).
    pub uncompressed_bytes: u64,
}

/// Condition of a file that has been read to its end.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each describes a different part of the file"
)]
pub struct Condition {
    /// Size of the file (bytes).
    pub file_bytes: u64,
    /// `true` if the file ends with the closing magic bytes of its log.
    pub complete: bool,
    /// `true` if the data section is complete and valid; the summary can be missing.
    pub data: bool,
    /// `true` if the file has a summary.
    pub summary: bool,
    /// `true` if the index lists every chunk, and all messages are in chunks.
    pub index: bool,
    /// Offset of the first incomplete record, if the file is truncated (bytes).
    pub cut_at: Option<u64>,
    /// Number of bytes that follow the end of the log in the file.
    pub following_bytes: u64,
    /// Number of messages according to the summary, if there is one.
    pub claimed_messages: Option<u64>,
    /// Chunks by compression; the empty name means uncompressed.
    pub chunks: BTreeMap<String, Chunks>,
    /// Number of chunks that could not be read or have a wrong checksum.
    pub chunks_lost: u64,
    /// Number of chunks without a checksum.
    pub chunks_unchecked: u64,
    /// Number of verified checksums: of chunks, attachments, the data section and the summary.
    pub checksums: u64,
    /// Number of messages that no checksum covers.
    pub messages_unchecked: u64,
    /// Descriptions of the faults.
    pub faults: Vec<Fault>,
    /// Number of faults that are not described because the list is full.
    pub faults_omitted: u64,
}

impl Condition {
    /// Returns `true` if the whole file could be read.
    pub fn is_whole(&self) -> bool {
        self.complete && self.faults.is_empty()
    }

    /// Returns `true` if no message of the file is missing: the data section is valid, and nothing follows the log.
    pub fn has_all_messages(&self) -> bool {
        self.data && self.following_bytes == 0
    }

    pub(super) fn fault(&mut self, at: u64, what: impl Into<String>) {
        if self.faults.len() < MAX_FAULTS {
            let what = what.into();
            self.faults.push(Fault { at, what });
        } else {
            self.faults_omitted += 1;
        }
    }

    /// Sets `data` at the end of the data section, if nothing before is missing.
    pub(super) fn data_end(&mut self) {
        self.data = self.faults.is_empty();
    }

    /// Returns a line for each fault.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self
            .faults
            .iter()
            .map(|fault| format!("at byte {}: {}", fault.at, fault.what))
            .collect();
        if self.faults_omitted > 0 {
            lines.push(format!("and {} more faults", self.faults_omitted));
        }
        lines
    }
}
