//! A world that stands still within a tick: what was said is in the log before the tick is over,
//! and nothing of it is there twice.

use std::collections::BTreeSet;
use std::path::Path;

use mcap::records::op;

use super::super::{Compression, PUT_BY, Recording};
use super::round_trip::{Read, read};
use super::{Sent, options, run};
use crate::logs::{Condition, LogInfo, Watch, recover};

const TICKS: u64 = 9;
/// The tick in which the world stands still.
const STILL: u64 = 6;

fn watch() -> Watch {
    Watch::new(std::sync::Arc::default(), true)
}

/// Records up to the middle of a tick; everything of it has come but what `late` holds back.
fn up_to(path: &Path, tick: u64, late: impl Fn(&Sent) -> bool) -> (Recording, Vec<Sent>) {
    let mut options = options(path);
    // So that something can be saved of a chunk in which the file ends.
    options.log.compression = Compression::None;
    let mut recording = Recording::create(&options).unwrap();
    let mut rest = Vec::new();
    for sent in run(TICKS, 1) {
        let of = sent.stamp().tick;
        if of < tick || (of == tick && !late(&sent)) {
            sent.push(&mut recording);
        } else {
            rest.push(sent);
        }
    }
    if let Some(complete) = tick.checked_sub(1) {
        recording.advance(complete, &mut ()).unwrap();
    }
    (recording, rest)
}

fn is_command(sent: &Sent) -> bool {
    matches!(sent, Sent::Command(..))
}

/// What can be saved of the log as it is on the disk, but for what only viewers see.
fn saved(path: &Path) -> (Vec<Read>, Condition) {
    let out = path.with_extension("saved");
    let done = recover(path, &out, true, &mut watch()).unwrap();
    let info = LogInfo::read(&out, &mut watch()).unwrap();
    assert!(info.condition.is_whole(), "{:?}", info.condition);
    (lossless(&out), done.source)
}

fn lossless(path: &Path) -> Vec<Read> {
    let mut read = read(path);
    read.retain(|m| !m.0.starts_with("/viewer/"));
    read
}

/// Where records of this kind begin, and what comes behind the last record.
fn records(bytes: &[u8], kind: u8) -> (Vec<usize>, usize) {
    let (mut at, mut found) = (8, Vec::new());
    while let Some(length) = bytes.get(at + 1..at + 9) {
        if bytes[at] == kind {
            found.push(at);
        }
        at += 9 + u64::from_le_bytes(length.try_into().unwrap()) as usize;
    }
    (found, at)
}

#[test]
fn what_was_said_in_a_tick_that_does_not_end_is_there_and_all_is_said_once_when_it_does() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.mcap");
    let (mut untouched, rest) = up_to(&whole, STILL, is_command);
    for sent in &rest {
        sent.push(&mut untouched);
    }
    let expected = untouched.finish(&mut ()).unwrap();
    for still in [0, STILL] {
        let path = folder.path().join(format!("{still}.mcap"));
        let (mut recording, rest) = up_to(&path, still, is_command);
        recording.flush_if_due().unwrap();
        let arrivals = recording.arrivals();
        assert!(recording.has_waiting(0..arrivals));
        assert!(!recording.has_waiting(arrivals..u64::MAX));
        let (before, _) = saved(&path);
        assert!(before.iter().all(|m| m.2 < still * super::PERIOD_NS));
        recording.put_by(&mut ()).unwrap();
        let (there, condition) = saved(&path);
        let said = run(TICKS, 1)
            .iter()
            .filter(|sent| sent.stamp().tick < still)
            .chain(
                run(TICKS, 1)
                    .iter()
                    .filter(|sent| sent.stamp().tick == still && !is_command(sent)),
            )
            .count();
        assert_eq!(there.len(), said, "{still}");
        assert!(condition.put_by > 0 && condition.salvaged == 0);
        let words = condition.lines().join("\n");
        assert!(words.contains("put them by"), "{words}");

        // Later it goes on: a command comes, and is put by with the rest.
        let (command, rest) = rest.split_first().unwrap();
        command.push(&mut recording);
        recording.put_by(&mut ()).unwrap();
        assert_eq!(saved(&path).0.len(), said + 1);
        // A reader that knows nothing of it sees what stands in chunks.
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(records(&bytes, PUT_BY).0.len(), 2);
        let ends = mcap::read::Options::IgnoreEndMagic.into();
        let theirs = mcap::MessageStream::new_with_options(&bytes, ends).unwrap();
        let theirs = theirs.map_while(Result::ok).count();
        assert!((1..=there.len() * 2).contains(&theirs), "{theirs}");

        for sent in rest {
            sent.push(&mut recording);
        }
        for tick in still..TICKS {
            recording.advance(tick, &mut ()).unwrap();
        }
        let summary = recording.finish(&mut ()).unwrap();
        assert_eq!(summary.digest, expected.digest);
        assert_eq!(summary.topics, expected.topics);
        assert_eq!(lossless(&path), lossless(&whole));
        let info = LogInfo::read(&path, &mut watch()).unwrap();
        assert!(info.condition.is_whole() && info.condition.put_by == 0);
        assert!(info.condition.index);
    }
}

