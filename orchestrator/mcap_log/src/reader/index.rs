//! Index of the chunks at the end of a file.

use std::collections::BTreeSet;
use std::os::unix::fs::FileExt as _;

use mcap::records::op;

use super::super::fields::Fields;
use super::Reader;
use super::limits::MAX_DESCRIPTION_BYTES;
use super::record::PREFIX;
use crate::LogReadError;

/// Index entry of a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChunkPlace {
    /// Offset in the file (bytes).
    pub at: u64,
    /// Log time of its first message (ns).
    pub start: u64,
    /// Log time of its last message (ns).
    pub end: u64,
    /// Channels of its messages; empty if unknown.
    channels: BTreeSet<u16>,
}

impl ChunkPlace {
    fn read(body: &[u8]) -> Option<Self> {
        let mut fields = Fields(body);
        let (start, end, at) = (fields.u64()?, fields.u64()?, fields.u64()?);
        fields.u64()?;
        let length = fields.u32()? as usize;
        let mut offsets = Fields(fields.bytes(length)?);
        let mut channels = BTreeSet::new();
        while !offsets.0.is_empty() {
            channels.insert(offsets.u16()?);
            offsets.u64()?;
        }
        Some(Self {
            at,
            start,
            end,
            channels,
        })
    }

    /// Returns `true` if the chunk may contain messages of this channel.
    pub fn may_hold(&self, channel: u16) -> bool {
        self.channels.is_empty() || self.channels.contains(&channel)
    }
}

impl Reader<'_> {
    /// Reads the index at the end of the file, with its schemas and channels; returns `None` if there is no
    /// valid one. Keeps the read position, but discards an open chunk.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn index(&mut self) -> Result<Option<Vec<ChunkPlace>>, LogReadError> {
        let next = self.offset();
        let index = self.read_index();
        self.jump(next);
        index
    }

    fn read_index(&mut self) -> Result<Option<Vec<ChunkPlace>>, LogReadError> {
        // Footer and closing magic bytes.
        let mut tail = [0; PREFIX as usize + 20 + 8];
        let Some(footer) = self.length.checked_sub(tail.len() as u64) else {
            return Ok(None);
        };
        self.file
            .read_exact_at(&mut tail, footer)
            .map_err(|e| self.failed(e))?;
        let mut fields = Fields(&tail);
        let mut read = || {
            let opcode = *fields.bytes(1)?.first()?;
            let length = fields.u64()?;
            let start = fields.u64()?;
            fields.u64()?;
            let crc = fields.u32()?;
            (opcode == op::FOOTER && length == 20 && fields.0 == mcap::MAGIC)
                .then_some((start, crc))
        };
        let Some((start, crc)) = read() else {
            return Ok(None);
        };
        if start < 8 || start >= footer || footer - start > MAX_DESCRIPTION_BYTES as u64 {
            return Ok(None);
        }
        let mut summary = vec![0; (footer - start) as usize];
        self.file
            .read_exact_at(&mut summary, start)
            .map_err(|e| self.failed(e))?;
        // The checksum covers the footer up to the checksum itself.
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&summary);
        hasher.update(tail.get(..PREFIX as usize + 16).unwrap_or_default());
        if crc != 0 && hasher.finalize() != crc {
            return Ok(None);
        }
        let mut chunks = Vec::new();
        let mut at = 0;
        while let Some(rest) = summary.get(at..).filter(|rest| !rest.is_empty()) {
            let mut fields = Fields(rest);
            let prefix = fields.bytes(1).and_then(|opcode| {
                let length = usize::try_from(fields.u64()?).ok()?;
                Some((*opcode.first()?, length))
            });
            let Some((opcode, length)) = prefix.filter(|(_, length)| *length <= fields.0.len())
            else {
                return Ok(None);
            };
            let body = at + PREFIX as usize;
            match opcode {
                op::SCHEMA | op::CHANNEL => {
                    self.buffer.clear();
                    self.buffer
                        .extend_from_slice(summary.get(body..body + length).unwrap_or_default());
                    self.record(opcode, 0..length, start + at as u64)?;
                }
                op::CHUNK_INDEX => {
                    let place = fields.bytes(length).and_then(ChunkPlace::read);
                    let Some(place) = place.filter(|place| place.at < start) else {
                        return Ok(None);
                    };
                    chunks.push(place);
                }
                _ => {}
            }
            at = body + length;
        }
        chunks.sort_by_key(|chunk| chunk.at);
        Ok((!chunks.is_empty()).then_some(chunks))
    }
}
