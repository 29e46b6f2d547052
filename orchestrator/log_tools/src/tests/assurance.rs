//! Assurances of `info` and `recover`: of checksums, of messages, and of bytes behind a log.

use mcap::{Compression, WriteOptions};
use proptest::prelude::*;

use super::support::{file, ours, small, theirs, watch};
use crate::{LogInfo, info_text, recover};

/// A writer with these checksums: of chunks, of the data section, of the summary and of attachments; without chunks
/// for `None`.
fn options(chunks: Option<bool>, data: bool, summary: bool, attachments: bool) -> WriteOptions {
    let options = WriteOptions::new()
        .compression(None)
        .calculate_data_section_crc(data)
        .calculate_summary_section_crc(summary)
        .calculate_attachment_crcs(attachments);
    match chunks {
        Some(chunks) => options.calculate_chunk_crcs(chunks),
        None => options.use_chunks(false),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn only_checksums_that_exist_are_called_correct(
        chunks in any::<Option<bool>>(),
        data in any::<bool>(),
        summary in any::<bool>(),
        attachments in any::<bool>(),
        at in any::<prop::sample::Index>(),
        change in 1_u8..=255,
    ) {
        // Without checksums of chunks, the crate writes a wrong one of the data section.
        prop_assume!(!(data && chunks == Some(false)));
        let folder = tempfile::tempdir().unwrap();
        let bytes = small(options(chunks, data, summary, attachments), 3, 5);
        let whole = LogInfo::read(&file(&folder, "whole.mcap", &bytes), &mut watch()).unwrap();
        let c = &whole.condition;
        prop_assert!(c.is_whole(), "{c:?}");
        let of_chunks = if chunks == Some(true) { 3 } else { 0 };
        let others = [data, summary, attachments].map(u64::from);
        prop_assert_eq!(c.checksums, of_chunks + others.iter().sum::<u64>());
        let is_covered = data || chunks == Some(true);
        prop_assert_eq!(c.messages_unchecked, if is_covered { 0 } else { 15 });
        // Messages outside chunks are in no index.
        prop_assert_eq!(c.index, chunks.is_some());
        let text = info_text(&whole);
        prop_assert_eq!(text.contains("the file has no checksums"), c.checksums == 0);
        prop_assert_eq!(text.contains("15 of 15 messages: no checksum"), !is_covered);

        // A changed message is a fault, or counts as covered by no checksum.
        let mut changed = bytes.clone();
        let at = 8 + at.index(bytes.len() - 8);
        changed[at] ^= change;
        let (before, _) = ours(&file(&folder, "whole.mcap", &bytes));
        let (after, condition) = ours(&file(&folder, "changed.mcap", &changed));
        prop_assert!(
            after == before || !condition.is_whole() || condition.messages_unchecked > 0,
            "{at}: {condition:?}"
        );
    }

    #[test]
    fn what_follows_the_end_of_a_log_is_noticed_and_every_log_recovered(
        counts in prop::collection::vec(0_u32..4, 1..5),
        rest in prop::collection::vec(any::<u8>(), 0..40),
        compressed in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let compression = compressed.then_some(Compression::Zstd);
        let write = |chunks| small(WriteOptions::new().compression(compression), chunks, 3);
        let logs: Vec<Vec<u8>> = counts.iter().map(|&chunks| write(chunks)).collect();
        let joined = file(&folder, "joined.mcap", &[logs.concat(), rest.clone()].concat());
        let info = LogInfo::read(&joined, &mut watch()).unwrap();
        let following = logs.concat().len() - logs[0].len() + rest.len();
        prop_assert_eq!(info.condition.following_bytes, following as u64);
        prop_assert_eq!(info.condition.is_whole(), following == 0);
        prop_assert_eq!(info.condition.has_all_messages(), following == 0);

        let done = recover(&joined, &folder.path().join("ok.mcap"), false, &mut watch()).unwrap();
        let all: Vec<_> = std::iter::once(&done).chain(&done.further).collect();
        prop_assert_eq!(all.len(), logs.len());
        for (index, (found, log)) in all.iter().zip(&logs).enumerate() {
            let name = if index == 0 { "ok.mcap".to_owned() } else { format!("ok_{}.mcap", index + 1) };
            prop_assert_eq!(&found.out, &folder.path().join(name));
            let whole = theirs(&file(&folder, "whole.mcap", log));
            prop_assert_eq!(found.messages, whole.len() as u64);
            prop_assert_eq!(theirs(&found.out), whole);
            let follows = index + 1 < logs.len() || !rest.is_empty();
            prop_assert_eq!(found.source.has_all_messages(), !follows);
        }
    }
}

#[test]
fn a_summary_that_counts_more_messages_than_are_there_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = small(options(None, false, false, false), 2, 3);
    // The record of the statistics: opcode, length, number of messages.
    let is_here = |part: &[u8]| part[0] == 11 && part[2..9] == [0; 7] && part[9..] == [6, 0];
    let at = bytes.windows(11).rposition(is_here).unwrap();
    bytes[at + 9] = 7;
    let (read, condition) = ours(&file(&folder, "more.mcap", &bytes));
    assert_eq!(read.len(), 6);
    assert!(!condition.data && !condition.is_whole());
    assert!(
        condition.lines()[0].contains("counts 7 messages, 6 are there"),
        "{condition:?}"
    );
}
