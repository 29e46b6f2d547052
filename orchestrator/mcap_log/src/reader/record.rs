//! Parser of single records.

use std::ops::Range;
use std::sync::Arc;

use mcap::records::{AttachmentHeader, MessageHeader, Metadata, op};

use super::super::fields::Fields;
use super::Reader;
use super::item::{Channel, ItemLocation, Schema};
use super::limits::MAX_DESCRIPTION_BYTES;
use crate::LogReadError;

/// Size of opcode and length before every record (bytes).
pub const PREFIX: u64 = 9;

impl Reader<'_> {
    /// Parses the record in the buffer.
    pub(super) fn record(
        &mut self,
        opcode: u8,
        place: Range<usize>,
        at: u64,
    ) -> Result<Option<ItemLocation>, LogReadError> {
        // The buffer is restored below: nothing is copied.
        let buffer = core::mem::take(&mut self.buffer);
        let body = buffer.get(place.clone()).unwrap_or_default();
        let found = match opcode {
            op::SCHEMA => self.take_schema(body, at),
            op::CHANNEL => self.take_channel(body, at),
            op::FOOTER => self.take_footer(body, at),
            _ => Ok(self.take_other(opcode, body, place, at)),
        };
        self.buffer = buffer;
        Ok(found?.unwrap_or_else(|()| {
            let what = format!("{} is invalid and skipped", name_of(opcode));
            self.condition.fault(at, what);
            None
        }))
    }

    fn take_schema(
        &mut self,
        body: &[u8],
        at: u64,
    ) -> Result<Result<Option<ItemLocation>, ()>, LogReadError> {
        let mut fields = Fields(body);
        let mut read = || {
            let id = fields.u16().filter(|id| *id != 0)?;
            let (name, encoding) = (fields.text()?, fields.text()?);
            let length = fields.u32()? as usize;
            let data = fields.bytes(length)?.to_vec();
            let schema = Schema {
                name,
                encoding,
                data,
            };
            Some((id, schema))
        };
        let Some((id, schema)) = read() else {
            return Ok(Err(()));
        };
        match self.schemas.get(&id) {
            Some(known) if **known == schema => Ok(Ok(None)),
            Some(_) => {
                let what = format!("schema {id} is redefined with other contents: skipped");
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None => {
                self.describe(body.len())?;
                let schema = Arc::new(schema);
                self.schemas.insert(id, Arc::clone(&schema));
                Ok(Ok(Some(ItemLocation::Schema(id, schema))))
            }
        }
    }

    fn take_channel(
        &mut self,
        body: &[u8],
        at: u64,
    ) -> Result<Result<Option<ItemLocation>, ()>, LogReadError> {
        let mut fields = Fields(body);
        let mut read = || {
            Some(Channel {
                id: fields.u16()?,
                schema_id: fields.u16()?,
                topic: fields.text()?,
                message_encoding: fields.text()?,
                metadata: fields.map()?,
            })
        };
        let Some(channel) = read() else {
            return Ok(Err(()));
        };
        let (id, schema_id) = (channel.id, channel.schema_id);
        match self.channels.get(&id) {
            Some(known) if **known == channel => Ok(Ok(None)),
            Some(known) => {
                let what = format!(
                    "channel {id} ({}) is redefined as {}: skipped",
                    known.topic, channel.topic
                );
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None if schema_id != 0 && !self.schemas.contains_key(&schema_id) => {
                let what = format!(
                    "channel {id} ({}) has schema {schema_id}, which is missing: skipped",
                    channel.topic
                );
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None => {
                self.describe(body.len())?;
                let channel = Arc::new(channel);
                self.channels.insert(id, Arc::clone(&channel));
                Ok(Ok(Some(ItemLocation::Channel(channel))))
            }
        }
    }

    fn take_footer(
        &mut self,
        body: &[u8],
        at: u64,
    ) -> Result<Result<Option<ItemLocation>, ()>, LogReadError> {
        let mut fields = Fields(body);
        let mut read = || {
            let start = fields.u64()?;
            fields.u64()?;
            Some((start, fields.u32()?))
        };
        let Some((summary_start, crc)) = read() else {
            return Ok(Err(()));
        };
        self.footer(summary_start, at, crc)?;
        Ok(Ok(None))
    }

    fn describe(&mut self, bytes: usize) -> Result<(), LogReadError> {
        self.descriptions += bytes;
        if self.descriptions > MAX_DESCRIPTION_BYTES {
            return Err(LogReadError::TooLarge {
                path: self.path.clone(),
                what: "the descriptions of its channels",
                limit: MAX_DESCRIPTION_BYTES,
            });
        }
        Ok(())
    }

    fn take_other(
        &mut self,
        opcode: u8,
        body: &[u8],
        place: Range<usize>,
        at: u64,
    ) -> Result<Option<ItemLocation>, ()> {
        let mut fields = Fields(body);
        match opcode {
            op::MESSAGE => {
                let mut read = || {
                    Some(MessageHeader {
                        channel_id: fields.u16()?,
                        sequence: fields.u32()?,
                        log_time: fields.u64()?,
                        publish_time: fields.u64()?,
                    })
                };
                let header = read().ok_or(())?;
                if !self.channels.contains_key(&header.channel_id) {
                    let what = format!(
                        "a message of channel {}, which is missing: skipped",
                        header.channel_id
                    );
                    self.condition.fault(at, what);
                    return Ok(None);
                }
                if !self.chunk.is_some_and(|chunk| chunk.checked) {
                    self.condition.messages_unchecked += 1;
                }
                self.messages = self.messages.map(|messages| messages + 1);
                self.loose |= self.chunk.is_none();
                let start = place.end - fields.0.len();
                Ok(Some(ItemLocation::Message(header, start..place.end)))
            }
            op::HEADER => {
                let profile = fields.text().ok_or(())?;
                let library = fields.text().ok_or(())?;
                Ok(Some(ItemLocation::Header(profile, library)))
            }
            op::ATTACHMENT => {
                let (header, data) = attachment(body).ok_or(())?;
                // The checksum, if there is one, is the last field.
                self.condition.checksums += u64::from(!body.ends_with(&[0; 4]));
                let data = place.start + data.start..place.start + data.end;
                Ok(Some(ItemLocation::Attachment(header, data)))
            }
            op::METADATA => {
                let name = fields.text().ok_or(())?;
                let metadata = fields.map().ok_or(())?;
                Ok(Some(ItemLocation::Metadata(Metadata { name, metadata })))
            }
            op::DATA_END => {
                self.data_end = Some((at, fields.u32().ok_or(())?));
                self.condition.data_end();
                Ok(None)
            }
            op::CHUNK_INDEX => {
                self.indexed_chunks += 1;
                Ok(None)
            }
            op::STATISTICS => {
                self.condition.claimed_messages = Some(fields.u64().ok_or(())?);
                Ok(None)
            }
            _ => Ok(None),
        }
    }
}

/// Parses an attachment: returns its header and the range of its bytes in the record; `None` if the record is
/// invalid or its checksum does not match.
pub fn attachment(body: &[u8]) -> Option<(AttachmentHeader, Range<usize>)> {
    let mut fields = Fields(body);
    let header = AttachmentHeader {
        log_time: fields.u64()?,
        create_time: fields.u64()?,
        name: fields.text()?,
        media_type: fields.text()?,
    };
    let length = usize::try_from(fields.u64()?).ok()?;
    let start = body.len() - fields.0.len();
    fields.bytes(length)?;
    let crc = fields.u32()?;
    let covered = body.get(..start + length)?;
    (crc == 0 || crc == crc32fast::hash(covered)).then_some((header, start..start + length))
}

/// Returns the name of a record in messages.
pub fn name_of(opcode: u8) -> &'static str {
    match opcode {
        op::HEADER => "the header",
        op::FOOTER => "the footer",
        op::SCHEMA => "a schema",
        op::CHANNEL => "a channel",
        op::MESSAGE => "a message",
        op::CHUNK => "a chunk",
        op::ATTACHMENT => "an attachment",
        op::METADATA => "a metadata record",
        op::DATA_END => "the end of the data",
        op::STATISTICS => "the statistics",
        op::MESSAGE_INDEX | op::CHUNK_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX => {
            "an index"
        }
        _ => "a record",
    }
}
