//! Reader of the records of a file up to the closing magic bytes or the end of the file.

use std::os::unix::fs::FileExt as _;

use mcap::records::op;

use super::Reader;
use super::item::ItemLocation;
use super::limits::MAX_RECORD_BYTES;
use super::record::{PREFIX, name_of};
use crate::LogReadError;

impl Reader<'_> {
    /// Reads the next record of the file; returns `None` if it contains no item.
    pub(super) fn next_in_file(&mut self) -> Result<Option<ItemLocation>, LogReadError> {
        let at = self.next;
        if let Some(read_progress) = &mut self.read_progress {
            read_progress.at(at)?;
        }
        let mut prefix = [0; PREFIX as usize];
        if self.length.saturating_sub(at) < PREFIX {
            let what = if at >= self.length {
                "the data: the closing magic bytes are missing"
            } else {
                "a record"
            };
            self.cut(at, what);
            return Ok(None);
        }
        self.file
            .read_exact_at(&mut prefix, at)
            .map_err(|e| self.failed(e))?;
        let [opcode, length @ ..] = prefix;
        let length = u64::from_le_bytes(length);
        let body = at + PREFIX;
        let available = self.length - body;
        if opcode == 0 {
            self.condition.fault(
                at,
                format!(
                    "this is not a record: {} bytes are lost",
                    available + PREFIX
                ),
            );
            self.condition.cut_at = Some(at);
            self.done = true;
            return Ok(None);
        }
        if length > available {
            self.cut(at, name_of(opcode));
            return Ok(None);
        }
        self.next = body + length;
        if opcode == op::CHUNK {
            self.chunk(at, length)?;
            return Ok(None);
        }
        // Indexes are only counted, or built anew.
        if matches!(
            opcode,
            op::MESSAGE_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX
        ) {
            return Ok(None);
        }
        if length > MAX_RECORD_BYTES as u64 {
            let what = format!(
                "{} of {length} bytes is skipped: the maximum is {MAX_RECORD_BYTES} bytes",
                name_of(opcode)
            );
            self.condition.fault(at, what);
            return Ok(None);
        }
        self.buffer.resize(length as usize, 0);
        let mut buffer = core::mem::take(&mut self.buffer);
        let read = self.file.read_exact_at(&mut buffer, body);
        self.buffer = buffer;
        read.map_err(|e| self.failed(e))?;
        self.record(opcode, 0..length as usize, at)
    }

    /// Checks that the closing magic bytes follow the footer and end the file.
    pub(super) fn footer(&mut self, summary_start: u64) {
        let mut magic = [0; 8];
        let ends = self.length.saturating_sub(self.next) == 8
            && self.file.read_exact_at(&mut magic, self.next).is_ok()
            && magic.as_slice() == mcap::MAGIC;
        self.condition.summary = summary_start != 0;
        self.condition.index = summary_start != 0 && self.indexed_chunks == self.chunks;
        self.done = true;
        if ends {
            self.condition.complete = true;
        } else if self.length.saturating_sub(self.next) < 8 {
            self.cut(self.next, "the closing magic bytes");
        } else {
            let what = "the closing magic bytes do not follow the footer";
            self.condition.fault(self.next, what);
        }
    }

    /// Records that the file ends in the middle of the part that begins at `at`.
    pub(super) fn cut(&mut self, at: u64, what: &str) {
        self.condition.cut_at = Some(at);
        self.condition.fault(
            at,
            format!(
                "the file ends in the middle of {what} ({} bytes of it are there): the run was \
                 killed or is not over yet, or the copy is incomplete",
                self.length.saturating_sub(at)
            ),
        );
        self.done = true;
    }

    /// Verifies the checksum of the whole data section, if there is one. Call it at the end.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn check_all(&mut self) -> Result<(), LogReadError> {
        let Some((end, expected)) = self.data_end.filter(|(_, crc)| *crc != 0) else {
            return Ok(());
        };
        let mut hasher = crc32fast::Hasher::new();
        let mut block = vec![0; 1 << 20];
        let mut at = 0;
        while at < end {
            let wanted = block.len().min((end - at) as usize);
            let Some(part) = block.get_mut(..wanted) else {
                break;
            };
            self.file
                .read_exact_at(part, at)
                .map_err(|e| self.failed(e))?;
            hasher.update(part);
            at += wanted as u64;
            if let Some(read_progress) = &mut self.read_progress {
                read_progress.at(0)?;
            }
        }
        if hasher.finalize() != expected {
            self.condition.data = false;
            self.condition.fault(
                end,
                "the checksum of the data section does not match: the data have changed",
            );
        }
        Ok(())
    }
}
