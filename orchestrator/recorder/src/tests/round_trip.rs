//! Tests of complete logs: every message is in the file once, in order, and readable with all checksums
//! verified.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::Path;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::{ObstacleEvent, WorldEvent};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{
    self, Arity, ObstacleEvents, Topic, TopicId, TopicVisitor, WorldEvents, WorldState,
    for_each_topic,
};
use ipc_types::{cdr, schema};
use mcap::sans_io::LinearReaderOptions;
use mcap_log::LogOptions;
use proptest::prelude::*;

use super::made_up::{PERIOD_NS, Sent, recording, run, run_info};
use crate::{ROBOTS_TOPIC, Recording, Summary};

/// A message read from a log: topic, sequence, log time, publish time, bytes.
pub(super) type Read = (String, u32, u64, u64, Vec<u8>);

/// Returns all messages of a finished log in file order, without the names of the robots, which come first; verifies
/// every checksum.
pub(super) fn read(path: &Path) -> Vec<Read> {
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true);
    let file = std::fs::File::open(path).unwrap();
    let mut read: Vec<Read> = mcap::io::MessageReader::new_with_options(file, options)
        .map(|message| {
            let m = message.unwrap();
            (
                m.channel.topic.clone(),
                m.sequence,
                m.log_time,
                m.publish_time,
                m.data.to_vec(),
            )
        })
        .collect();
    let names = read.remove(0);
    assert_eq!(names.0, ROBOTS_TOPIC);
    read
}

fn record(path: &Path, sent: &[Sent], batch: usize) -> Summary {
    let mut recording = recording(path, &LogOptions::default(), None);
    for batch in sent.chunks(batch.max(1)) {
        for message in batch {
            message.push(&mut recording);
        }
        // Messages are ordered by tick: ticks before the newest are complete.
        let newest = batch.last().unwrap().stamp().tick;
        if let Some(completed) = newest.checked_sub(1) {
            recording.advance(completed, &mut ()).unwrap();
        }
    }
    recording.finish(&mut ()).unwrap()
}

#[test]
fn every_message_is_in_the_log_once_in_order_and_counted() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let sent = run(12, 1_000_000_000);
    let summary = record(&path, &sent, 7);

    let read = read(&path);
    assert_eq!(read.len(), sent.len());
    for (message, sent) in read.iter().zip(&sent) {
        let stamp = sent.stamp();
        assert_eq!(u64::from(message.1), stamp.sequence, "{}", message.0);
        assert_eq!(
            (message.2, message.3),
            (stamp.time_ns, stamp.time_ns),
            "{}",
            message.0
        );
        if let Sent::State(header, robots) = sent {
            assert_eq!(message.0, WorldState::NAME);
            let (header_read, robots_read) = cdr::decode::<WorldState>(&message.4).unwrap();
            assert_eq!((&header_read, &robots_read), (header, robots));
        }
    }
    let mut counted: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let mut last: BTreeMap<&str, u64> = BTreeMap::new();
    for (topic, _, log_time, _, bytes) in &read {
        let count = counted.entry(topic.clone()).or_default();
        *count = (count.0 + 1, count.1 + bytes.len() as u64);
        let before = last.insert(topic, *log_time).unwrap_or(0);
        assert!(
            before <= *log_time,
            "{topic} goes back from {before} to {log_time}"
        );
    }
    let in_summary: BTreeMap<String, (u64, u64)> = summary
        .topics
        .iter()
        .filter(|(t, _)| *t != ROBOTS_TOPIC)
        .map(|(t, c)| (t.clone(), (c.messages, c.bytes)))
        .collect();
    assert_eq!(
        in_summary, counted,
        "the summary counts the messages in the file"
    );
    assert!(
        summary
            .topics
            .values()
            .all(|t| t.gaps == 0 && t.rejected == 0)
    );
    assert_eq!(summary.log_bytes, path.metadata().unwrap().len());
}

