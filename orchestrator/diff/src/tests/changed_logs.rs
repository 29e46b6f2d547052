//! Logs in which the messages of processes are changed from a tick on, and those of the processes that hear them.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::stamp::Stamp;
use mcap_log::Origin;
use mcap_log::known::{self, ENCAPSULATION};
use mcap_log::output::Output;
use mcap_log::reader::{Item, Reader};
use mcap_log::ros2::{Cdr, Schema};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use recorder::RunInfo;
use tables::Cell;

use super::{TICKS, assert_caused, compared, run};
use crate::{DiffReport, diff};

/// Fields of a message with the offsets of their last bytes, without its stamp.
fn fields(schema: &Schema, data: &[u8]) -> Vec<(String, usize)> {
    let mut fields = Vec::new();
    let mut cdr = Cdr::new(schema, data).unwrap();
    for field in schema.fields() {
        cdr.field(field, &field.name, &mut |name, cell, end| {
            let last = end + ENCAPSULATION - 1;
            if last >= ENCAPSULATION + size_of::<Stamp>() && !matches!(cell, Cell::Text(_)) {
                fields.push((name.to_owned(), last));
            }
        })
        .unwrap();
    }
    fields
}

/// Copies a log. From a tick on, `change` may change each message of the history; it gets the sender, the topic, the
/// fields and the bytes.
fn rewritten(
    from: &Path,
    to: &Path,
    tick: u64,
    mut change: impl FnMut(u64, u32, &str, &[(String, usize)], &mut Vec<u8>),
) {
    let mut reader = Reader::open(from, None).unwrap();
    let mut output = Output::create(to, from, true, "").unwrap();
    let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
    while let Some(item) = reader.next().unwrap() {
        match item {
            Item::Header { .. } => {}
            Item::Schema(id, schema) => {
                schemas.insert(id, Schema::parse(&schema.name, &schema.data).unwrap());
                output.schema(id, &schema).unwrap();
            }
            Item::Channel(channel) => {
                output.channel(&channel).unwrap();
                channels.insert(channel.id, channel);
            }
            Item::Message(header, data) => {
                let mut data = data.to_vec();
                let channel = &channels[&header.channel_id];
                let is_simulated = channel
                    .metadata
                    .get("simulated")
                    .is_some_and(|v| v == "true");
                let stamp = known::stamp(&data);
                if is_simulated && let Some(stamp) = stamp.filter(|stamp| stamp.tick >= tick) {
                    let fields = fields(&schemas[&channel.schema_id], &data);
                    change(stamp.tick, stamp.source, &channel.topic, &fields, &mut data);
                }
                output.message(&header, &data).unwrap();
            }
            Item::Attachment(header, data) => output.attachment(&header, data).unwrap(),
            Item::Metadata(record) => output.metadata(&record).unwrap(),
        }
    }
    output.finish().unwrap();
}

/// Returns the description of the run in a log.
fn described(log: &Path) -> RunInfo {
    let mut reader = Reader::open(log, None).unwrap();
    let mut origin = Origin::default();
    while let Some(item) = reader.next().unwrap() {
        origin.add(&item);
    }
    RunInfo::from_log(&origin).unwrap()
}

#[test]
fn the_processes_whose_messages_change_first_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (
        run(&folder, "a.mcap", Vec::new()),
        folder.path().join("b.mcap"),
    );
    let info = described(&a);
    let process = |name: &str| info.processes.iter().find(|p| p.name == name).unwrap();
    let perception = process("perception").index;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut named = 0;
    while named < 40 {
        // Half of them are changes of the perception, which all pursuers hear within the tick.
        let (name, topics): (&str, &[&str]) = if named < 20 {
            ("perception", &["perception/belief", "perception/sighting"])
        } else {
            ("simulator", &["world/state"])
        };
        let source = process(name).index;
        let tick = rng.random_range(0..TICKS);
        let topic = topics[rng.random_range(0..topics.len())];
        let mut expected = None;
        rewritten(&a, &b, tick, |at, sender, of, fields, data| {
            let is_cause = sender == source && of == topic && at == tick;
            let listens = info.processes[sender as usize]
                .upstream
                .contains(&perception);
            let is_effect = (listens || name == "simulator") && sender != source && at == tick;
            let is_later = at > tick && rng.random_bool(0.3);
            if !(is_cause && expected.is_none() || is_effect || is_later) || fields.is_empty() {
                return;
            }
            let (field, byte) = &fields[rng.random_range(0..fields.len())];
            data[*byte] ^= 1;
            if is_cause {
                expected = Some(field.clone());
            }
        });
        let report = compared(&a, &b);
        let Some(field) = expected else {
            // The process sent nothing on the topic in that tick: the first difference comes later.
            assert!(
                report
                    .comparison
                    .first
                    .is_none_or(|first| first.time_s > 0.0)
            );
            continue;
        };
        assert_caused(&report, tick, &[(name, topic, &field)]);
        named += 1;
    }
}

#[test]
fn a_missing_message_is_a_difference_of_its_sender() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (
        run(&folder, "a.mcap", Vec::new()),
        folder.path().join("b.mcap"),
    );
    let info = described(&a);
    // The command of one pursuer in one tick has another sender, which the run does not have.
    let sender = info
        .processes
        .iter()
        .find(|p| p.name == "pursuer_police_3")
        .unwrap();
    rewritten(&a, &b, 30, |tick, source, topic, _, data| {
        if tick == 30 && source == sender.index && topic == "robot/command" {
            let at = ENCAPSULATION + core::mem::offset_of!(Stamp, source);
            data[at] = 77;
        }
    });
    let report = compared(&a, &b);
    let first = report.comparison.first.as_ref().unwrap();
    let found: Vec<_> = first
        .causes
        .iter()
        .map(|c| (&*c.process, &*c.field, &*c.a, &*c.b))
        .collect();
    let expected = [
        ("process 77", "", "", "message 30"),
        ("pursuer_police_3", "", "message 30", ""),
    ];
    assert_eq!(found, expected);
}

#[test]
fn other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    let refused = |words: &str| {
        let result: Result<DiffReport, _> =
            diff(&file, &file, &mut mcap_log::ReadProgress::default());
        let error = result.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refused("a.mcap");
    std::fs::write(&file, "no log").unwrap();
    refused("not an MCAP file");
}
