//! Files that are truncated or damaged, or that contain wrong sizes.

use std::io::Read as _;

use mcap::{Compression, WriteOptions};
use mcap_log::{DerivedError, LogReadError};
use proptest::prelude::*;

use super::record_run;
use super::support::{file, ours, small, theirs, watch};
use crate::{LogInfo, recover};

fn zstd() -> WriteOptions {
    // Written by the project's recorder, and with the defaults of the crate.
    WriteOptions::new().compression(Some(Compression::Zstd))
}

/// Returns the ends of the chunks of a whole file, each with the number of messages before it.
fn chunk_ends(bytes: &[u8]) -> Vec<(u64, usize)> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let mut indexes = summary.chunk_indexes.clone();
    indexes.sort_by_key(|index| index.chunk_start_offset);
    let mut messages = 0;
    indexes
        .iter()
        .map(|index| {
            messages += summary.stream_chunk(bytes, index).unwrap().count();
            (index.chunk_start_offset + index.chunk_length, messages)
        })
        .collect()
}

#[test]
fn a_log_cut_at_any_byte_keeps_exactly_its_whole_chunks() {
    let folder = tempfile::tempdir().unwrap();
    for options in [
        zstd().disable_seeking(true),
        WriteOptions::new().compression(None),
        WriteOptions::new().use_chunks(false),
    ] {
        let bytes = small(options, 4, 6);
        let whole = file(&folder, "whole.mcap", &bytes);
        let (all, condition) = ours(&whole);
        assert_eq!(all.len(), 24);
        assert!(condition.is_whole(), "{condition:?}");
        assert_eq!(all, theirs(&whole));
        let ends = chunk_ends(&bytes);
        let cut = folder.path().join("cut.mcap");
        for length in 0..bytes.len() {
            std::fs::write(&cut, &bytes[..length]).unwrap();
            if length < 8 {
                let error = LogInfo::read(&cut, &mut watch()).unwrap_err();
                assert!(matches!(error, LogReadError::NotMcap { .. }), "{error}");
                continue;
            }
            let (read, condition) = ours(&cut);
            assert!(!condition.complete && !condition.is_whole(), "{length}");
            assert!(!condition.data || read == all, "{length}");
            assert!(all.starts_with(&read), "{length}");
            let kept = ends.iter().filter(|(end, _)| *end <= length as u64);
            let kept = kept.map(|(_, messages)| *messages).max().unwrap_or(0);
            assert!(read.len() >= kept, "{length}: {} of {kept}", read.len());
            // The new file is written only sometimes, since each is synced to the disk.
            if length.is_multiple_of(41) {
                let out = folder.path().join("out.mcap");
                let done = recover(&cut, &out, true, &mut watch()).unwrap();
                assert_eq!(theirs(&out), read, "{length}");
                assert_eq!(done.messages, read.len() as u64);
                let info = LogInfo::read(&out, &mut watch()).unwrap();
                let c = &info.condition;
                assert!(c.is_whole() && c.summary && c.index, "{length}: {c:?}");
                assert!(info.recovered.contains_key("faults"));
            }
        }
    }
}

#[test]
fn a_truncated_run_is_reported_and_has_no_digest() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    let summary = record_run(&log, 12);
    let whole = LogInfo::read(&log, &mut watch()).unwrap();
    assert!(whole.ours && whole.condition.is_whole());
    assert_eq!(whole.digest.as_deref(), Some(&*summary.digest));
    assert_eq!(whole.seed, Some(7));
    for (name, count) in &summary.topics {
        let topic = &whole.topics[name];
        assert_eq!(
            (topic.messages, topic.bytes),
            (count.messages, count.bytes),
            "{name}"
        );
        assert_eq!(topic.gaps.unwrap_or(0), count.gaps, "{name}");
    }
    assert_eq!(whole.topics["world/state"].rate_hz, Some(20.0));
    assert_eq!((whole.start_s, whole.end_s), (0.0, 0.55));

    let bytes = std::fs::read(&log).unwrap();
    // Without the end of the summary, no message is lost.
    let cut = file(&folder, "cut.mcap", &bytes[..bytes.len() - 100]);
    let info = LogInfo::read(&cut, &mut watch()).unwrap();
    assert!(info.condition.data && !info.condition.complete && !info.condition.index);
    let out = folder.path().join("out.mcap");
    let done = recover(&cut, &out, false, &mut watch()).unwrap();
    assert_eq!(done.messages, whole.messages);
    let info = LogInfo::read(&out, &mut watch()).unwrap();
    assert_eq!((&info.digest, &info.topics), (&whole.digest, &whole.topics));

    let (end, _) = chunk_ends(&bytes).into_iter().nth(4).unwrap();
    let cut = file(&folder, "cut.mcap", &bytes[..end as usize + 300]);
    let info = LogInfo::read(&cut, &mut watch()).unwrap();
    assert!(!info.condition.complete && info.condition.cut_at.is_some());
    assert_eq!(info.digest, None);
    assert!(info.messages > 0 && info.messages < whole.messages);
    let text = crate::info_text(&info);
    for words in [
        "the run did not reach its end",
        "INCOMPLETE",
        "protean recover",
    ] {
        assert!(text.contains(words), "{text}");
    }
}