#[test]
fn wherever_a_log_ends_behind_it_nothing_of_it_is_missing_or_there_twice() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (mut recording, rest) = up_to(&path, STILL, is_command);
    recording.put_by(&mut ()).unwrap();
    let (put_by, _) = saved(&path);
    let there = std::fs::read(&path).unwrap();
    let (_, end) = records(&there, PUT_BY);
    assert_eq!(end, there.len(), "handed over whole");
    for sent in &rest {
        sent.push(&mut recording);
    }
    recording.finish(&mut ()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let all = lossless(&path);
    let cut = folder.path().join("cut.mcap");
    let mut from_both = 0;
    for length in (end..bytes.len()).step_by(173) {
        std::fs::write(&cut, &bytes[..length]).unwrap();
        let (read, condition) = saved(&cut);
        from_both += u32::from(condition.salvaged > 0 && condition.put_by > 0);
        let once: BTreeSet<&Read> = read.iter().collect();
        assert_eq!(once.len(), read.len(), "{length}: something is there twice");
        let kept = put_by.iter().all(|m| once.contains(m));
        assert!(kept, "{length}: {} of {}", read.len(), put_by.len());
        assert!(read.iter().all(|m| all.contains(m)), "{length}");
    }
    assert!(from_both > 5, "{from_both}");
}

#[test]
fn what_is_damaged_counts_for_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (mut recording, _) = up_to(&path, STILL, is_command);
    recording.flush_if_due().unwrap();
    recording.put_by(&mut ()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let (at, end) = records(&bytes, PUT_BY);
    let complete = |m: &Read| m.2 < STILL * super::PERIOD_NS;
    for damaged in (at[0] + 9..end).step_by(97) {
        let mut bytes = bytes.clone();
        bytes[damaged] ^= 0x10;
        std::fs::write(&path, &bytes).unwrap();
        let (read, condition) = saved(&path);
        assert!(read.iter().all(complete) && condition.put_by == 0);
    }
    // Too short for its checksum.
    for length in 0..4_u64 {
        let mut bytes = bytes[..at[0]].to_vec();
        bytes.push(PUT_BY);
        bytes.extend_from_slice(&length.to_le_bytes());
        bytes.extend_from_slice(&[0; 4][..length as usize]);
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(saved(&path).1.put_by, 0);
    }
}

#[test]
fn before_the_world_no_chunk_is_without_messages() {
    // It would have no index, and Foxglove Studio opens no file with one.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    for rate_hz in [10.0, 0.0] {
        let mut options = options(&path);
        options.log.force = true;
        options.viewer.rate_hz = rate_hz;
        let mut recording = Recording::create(&options).unwrap();
        for sent in run(1, 1) {
            if matches!(sent, Sent::Status(..)) {
                sent.push(&mut recording);
            }
        }
        let before = std::fs::metadata(&path).unwrap().len();
        recording.put_by(&mut ()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let is_there = !records(&bytes, PUT_BY).0.is_empty();
        // Viewers are told where to look before anything happens; without them nothing is there.
        assert_eq!(is_there, rate_hz > 0.0);
        assert_eq!(bytes.len() as u64 > before, is_there);
        for chunk in records(&bytes, op::CHUNK).0 {
            let length = u64::from_le_bytes(bytes[chunk + 1..chunk + 9].try_into().unwrap());
            assert_eq!(bytes[chunk + 9 + length as usize], op::MESSAGE_INDEX);
        }
        drop(recording);
        std::fs::remove_file(&path).unwrap();
    }
}
