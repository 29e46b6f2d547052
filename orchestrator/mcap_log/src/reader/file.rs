//! Reader of the records of a file up to the closing magic bytes or the end of the file.

use std::ops::Range;
use std::os::unix::fs::FileExt as _;

use mcap::records::op;

use super::Reader;
use super::item::ItemLocation;
use super::limits::MAX_RECORD_BYTES;
use super::record::{PREFIX, name_of};
use crate::LogReadError;

/// Size of the magic bytes at both ends of a log (bytes).
pub const MAGIC_BYTES: u64 = 8;

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
                "the closing magic bytes"
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
    pub(super) fn footer(
        &mut self,
        summary_start: u64,
        at: u64,
        crc: u32,
    ) -> Result<(), LogReadError> {
        self.condition.summary = summary_start != 0;
        self.condition.index =
            summary_start != 0 && self.indexed_chunks == self.chunks && !self.loose;
        self.summary = (summary_start != 0 && crc != 0).then(|| {
            (
                self.start.saturating_add(summary_start)..at + PREFIX + 16,
                crc,
            )
        });
        self.done = true;
        if let (Some(claimed), Some(read)) = (self.condition.claimed_messages, self.messages)
            && claimed > read
            && self.condition.data
        {
            self.condition.data = false;
            let what = format!("the summary counts {claimed} messages, {read} are there");
            self.condition.fault(at, what);
        }
        let there = self.length.saturating_sub(self.next);
        if there < MAGIC_BYTES {
            self.cut(self.next, "the closing magic bytes");
            // Read again if the file grows.
            self.next = at;
            return Ok(());
        }
        if !self.is_magic(self.next)? {
            let what = "the closing magic bytes do not follow the footer";
            self.condition.fault(self.next, what);
            self.condition.following_bytes = there;
            return Ok(());
        }
        let end = self.next + MAGIC_BYTES;
        let more = self.length - end;
        self.condition.complete = more == 0;
        if more > 0 {
            self.condition.following_bytes = more;
            self.following = self.is_magic(end)?.then_some(end);
            let what = match self.following {
                Some(_) => format!("another log follows the end of this one ({more} bytes)"),
                None => format!("{more} bytes follow the end of the log: they are not read"),
            };
            self.condition.fault(end, what);
        }
        Ok(())
    }

    /// Returns `true` if the magic bytes of a log are here.
    pub(super) fn is_magic(&self, at: u64) -> Result<bool, LogReadError> {
        let mut magic = [0; MAGIC_BYTES as usize];
        if self.length.saturating_sub(at) < MAGIC_BYTES {
            return Ok(false);
        }
        self.file
            .read_exact_at(&mut magic, at)
            .map_err(|e| self.failed(e))?;
        Ok(magic.as_slice() == mcap::MAGIC)
    }

    /// Records that the file ends in the middle of the part that begins at `at`.
    pub(super) fn cut(&mut self, at: u64, what: &str) {
        self.condition.cut_at = Some(at);
        self.condition.fault(
            at,
            format!(
                "the file ends {}: the run was killed or is not over yet, or the copy is incomplete",
                match self.length.saturating_sub(at) {
                    0 => format!("before {what}"),
                    there => format!("in the middle of {what} ({there} bytes of it are there)"),
                }
            ),
        );
        self.done = true;
    }

    /// Verifies the checksums of the whole data section and of the summary, if there are any. Call it at the end.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn check_all(&mut self) -> Result<(), LogReadError> {
        if let Some((end, crc)) = self.data_end.filter(|(_, crc)| *crc != 0) {
            if self.hash(self.start..end)? == crc {
                self.condition.checksums += 1;
                self.condition.messages_unchecked = 0;
            } else {
                self.condition.data = false;
                self.condition.fault(
                    end,
                    "the checksum of the data section does not match: the data have changed",
                );
            }
        }
        if let Some((place, crc)) = self.summary.clone() {
            if self.hash(place.clone())? == crc {
                self.condition.checksums += 1;
            } else {
                let what = "the checksum of the summary does not match: the index has changed";
                self.condition.fault(place.start, what);
            }
        }
        Ok(())
    }

    /// Returns the checksum of a part of the file.
    fn hash(&mut self, place: Range<u64>) -> Result<u32, LogReadError> {
        let mut hasher = crc32fast::Hasher::new();
        let mut block = vec![0; 1 << 20];
        let mut at = place.start;
        while at < place.end {
            let wanted = block.len().min((place.end - at) as usize);
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
        Ok(hasher.finalize())
    }
}
