//! Files with chunks that other programs compressed with lz4.

use std::io::Write as _;

use lz4_flex::frame::FrameEncoder;
use mcap::WriteOptions;
use mcap::records::op;
use mcap_log::fields::Fields;

use super::support::{file, ours, small};

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// Returns the data section of an uncompressed file compressed with lz4, with an end without a summary, and the start
/// of its last chunk.
fn with_lz4(plain: &[u8]) -> (Vec<u8>, usize) {
    let mut bytes = mcap::MAGIC.to_vec();
    let mut last_chunk = 0;
    let mut rest = Fields(&plain[8..]);
    loop {
        let opcode = rest.bytes(1).unwrap()[0];
        let length = rest.u64().unwrap() as usize;
        let body = rest.bytes(length).unwrap();
        match opcode {
            op::CHUNK => {
                let mut fields = Fields(body);
                let times_size_and_checksum = fields.bytes(28).unwrap();
                assert_eq!(fields.text().unwrap(), "", "not compressed");
                fields.u64().unwrap();
                let mut encoder = FrameEncoder::new(Vec::new());
                encoder.write_all(fields.0).unwrap();
                let compressed = encoder.finish().unwrap();
                let chunk = [
                    times_size_and_checksum,
                    &3_u32.to_le_bytes(),
                    b"lz4",
                    &(compressed.len() as u64).to_le_bytes(),
                    &compressed,
                ]
                .concat();
                last_chunk = bytes.len();
                bytes.extend(record(op::CHUNK, &chunk));
            }
            op::MESSAGE_INDEX => {}
            op::DATA_END => {
                bytes.extend(record(op::DATA_END, &[0; 4]));
                bytes.extend(record(op::FOOTER, &[0; 20]));
                bytes.extend(mcap::MAGIC);
                return (bytes, last_chunk);
            }
            _ => bytes.extend(record(opcode, body)),
        }
    }
}

#[test]
fn chunks_of_lz4_are_read_and_their_checksums_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let plain = small(WriteOptions::new().compression(None), 3, 40);
    let (expected, _) = ours(&file(&folder, "plain.mcap", &plain));
    let (bytes, last) = with_lz4(&plain);
    let (read, condition) = ours(&file(&folder, "lz4.mcap", &bytes));
    assert_eq!(read, expected);
    assert!(condition.complete && condition.data, "{condition:?}");
    assert_eq!(
        (condition.chunks["lz4"].count, condition.chunks_lost),
        (3, 0)
    );

    // One changed byte of the compressed data loses only its chunk.
    let mut changed = bytes.clone();
    changed[last + 120] ^= 1;
    let (read, condition) = ours(&file(&folder, "changed.mcap", &changed));
    assert_eq!(read, expected[..80]);
    assert_eq!(condition.chunks_lost, 1, "{condition:?}");

    // A chunk whose stated size is less than its contents.
    let mut less = bytes.clone();
    less[last + 9 + 16] -= 1;
    let (read, condition) = ours(&file(&folder, "less.mcap", &less));
    assert_eq!((read.len(), condition.chunks_lost), (80, 1));
    let lines = condition.lines().join("\n");
    assert!(lines.contains("differ from the declared length"), "{lines}");
}
