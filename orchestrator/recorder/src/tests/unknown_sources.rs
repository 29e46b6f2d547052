//! Tests of invalid messages: they are counted, and logged if readers can decode them.

use ipc_types::messages::robot::Command;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::Topic;
use ipc_types::topics::{Commands, WorldState};
use mcap_log::LogOptions;

use super::made_up::{FIRST_ROBOT, PERIOD_NS, Sent, recording, run};
use super::round_trip::read;
use crate::Summary;

fn with(extra: &[Sent]) -> (Summary, Vec<(String, u64, Vec<u8>)>) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recording = recording(&path, &LogOptions::default(), None);
    for sent in &run(6, 1) {
        sent.push(&mut recording);
    }
    for sent in extra {
        sent.push(&mut recording);
    }
    recording.advance(5, &mut ()).unwrap();
    assert_eq!(recording.waiting_bytes(), 0, "no message stays pending");
    let summary = recording.finish(&mut ()).unwrap();
    let messages = read(&path).into_iter().map(|m| (m.0, m.2, m.4)).collect();
    (summary, messages)
}

fn command(change: impl FnOnce(&mut Stamp, &mut Vec<Command>)) -> Sent {
    let mut header = PlainHeader {
        stamp: Stamp {
            tick: 5,
            time_ns: 5 * PERIOD_NS,
            sequence: 6,
            source: FIRST_ROBOT,
            ..Stamp::default()
        },
    };
    let mut elements = vec![Command::default()];
    change(&mut header.stamp, &mut elements);
    Sent::Command(header, elements)
}

#[test]
fn invalid_messages_are_logged_and_counted_as_rejected() {
    let expected = with(&[]).0;
    for (what, sent) in [
        ("not a number", command(|_, c| c[0].v = f64::NAN)),
        ("another time", command(|stamp, _| stamp.time_ns += 1)),
        (
            "a tick too far ahead",
            command(|stamp, _| stamp.tick = u64::MAX),
        ),
        (
            "an unknown source",
            command(|stamp, _| stamp.source = 4_000),
        ),
    ] {
        let (summary, messages) = with(&[sent]);
        let count = summary.topics[Commands::NAME];
        assert_eq!((count.messages, count.rejected), (19, 1), "{what}");
        assert_eq!(
            messages.iter().filter(|m| m.0 == Commands::NAME).count(),
            19,
            "{what}"
        );
        assert!(
            messages.iter().all(|m| m.1 <= 5 * PERIOD_NS),
            "{what} does not extend the run"
        );
        assert_ne!(
            summary.digest, expected.digest,
            "{what} is part of the digest"
        );
    }
}

#[test]
fn messages_with_a_wrong_number_of_elements_are_counted_as_rejected_and_left_out() {
    for count in [0, 2] {
        let sent = command(|_, commands| commands.resize(count, Command::default()));
        let (summary, messages) = with(&[sent]);
        let counted = summary.topics[Commands::NAME];
        assert_eq!((counted.messages, counted.rejected), (18, 1));
        assert_eq!(
            messages.iter().filter(|m| m.0 == Commands::NAME).count(),
            18
        );
    }
}

#[test]
fn gaps_are_counted_where_they_are() {
    let (summary, _) = with(&[command(|stamp, _| stamp.sequence = 9)]);
    assert_eq!(summary.topics[Commands::NAME].gaps, 3);
    assert_eq!(summary.topics[WorldState::NAME].gaps, 0);
    let (summary, _) = with(&[command(|stamp, _| stamp.sequence = 0)]);
    assert_eq!(
        summary.topics[Commands::NAME].gaps,
        0,
        "a restart is not a loss"
    );
}

#[test]
fn a_late_message_is_written_late_without_going_back_in_time() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recording = recording(&path, &LogOptions::default(), None);
    let sent = run(6, 1);
    let late = sent
        .iter()
        .position(|s| matches!(s, Sent::Command(h, _) if h.stamp.tick == 2));
    let late = late.unwrap();
    for (i, message) in sent.iter().enumerate() {
        if i != late {
            message.push(&mut recording);
        }
    }
    recording.advance(4, &mut ()).unwrap();
    sent[late].push(&mut recording);
    let summary = recording.finish(&mut ()).unwrap();
    assert_eq!(summary.topics[Commands::NAME].messages, 18);
    let commands: Vec<_> = read(&path)
        .into_iter()
        .filter(|m| m.0 == Commands::NAME)
        .map(|m| (m.2, m.3))
        .collect();
    assert!(commands.windows(2).all(|w| w[0].0 <= w[1].0));
    assert!(
        commands.contains(&(4 * PERIOD_NS, 2 * PERIOD_NS)),
        "{commands:?}"
    );
}
