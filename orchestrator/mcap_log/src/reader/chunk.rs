//! Reader of chunks: loads, checks and decompresses a chunk, and reads its records.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::os::unix::fs::FileExt as _;

use lz4_flex::frame::FrameDecoder;

use super::super::fields::Fields;
use super::Reader;
use super::item::ItemLocation;
use super::limits::MAX_RECORD_BYTES;
use super::record::PREFIX;
use crate::LogReadError;

/// Size of a chunk record before the name of its compression (bytes).
const CHUNK_FIXED: usize = 32;
/// Maximum length of the name of a compression (bytes).
const MAX_COMPRESSION_NAME: usize = 64;

/// The chunk that is being read.
#[derive(Debug, Clone, Copy)]
pub struct OpenChunk {
    /// Offset of the next record in its contents (bytes).
    next: usize,
    /// Offset in the file (bytes).
    pub(super) at: u64,
    /// `true` if it has a checksum.
    pub(super) checked: bool,
}

impl Reader<'_> {
    /// Returns the next record of the open chunk; `None` after the last one.
    pub(super) fn next_in_chunk(&mut self) -> Result<Option<ItemLocation>, LogReadError> {
        let Some(mut chunk) = self.chunk else {
            return Ok(None);
        };
        let rest = self.buffer.get(chunk.next..).unwrap_or_default();
        let mut fields = Fields(rest);
        let prefix = fields.bytes(1).and_then(|opcode| {
            let length = usize::try_from(fields.u64()?).ok()?;
            Some((*opcode.first()?, length))
        });
        let Some((opcode, length)) = prefix.filter(|(_, length)| *length <= fields.0.len()) else {
            if !rest.is_empty() {
                self.condition
                    .fault(chunk.at, "a record in this chunk extends beyond its end");
            }
            self.chunk = None;
            self.buffer.clear();
            return Ok(None);
        };
        let body = chunk.next + PREFIX as usize;
        chunk.next = body + length;
        self.chunk = Some(chunk);
        self.record(opcode, body..body + length, chunk.at)
    }

    /// Reads a chunk into the buffer, if it is valid.
    pub(super) fn chunk(&mut self, at: u64, record: u64) -> Result<(), LogReadError> {
        self.chunks += 1;
        let mut head = vec![0; (CHUNK_FIXED + MAX_COMPRESSION_NAME + 8).min(record as usize)];
        self.file
            .read_exact_at(&mut head, at + PREFIX)
            .map_err(|e| self.failed(e))?;
        let mut fields = Fields(&head);
        let mut read = || {
            fields.bytes(16)?;
            let uncompressed = fields.u64()?;
            let crc = fields.u32()?;
            let compression = fields.text()?;
            let compressed = fields.u64()?;
            Some((uncompressed, crc, compression, compressed))
        };
        let header = read();
        let start = at + PREFIX + (head.len() - fields.0.len()) as u64;
        let Some((uncompressed, crc, compression, compressed)) = header else {
            self.lose_chunk(at, "the header of this chunk is invalid");
            return Ok(());
        };
        let there = (at + PREFIX + record).saturating_sub(start);
        if compressed > there {
            self.lose_chunk(at, "the lengths in this chunk contradict each other");
            return Ok(());
        }
        if uncompressed > MAX_RECORD_BYTES as u64 {
            let what = format!(
                "this chunk declares {uncompressed} bytes, more than the maximum of {MAX_RECORD_BYTES}"
            );
            self.lose_chunk(at, &what);
            return Ok(());
        }
        let data = Part {
            file: &self.file,
            next: start,
            end: start + compressed,
        };
        self.buffer.clear();
        // One byte more than declared, to detect longer contents.
        let read = match compression.as_str() {
            "" => data.take(uncompressed + 1).read_to_end(&mut self.buffer),
            "zstd" => zstd::Decoder::with_buffer(BufReader::new(data))
                .and_then(|decoder| decoder.take(uncompressed + 1).read_to_end(&mut self.buffer)),
            "lz4" => FrameDecoder::new(data)
                .take(uncompressed + 1)
                .read_to_end(&mut self.buffer),
            other => {
                let shown: String = other.chars().take(20).collect();
                let what = format!(
                    "this chunk is compressed with `{shown}`, which is not supported (zstd, lz4 \
                     and none are); `mcap compress --compression zstd` converts it"
                );
                self.lose_chunk(at, &what);
                return Ok(());
            }
        };
        if let Err(error) = read {
            self.lose_chunk(at, &format!("this chunk cannot be decompressed: {error}"));
            return Ok(());
        } else if self.buffer.len() as u64 != uncompressed {
            self.lose_chunk(
                at,
                "the contents of this chunk differ from the declared length",
            );
            return Ok(());
        } else if crc == 0 {
            self.condition.chunks_unchecked += 1;
        } else if crc32fast::hash(&self.buffer) == crc {
            self.condition.checksums += 1;
        } else {
            self.lose_chunk(at, "the checksum of this chunk does not match");
            return Ok(());
        }
        let of_kind = self.condition.chunks.entry(compression).or_default();
        of_kind.count += 1;
        of_kind.compressed_bytes += compressed;
        of_kind.uncompressed_bytes += self.buffer.len() as u64;
        self.chunk = Some(OpenChunk {
            next: 0,
            at,
            checked: crc != 0,
        });
        Ok(())
    }

    fn lose_chunk(&mut self, at: u64, why: &str) {
        self.condition.chunks_lost += 1;
        self.condition
            .fault(at, format!("{why}; its messages are lost"));
        self.buffer.clear();
    }
}

/// A range of a file, read sequentially.
struct Part<'a> {
    file: &'a File,
    next: u64,
    end: u64,
}

impl Read for Part<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let wanted = (self.end - self.next).min(buffer.len() as u64) as usize;
        let read = self
            .file
            .read_at(buffer.get_mut(..wanted).unwrap_or_default(), self.next)?;
        self.next += read as u64;
        Ok(read)
    }
}