#[test]
fn a_message_of_every_topic_is_recorded() {
    struct Push<'a>(&'a mut Recording);
    impl TopicVisitor for Push<'_> {
        type Error = Infallible;
        fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
            // The default header of a map declares 0 cells.
            let count = usize::from(T::ARITY == Arity::One);
            let elements = [T::Element::default()];
            self.0.push::<T>(&T::Header::default(), &elements[..count]);
            Ok(())
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recording = recording(&path, &LogOptions::default(), None);
    let Ok(()) = for_each_topic(&mut Push(&mut recording));
    let summary = recording.finish(&mut ()).unwrap();

    let read = read(&path);
    for name in topics::NAMES {
        assert_eq!(read.iter().filter(|m| m.0 == *name).count(), 1, "{name}");
        let counted = &summary.topics[*name];
        assert_eq!((counted.messages, counted.rejected), (1, 0), "{name}");
    }
}

#[test]
fn messages_for_times_after_the_end_do_not_extend_the_log() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut sent = run(6, 1);
    let mut header = PlainHeader::default();
    header.stamp.tick = 500;
    header.stamp.time_ns = 500 * PERIOD_NS;
    header.stamp.sequence = 1;
    let event = ObstacleEvent {
        id: 5,
        radius: 1.0,
        ..ObstacleEvent::default()
    };
    sent.push(Sent::Obstacle(header, event));
    let summary = record(&path, &sent, 3);
    assert_eq!(summary.topics[ObstacleEvents::NAME].messages, 2);
    assert_eq!(summary.topics[ObstacleEvents::NAME].rejected, 0);
    assert_eq!(summary.ticks, 5);
    assert_eq!(
        summary.coverage.unwrap().visited_m2,
        1.0,
        "as last reported"
    );
    let bytes = std::fs::read(&path).unwrap();
    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    let end = index.stats.unwrap().message_end_time;
    assert_eq!(end, 5 * PERIOD_NS);
}

#[test]
fn the_file_describes_itself() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let summary = record(&path, &run(4, 1), 100);
    let bytes = std::fs::read(&path).unwrap();

    // The manifest precedes all messages.
    let records: Vec<u8> = mcap::read::LinearReader::new(&bytes)
        .unwrap()
        .map(|r| r.unwrap().opcode())
        .collect();
    let place = |opcode: u8| records.iter().position(|&o| o == opcode).unwrap();
    assert!(place(mcap::records::op::METADATA) < place(mcap::records::op::CHUNK));
    assert!(place(mcap::records::op::ATTACHMENT) < place(mcap::records::op::CHUNK));

    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    let metadata: BTreeMap<_, _> = index
        .metadata_indexes
        .iter()
        .map(|i| mcap::read::metadata(&bytes, i).unwrap())
        .map(|m| (m.name, m.metadata))
        .collect();
    assert_eq!(metadata["protean"]["seed"], "7");
    assert_eq!(metadata["protean.result"]["digest"], summary.digest);
    let attachment = mcap::read::attachment(&bytes, &index.attachment_indexes[0]).unwrap();
    assert_eq!(attachment.data.as_ref(), b"name = \"made up\"\n");
    let state = index
        .channels
        .values()
        .find(|c| c.topic == WorldState::NAME)
        .unwrap();
    assert_eq!(state.message_encoding, "cdr");
    assert_eq!(state.metadata["schema_hash"], schema::hash::<WorldState>());
    let text = state.schema.as_ref().unwrap();
    assert_eq!(
        (text.encoding.as_str(), text.name.as_str()),
        ("ros2msg", "protean/msg/WorldState")
    );
}

#[test]
fn the_summary_contains_outcomes_events_and_latencies() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let summary = record(&path, &run(12, 1_000), 3);
    assert_eq!((summary.ticks, summary.sim_time_s), (11, 0.55));
    let robots: Vec<_> = summary
        .robots
        .iter()
        .map(|r| {
            (
                r.name.as_str(),
                r.team.as_str(),
                r.outcome.as_str(),
                r.time_s,
            )
        })
        .collect();
    assert_eq!(
        robots,
        [
            ("police_1", "police", "active", 0.55),
            ("police_2", "police", "active", 0.55),
            ("baddie_1", "evader", "caught", 0.25)
        ]
    );
    assert_eq!(summary.events.len(), 1);
    let event = &summary.events[0];
    assert_eq!((event.time_s, event.kind.as_str()), (0.25, "captured"));
    assert_eq!(
        (event.robot.as_deref(), event.other),
        (Some("baddie_1"), Some(0))
    );
    // Perception sends at 25 µs; the pursuers, which wait for it, receive it at 30 and 40 µs.
    let hop = &summary.latency_us["perception to pursuer"];
    assert_eq!((hop.count, hop.max), (24, 15.0));
    assert_eq!(summary.latency_us["simulator to evader"].count, 12);
    assert!(summary.latency_us.contains_key(crate::chain::WHOLE));
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["topics"]["world/state"]["gaps"], 0);
    assert_eq!(json["latency_us"]["pursuer step"]["p50"], 5.0);
    assert_eq!(serde_json::from_value::<Summary>(json).unwrap(), summary);
}

