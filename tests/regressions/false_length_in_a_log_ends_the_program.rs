//! A length of 2³² bytes in a record of a log ended `picture` by an abort where memory was limited.

use mcap::records::op;

use crate::support::Sandbox;

/// Size of opcode and length before a record (bytes).
const PREFIX: usize = 9;
/// Address space of a command (KiB): far less than the false length.
const MEMORY_KIB: &str = "1500000";

#[test]
fn a_false_length_in_a_log_ends_no_command_by_a_signal() {
    let sandbox = Sandbox::new();
    sandbox.record("hello");
    let log = std::fs::read(sandbox.path().join("run.mcap")).unwrap();
    let mut kinds = Vec::new();
    for (kind, at) in records(&log) {
        // Offsets in the record's content: names, and what follows log time and creation time, or an id.
        let lengths: &[usize] = match kind {
            op::METADATA => &[0],
            op::ATTACHMENT => &[16],
            op::SCHEMA => &[2],
            _ => continue,
        };
        if kinds.contains(&kind) {
            continue;
        }
        kinds.push(kind);
        // The length of the whole record, too.
        let offsets = [at + 1].into_iter();
        for offset in offsets.chain(lengths.iter().map(|length| at + PREFIX + length)) {
            let mut changed = log.clone();
            changed[offset..offset + 4].fill(0xff);
            sandbox.file("changed.mcap", changed);
            for words in [
                &["picture", "changed.mcap", "--out", "x.svg", "--force"][..],
                &["report", "changed.mcap", "--out", "x.html", "--force"],
                &["info", "changed.mcap"],
                &["cat", "changed.mcap"],
                &["verify", "changed.mcap", "--in-process"],
            ] {
                let call = sandbox.protean(words.iter().copied());
                let outcome = call.with_memory(MEMORY_KIB).run();
                let is_answer = matches!(outcome.code, Some(0 | 2 | 3));
                assert!(is_answer, "{words:?}, record {kind:#x}: {outcome}");
            }
        }
    }
    kinds.sort_unstable();
    assert_eq!(kinds, [op::SCHEMA, op::ATTACHMENT, op::METADATA]);
}

/// Returns opcode and offset of the records of a file.
fn records(log: &[u8]) -> Vec<(u8, usize)> {
    let mut at = mcap::MAGIC.len();
    let mut found = Vec::new();
    while let Some(prefix) = log.get(at..at + PREFIX) {
        let length = u64::from_le_bytes(prefix[1..].try_into().unwrap());
        found.push((prefix[0], at));
        at += PREFIX + length as usize;
        if prefix[0] == op::FOOTER {
            break;
        }
    }
    found
}