/// A chunk record with this header.
fn chunk(uncompressed: u64, compression: &str, compressed: u64, data: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    body.extend_from_slice(&[0; 16]);
    body.extend_from_slice(&uncompressed.to_le_bytes());
    body.extend_from_slice(&0_u32.to_le_bytes());
    body.extend_from_slice(&(compression.len() as u32).to_le_bytes());
    body.extend_from_slice(compression.as_bytes());
    body.extend_from_slice(&compressed.to_le_bytes());
    body.extend_from_slice(data);
    record(6, &body)
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    let mut record = vec![opcode];
    record.extend_from_slice(&(body.len() as u64).to_le_bytes());
    record.extend_from_slice(body);
    record
}

#[test]
fn invalid_sizes_and_unknown_compressions_are_skipped_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let good = small(zstd(), 2, 3);
    // After the header, before all other records.
    let header = 8 + 9 + u64::from_le_bytes(good[9..17].try_into().unwrap()) as usize;
    for (bad, words) in [
        (chunk(u64::MAX, "zstd", 4, b"data"), "declares"),
        (chunk(1 << 40, "", 4, b"data"), "declares"),
        (chunk(100, "", u64::MAX, b"data"), "contradict"),
        (
            chunk(100, "", 4, b"data"),
            "differ from the declared length",
        ),
        (chunk(2, "", 4, b"data"), "differ from the declared length"),
        (chunk(100, "zstd", 4, b"data"), "cannot be decompressed"),
        (
            chunk(100, "lz4", 12, b"not a frame!"),
            "cannot be decompressed",
        ),
        (
            chunk(100, "lzo", 4, b"data"),
            "`lzo`, which is not supported",
        ),
        (
            chunk(100, &"x".repeat(500), 4, b"data"),
            "header of this chunk",
        ),
        (record(6, b"short"), "header of this chunk"),
        (record(9, b"short"), "an attachment is invalid"),
        (record(9, &[0; 32]), "an attachment is invalid"),
        (
            record(3, &[1, 0, 255, 255, 255, 255]),
            "a schema is invalid",
        ),
        (
            record(4, &[9, 0, 77, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
            "schema 77, which is missing",
        ),
        (record(5, &[9; 30]), "channel 2313, which is missing"),
        (record(12, &[255; 40]), "a metadata record is invalid"),
    ] {
        let mut bytes = good.clone();
        bytes.splice(header..header, bad);
        let path = file(&folder, "bad.mcap", &bytes);
        let (read, condition) = ours(&path);
        assert_eq!(read.len(), 6, "{words}");
        let lines = condition.lines().join("\n");
        assert!(lines.contains(words), "{words}: {lines}");
    }
    // A record with a length beyond the end is indistinguishable from a truncated file.
    let mut bytes = good[..header].to_vec();
    bytes.extend_from_slice(&[5, 255, 255, 255, 255, 255, 255, 255, 127, 1, 2, 3]);
    let (read, condition) = ours(&file(&folder, "long.mcap", &bytes));
    assert_eq!((read.len(), condition.cut_at), (0, Some(header as u64)));
}

#[test]
fn a_chunk_that_would_fill_memory_when_decompressed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = zstd::encode_all(std::io::repeat(0).take(40 << 20), 1).unwrap();
    let mut bytes = mcap::MAGIC.to_vec();
    bytes.extend(chunk(1000, "zstd", zeros.len() as u64, &zeros));
    let (read, condition) = ours(&file(&folder, "bomb.mcap", &bytes));
    assert!(read.is_empty());
    assert!(
        condition.lines()[0].contains("differ from the declared length"),
        "{condition:?}"
    );
}

