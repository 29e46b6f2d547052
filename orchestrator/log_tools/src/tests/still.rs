//! A world that stops within a tick, and one in real time: received messages are written once, a quarter of a second
//! after their tick began.

use std::path::Path;
use std::time::{Duration, Instant};

use mcap_log::{LogOptions, ReadProgress};
use recorder::{ROBOTS_TOPIC, Recording};

use super::made_up::{PERIOD_NS, Sent, recording, run};
use super::support::{Read, theirs};
use super::{pictures, record_run};
use crate::{LogInfo, recover};

const TICKS: u64 = 9;
/// Tick in which the world stops.
const STILL: u64 = 6;

fn is_command(sent: &Sent) -> bool {
    matches!(sent, Sent::Command(..))
}

/// Returns the messages of a log whose chunks close at every check, except those that the
/// recorder adds.
fn lossless(path: &Path) -> Vec<Read> {
    let out = path.with_extension("saved");
    let mut watch = ReadProgress::new(std::sync::Arc::default(), true);
    recover(path, &out, true, &mut watch).unwrap();
    let info = LogInfo::read(&out, &mut watch).unwrap();
    assert!(info.condition.is_whole(), "{:?}", info.condition);
    let mut read = theirs(&out);
    read.retain(|m| !m.0.starts_with('/') && m.0 != ROBOTS_TOPIC);
    read
}

fn create(path: &Path) -> Recording {
    let options = LogOptions {
        flush_every: Duration::ZERO,
        ..LogOptions::default()
    };
    recording(path, &options, pictures())
}

/// Writes the ready messages and passes them to the operating system.
fn look(recording: &mut Recording, completed: Option<u64>, now: Instant) {
    recording.write_ready(completed, now, &mut ()).unwrap();
    recording.flush_if_due().unwrap();
}

#[test]
fn a_tick_that_does_not_end_is_written_after_a_quarter_of_a_second_and_every_message_once() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    let ms = |ms| start + Duration::from_millis(ms);
    let untouched = record_run(&folder.path().join("whole.mcap"), TICKS);
    for still in [0, STILL] {
        let path = folder.path().join(format!("{still}.mcap"));
        let mut recording = create(&path);
        let mut rest = Vec::new();
        for sent in run(TICKS, 1) {
            let tick = sent.stamp().tick;
            if tick < still || (tick == still && !is_command(&sent)) {
                sent.push(&mut recording);
            } else {
                rest.push(sent);
            }
        }
        let completed = still.checked_sub(1);
        for now in [ms(0), ms(249)] {
            look(&mut recording, completed, now);
            let there = lossless(&path);
            assert!(there.iter().all(|m| m.2 < still * PERIOD_NS), "{still}");
        }
        look(&mut recording, completed, ms(250));
        let sent = run(TICKS, 1);
        let is_written = |s: &&Sent| {
            let tick = s.stamp().tick;
            tick < still || (tick == still && !is_command(s))
        };
        let message_count = sent.iter().filter(is_written).count();
        assert_eq!(lossless(&path).len(), message_count, "{still}");
        // Later messages are present at the next check.
        let (command, rest) = rest.split_first().unwrap();
        command.push(&mut recording);
        look(&mut recording, completed, ms(251));
        assert_eq!(lossless(&path).len(), message_count + 1, "{still}");

        for sent in rest {
            sent.push(&mut recording);
        }
        for tick in still..TICKS {
            look(&mut recording, Some(tick), ms(300 + tick));
        }
        let summary = recording.finish(&mut ()).unwrap();
        assert_eq!(summary.digest, untouched.digest);
        assert_eq!(summary.topics, untouched.topics);
        let all = lossless(&path);
        assert_eq!(all.len(), sent.len());
        assert!(all.is_sorted_by_key(|m| m.2), "time does not go back");
    }
}

#[test]
fn before_the_first_state_nothing_is_written_and_then_the_state_comes_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut recording = create(&path);
    let (states, others): (Vec<_>, Vec<_>) = run(1, 1)
        .into_iter()
        .partition(|sent| matches!(sent, Sent::State(..)));
    for sent in &others {
        sent.push(&mut recording);
    }
    let start = Instant::now();
    let late = start + Duration::from_secs(60);
    look(&mut recording, None, start);
    look(&mut recording, None, late);
    assert_eq!(lossless(&path), []);
    states[0].push(&mut recording);
    look(&mut recording, None, late);
    assert_eq!(lossless(&path), [], "its tick has just begun");
    look(&mut recording, Some(0), late);
    let topics: Vec<String> = lossless(&path).into_iter().map(|m| m.0).collect();
    assert_eq!(topics.len(), others.len() + 1);
    assert_eq!(topics[0], "world/state");
}

#[test]
fn in_real_time_ticks_are_written_when_they_are_old_however_many_follow() {
    let folder = tempfile::tempdir().unwrap();
    for period_ms in [2_u64, 50, 400] {
        let path = folder.path().join(format!("{period_ms}.mcap"));
        let mut recording = create(&path);
        let start = Instant::now();
        for sent in run(TICKS, 1) {
            let tick = sent.stamp().tick;
            if let Sent::State(..) = &sent {
                let ms = |ms| start + Duration::from_millis(ms);
                let now = ms(tick * period_ms);
                // The previous tick is over: it has no more messages.
                look(
                    &mut recording,
                    None,
                    ms((tick * period_ms).saturating_sub(1)),
                );
                let old = |tick: u64| (tick + 1) * period_ms > 250;
                let written = lossless(&path).into_iter().map(|m| m.2 / PERIOD_NS);
                let written: std::collections::BTreeSet<u64> = written.collect();
                let expected = (0..tick).filter(|of| old(tick - 1 - of));
                assert!(
                    written.iter().copied().eq(expected),
                    "{period_ms}: {written:?}"
                );
                sent.push(&mut recording);
                look(&mut recording, None, now);
            } else {
                sent.push(&mut recording);
            }
        }
        recording.finish(&mut ()).unwrap();
        assert_eq!(lossless(&path).len(), run(TICKS, 1).len());
    }
}
