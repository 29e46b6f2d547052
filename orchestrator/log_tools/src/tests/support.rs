//! Small logs, and the contents of logs. Tests of other crates include this file.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::sans_io::LinearReaderOptions;
use mcap::{Attachment, WriteOptions};
use mcap_log::output::Output;
use mcap_log::reader::{Channel, Item, Reader, Schema};
use mcap_log::{Condition, ReadProgress};
use tempfile::TempDir;

/// A message: topic, sequence, log time, bytes.
pub type Read = (String, u32, u64, Vec<u8>);

/// Reads a file with the project's reader.
pub fn ours(path: &Path) -> (Vec<Read>, Condition) {
    let mut reader = Reader::open(path, None).unwrap();
    let mut messages = Vec::new();
    let mut topics = std::collections::BTreeMap::new();
    while let Some(item) = reader.next().unwrap() {
        match item {
            Item::Channel(channel) => {
                topics.insert(channel.id, channel.topic.clone());
            }
            Item::Message(m, data) => {
                let topic = topics[&m.channel_id].clone();
                messages.push((topic, m.sequence, m.log_time, data.to_vec()));
            }
            _ => {}
        }
    }
    reader.check_all().unwrap();
    (messages, reader.condition().clone())
}

/// Reads a whole file with the crate's reader, which checks every checksum.
pub fn theirs(path: &Path) -> Vec<Read> {
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true);
    let file = std::fs::File::open(path).unwrap();
    let reader = mcap::io::MessageReader::new_with_options(file, options);
    reader
        .map(|message| {
            let m = message.unwrap();
            (
                m.channel.topic.clone(),
                m.sequence,
                m.log_time,
                m.data.to_vec(),
            )
        })
        .collect()
}

/// Returns the bytes of a small file of another program: two channels, some messages per chunk, an attachment, a
/// metadata record.
pub fn small(options: WriteOptions, chunks: u32, per_chunk: u32) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = options
        .compression_threads(0)
        .chunk_size(None)
        .create(&mut file)
        .unwrap();
    writer
        .attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: "notes.txt".to_owned(),
            media_type: "text/plain".to_owned(),
            data: Cow::Borrowed(b"attached"),
        })
        .unwrap();
    writer
        .write_metadata(&Metadata {
            name: "facts".to_owned(),
            metadata: [("a".to_owned(), "b".to_owned())].into(),
        })
        .unwrap();
    let schema = writer.add_schema("pkg/P", "ros2msg", b"uint8 x").unwrap();
    let none = std::collections::BTreeMap::new();
    let a = writer.add_channel(schema, "a", "cdr", &none).unwrap();
    let b = writer.add_channel(0, "b", "json", &none).unwrap();
    for chunk in 0..chunks {
        for index in 0..per_chunk {
            let n = chunk * per_chunk + index;
            let header = MessageHeader {
                channel_id: if n.is_multiple_of(3) { b } else { a },
                sequence: n,
                log_time: 1_000 + u64::from(n),
                publish_time: 7,
            };
            let data = [0, 1, 0, 0, n as u8, (n * 37) as u8];
            writer.write_to_known_channel(&header, &data).unwrap();
        }
        writer.flush().unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

pub fn file(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Copies a log; the closures may change or drop messages, change metadata records, and change or drop the scenario.
pub fn rewrite(
    from: &Path,
    to: &Path,
    mut message: impl FnMut(&Channel, &mut Vec<u8>) -> bool,
    mut metadata: impl FnMut(&mut Metadata),
    mut scenario: impl FnMut(&mut Vec<u8>) -> bool,
) {
    let mut reader = Reader::open(from, None).unwrap();
    let mut output = Output::create(to, from, true, "").unwrap();
    let mut channels = std::collections::BTreeMap::new();
    while let Some(item) = reader.next().unwrap() {
        match item {
            Item::Header { .. } => {}
            Item::Schema(id, schema) => {
                let schema: &Schema = &schema;
                output.schema(id, schema).unwrap();
            }
            Item::Channel(channel) => {
                output.channel(&channel).unwrap();
                channels.insert(channel.id, channel);
            }
            Item::Message(header, data) => {
                let mut data = data.to_vec();
                if message(&channels[&header.channel_id], &mut data) {
                    output.message(&header, &data).unwrap();
                }
            }
            Item::Attachment(header, data) => {
                let mut data = data.to_vec();
                if header.name != "scenario.toml" || scenario(&mut data) {
                    output.attachment(&header, &data).unwrap();
                }
            }
            Item::Metadata(mut record) => {
                metadata(&mut record);
                output.metadata(&record).unwrap();
            }
        }
    }
    output.finish().unwrap();
}

pub fn watch() -> ReadProgress {
    ReadProgress::new(std::sync::Arc::default(), true)
}
