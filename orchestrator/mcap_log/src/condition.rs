//! In what condition a log is.

use std::collections::BTreeMap;

use serde::Serialize;

/// Most faults that are described; more are only counted.
const MAX_FAULTS: usize = 64;

/// Something that is wrong with a file, and what of it could not be read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// Where in the file (bytes).
    pub at: u64,
    /// What is wrong, for people.
    pub what: String,
}

/// Chunks with the same compression.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Chunks {
    /// How many.
    pub count: u64,
    /// Their size in the file (bytes).
    pub compressed_bytes: u64,
    /// Their contents (bytes).
    pub uncompressed_bytes: u64,
}

/// In what condition a file is that has been read to its end.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each says of another part of the file whether it is there"
)]
pub struct Condition {
    /// Size of the file (bytes).
    pub file_bytes: u64,
    /// Whether the file ends as an MCAP file does.
    pub complete: bool,
    /// Whether all its data are there and hold: only the summary can be missing.
    pub data: bool,
    /// Whether it has a summary.
    pub summary: bool,
    /// Whether every chunk is in its index.
    pub index: bool,
    /// Where the first record begins that is not whole, if the file ends in the middle (bytes).
    pub cut_at: Option<u64>,
    /// Messages that the file says it holds; only in a summary.
    pub claimed_messages: Option<u64>,
    /// Chunks by compression; the empty name stands for none.
    pub chunks: BTreeMap<String, Chunks>,
    /// Chunks that could not be read, or whose checksum does not fit.
    pub chunks_lost: u64,
    /// Chunks without a checksum.
    pub chunks_unchecked: u64,
    /// What is wrong.
    pub faults: Vec<Fault>,
    /// Faults that the list leaves out because it is full.
    pub faults_omitted: u64,
}

impl Condition {
    /// Whether everything that was ever written could be read.
    pub fn is_whole(&self) -> bool {
        self.complete && self.faults.is_empty()
    }

    pub(super) fn fault(&mut self, at: u64, what: impl Into<String>) {
        if self.faults.len() < MAX_FAULTS {
            let what = what.into();
            self.faults.push(Fault { at, what });
        } else {
            self.faults_omitted += 1;
        }
    }

    /// What the data section held is all there, if it ends here.
    pub(super) fn data_end(&mut self) {
        self.data = self.faults.is_empty();
    }

    /// What is missing or wrong, a line each, for people.
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