#[test]
fn observers_receive_events_when_their_tick_is_written() {
    #[derive(Default)]
    struct Seen(Vec<String>);
    impl Consumer for Seen {
        fn topics(&self) -> &[TopicId] {
            &[TopicId::WorldEvents]
        }

        fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
            let (_, events) = message.view::<WorldEvents>().unwrap();
            for event in events {
                let what = WorldEvent::name_of(event.kind);
                self.0.push(format!("{what} at {}", message.time_s()));
            }
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let mut recording = recording(
        &directory.path().join("run.mcap"),
        &LogOptions::default(),
        None,
    );
    for sent in &run(7, 1) {
        sent.push(&mut recording);
    }
    let mut seen = Seen::default();
    recording.advance(4, &mut seen).unwrap();
    assert!(seen.0.is_empty());
    recording.finish(&mut seen).unwrap();
    assert_eq!(seen.0, ["captured at 0.25"]);
}

#[test]
fn without_a_log_the_summary_is_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let sent = run(12, 1_000);
    let mut with_log = record(&path, &sent, 7);
    let mut recording = Recording::new(&run_info(), std::sync::Arc::default());
    for message in &sent {
        message.push(&mut recording);
    }
    let without = recording.finish(&mut ()).unwrap();
    with_log.log = std::path::PathBuf::new();
    with_log.log_bytes = 0;
    with_log.topics.remove(ROBOTS_TOPIC);
    assert_eq!(without, with_log);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn log_and_digest_do_not_depend_on_arrival_batches_or_clocks(
        seed in any::<u64>(), batch in 1_usize..60, clock in 1_u64..1_000_000_000_000,
    ) {
        let directory = tempfile::tempdir().unwrap();
        let paths = ["a", "b"].map(|name| directory.path().join(format!("{name}.mcap")));
        let sent = run(8, 1_000);
        let reference = record(&paths[0], &sent, 1000);

        // The same run with other clock readings and a random interleaving that keeps the order of each
        // source; all messages of a tick precede those of the next tick but one.
        let mut rest: BTreeMap<u32, std::collections::VecDeque<Sent>> = BTreeMap::new();
        for message in run(8, clock) {
            rest.entry(message.stamp().source).or_default().push_back(message);
        }
        let mut recording = recording(&paths[1], &LogOptions::default(), None);
        let mut state = seed;
        let mut pushed = 0;
        while !rest.is_empty() {
            let oldest = rest.values().map(|queue| queue[0].stamp().tick).min().unwrap();
            let sources: Vec<u32> = rest
                .iter()
                .filter(|(_, queue)| queue[0].stamp().tick <= oldest + 1)
                .map(|(source, _)| *source)
                .collect();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let source = sources[(state >> 33) as usize % sources.len()];
            let queue = rest.get_mut(&source).unwrap();
            queue.pop_front().unwrap().push(&mut recording);
            if queue.is_empty() {
                rest.remove(&source);
            }
            pushed += 1;
            if pushed % batch == 0 {
                let oldest = rest.values().map(|queue| queue[0].stamp().tick).min();
                if let Some(completed) = oldest.and_then(|tick| tick.checked_sub(1)) {
                    recording.advance(completed, &mut ()).unwrap();
                }
            }
        }
        let other = recording.finish(&mut ()).unwrap();
        prop_assert_eq!(&reference.digest, &other.digest);
        prop_assert_eq!(&reference.topics, &other.topics);
        let without_clocks = |path: &Path| -> Vec<_> {
            read(path)
                .into_iter()
                .map(|mut m| {
                    m.4[4 + Stamp::SIMULATED_BYTES..4 + size_of::<Stamp>()].fill(0);
                    m
                })
                .collect()
        };
        // Not `prop_assert_eq`: it would print both logs.
        prop_assert!(without_clocks(&paths[0]) == without_clocks(&paths[1]));
    }
}