#[test]
fn files_that_are_not_logs_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [
        ("empty", &b""[..]),
        ("text", b"hello, world"),
        ("short", b"\x89MCAP"),
    ] {
        let path = file(&folder, name, bytes);
        let error = LogInfo::read(&path, &mut watch()).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains(name) && text.contains("not an MCAP file"),
            "{text}"
        );
        let out = folder.path().join("out.mcap");
        assert!(recover(&path, &out, false, &mut watch()).is_err());
        assert!(!out.exists());
    }
    assert!(matches!(
        LogInfo::read(folder.path(), &mut watch()),
        Err(LogReadError::Open { .. })
    ));
}

#[test]
fn an_interrupted_or_refused_copy_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let log = file(&folder, "a.mcap", &small(zstd(), 2, 3));
    let out = file(&folder, "out.mcap", b"precious");
    let refused = recover(&log, &out, false, &mut watch()).unwrap_err();
    assert!(matches!(refused, DerivedError::Exists { .. }), "{refused}");
    let refused = recover(&log, &log, true, &mut watch()).unwrap_err();
    assert!(
        matches!(refused, DerivedError::IsTheLog { .. }),
        "{refused}"
    );
    let mut watch = watch();
    watch
        .interrupted
        .store(true, std::sync::atomic::Ordering::SeqCst);
    let refused = recover(&log, &out, true, &mut watch).unwrap_err();
    assert!(
        matches!(refused, DerivedError::Log(LogReadError::Interrupted)),
        "{refused}"
    );
    assert_eq!(std::fs::read(&out).unwrap(), b"precious");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_file_of_another_format_is_refused_with_the_way_to_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let compressed = zstd::encode_all(&small(zstd(), 1, 1)[..], 1).unwrap();
    for (name, bytes, words) in [
        (
            "a.mcap.zstd",
            compressed.as_slice(),
            "a.mcap.zstd >LOG.mcap`",
        ),
        ("a.db3", b"SQLite format 3\0", "a.db3 LOG.mcap`"),
        ("a.bag", b"#ROSBAG V2.0\n", "a ROS 1 bag"),
        ("a", b"", "it is empty"),
        ("b", b"SQL", "b is not an MCAP file"),
    ] {
        let log = file(&folder, name, bytes);
        let error = LogInfo::read(&log, &mut watch()).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let error = LogInfo::read(folder.path(), &mut watch()).unwrap_err();
    assert!(
        error.to_string().contains("the `.mcap` file in it"),
        "{error}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn a_changed_byte_never_creates_a_message(
        at in 8_usize..2000,
        change in 1_u8..=255,
        compressed in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let options = if compressed { zstd() } else { WriteOptions::new().compression(None) };
        let mut bytes = small(options, 3, 5);
        let (all, _) = ours(&file(&folder, "good.mcap", &bytes));
        let at = 8 + at % (bytes.len() - 8);
        bytes[at] ^= change;
        let (read, condition) = ours(&file(&folder, "bad.mcap", &bytes));
        for message in &read {
            prop_assert!(all.contains(message), "{message:?} {condition:?}");
        }
        prop_assert!(read.len() == all.len() || !condition.is_whole());
    }
}

/// Found by fuzzing: a chunk with a length beyond the end of the file that contains a footer.
#[test]
fn a_footer_inside_a_truncated_chunk_is_not_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let mut inner = vec![mcap::records::op::FOOTER];
    inner.extend(20_u64.to_le_bytes());
    inner.extend([0; 20]);
    let mut chunk = [0; 24].to_vec();
    chunk.extend([0; 4]);
    chunk.extend(0_u32.to_le_bytes());
    chunk.extend((inner.len() as u64).to_le_bytes());
    chunk.extend(inner);
    let mut bytes = mcap::MAGIC.to_vec();
    bytes.push(mcap::records::op::CHUNK);
    bytes.extend((chunk.len() as u64 + 1000).to_le_bytes());
    bytes.extend(chunk);
    let path = file(&folder, "footer.mcap", &bytes);
    let info = LogInfo::read(&path, &mut watch()).unwrap();
    assert!(!info.condition.complete && !info.condition.is_whole());
}
