//! Comparison of a run with itself.

use std::path::Path;

use diff::diff_before;
use ipc_types::messages::robot::Command;
use mcap_log::LogReadError;

use crate::ReplayError;
use crate::{RerunOptions, rerun};
use kinds::load;
use log_tools::recover;
use mission::in_process::{self, InProcessOptions};
use viewer::{ViewerOptions, viewer_topics};

use self::support::{rewrite, small, watch};

// Each including crate uses only parts of them.
#[allow(dead_code)]
#[path = "../../recorder/src/tests/made_up.rs"]
mod made_up;
#[allow(dead_code)]
#[path = "../../log_tools/src/tests/support.rs"]
mod support;

/// Records the test run, with viewer topics.
fn record_run(path: &Path, ticks: u64, chunk_bytes: u64, change: impl Fn(&mut Command, u64)) {
    let topics = viewer_topics(&made_up::run_info(), &ViewerOptions::default());
    made_up::record_run(path, ticks, chunk_bytes, topics, change);
}

const IN_PROCESS: RerunOptions = RerunOptions {
    in_process: true,
    allow_external: false,
    failures: false,
};

#[test]
fn the_first_difference_of_every_topic_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    record_run(&path("a"), 8, 4_000, |_, _| {});
    record_run(&path("b"), 8, 900, |_, _| {});
    record_run(&path("c"), 8, 4_000, |command, tick| {
        if tick >= 3 && command.robot == 1 {
            command.omega = -0.5;
        }
    });
    record_run(&path("d"), 6, 4_000, |_, _| {});
    let twice = |a: &str, b: &str, before| {
        let report = diff_before(&path(a), &path(b), before, &mut watch()).unwrap();
        report.comparison
    };
    let same = twice("a", "b", u64::MAX);
    assert!(same.first.is_none() && same.equal() > 90, "{same:?}");
    let differs = twice("a", "c", u64::MAX);
    let first = differs.first.as_ref().unwrap();
    let [cause] = &first.causes[..] else {
        panic!("{first:?}");
    };
    assert_eq!((&*cause.topic, cause.tick), ("robot/command", 3));
    assert_eq!(cause.process, "process 4", "the log does not name it");
    assert_eq!(
        (&*cause.field, &*cause.a, &*cause.b),
        ("omega", "0.2", "-0.5")
    );
    let topics = differs.topics.iter();
    let topics: Vec<_> = topics.filter(|(_, topic)| topic.different > 0).collect();
    assert_eq!(topics.len(), 1);
    assert_eq!(
        (topics[0].1.different, topics[0].1.first_tick),
        (5, Some(3))
    );
    assert_eq!(differs.equal() + 5, same.equal());
    // They are identical up to the tick in which they differ.
    let time = |tick| (first.time_s * 1e9 / 3.0).round() as u64 * tick;
    let before = twice("a", "c", time(3));
    assert!(before.first.is_none() && before.equal() > 30, "{before:?}");
    assert_eq!(before.last_tick, 2);
    assert!(twice("a", "c", 0).is_empty());
    // Messages in only one of them. The last state of a short run marks its end.
    for (a, b) in [("a", "d"), ("d", "a")] {
        let differs = twice(a, b, u64::MAX);
        let command = &differs.topics["robot/command"];
        assert_eq!((command.first_tick, command.different), (Some(6), 6));
        assert_eq!(command.a > command.b, a == "a");
        let first = differs.first.unwrap();
        let mut all = first.causes.iter().chain(&first.effects);
        let state = all.find(|change| change.topic == "world/state").unwrap();
        assert_eq!(state.field, "phase");
    }
}

/// A short chase.
fn play(path: &Path) -> String {
    let set = ["rules.time_limit=1".to_owned()];
    let scenario = load("chase_exact", &set, Some(3)).unwrap();
    let options = InProcessOptions {
        out: Some(path.to_owned()),
        ..InProcessOptions::default()
    };
    in_process::run(&scenario, &options).unwrap().summary.digest
}

#[test]
fn a_repeated_run_is_identical_and_a_changed_log_is_detected() {
    let folder = tempfile::tempdir().unwrap();
    let (log, other) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    let digest = play(&log);
    let done = rerun(&log, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap();
    assert!(done.same && done.whole);
    assert_eq!(
        (Some(&digest), &digest),
        (done.digest_logged.as_ref(), &done.digest)
    );
    let equal = done.comparison.equal();
    assert!(equal > 100);

    // One bit of one message differs.
    let mut seen = 0;
    rewrite(
        &log,
        &other,
        |channel, data| {
            seen += usize::from(channel.topic == "robot/command");
            if seen == 20 && channel.topic == "robot/command" {
                data[4 + size_of::<ipc_types::stamp::Stamp>()] ^= 1;
            }
            true
        },
        |_| {},
        |_| true,
    );
    let done = rerun(&other, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap();
    assert!(!done.same);
    let comparison = done.comparison;
    assert_eq!(comparison.equal() + 1, equal);
    let first = comparison.first.unwrap();
    let [cause] = &first.causes[..] else {
        panic!("{first:?}");
    };
    assert_eq!((&*cause.topic, &*cause.field), ("robot/command", "v"));
    let robot = cause.robot.as_ref().unwrap();
    assert!(cause.process.ends_with(robot), "the culprit is named");

    // A digest that does not belong to the messages.
    let wrong = |record: &mut mcap::records::Metadata| {
        if let Some(digest) = record.metadata.get_mut("digest") {
            *digest = "0".repeat(64);
        }
    };
    rewrite(&log, &other, |_, _| true, wrong, |_| true);
    let done = rerun(&other, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap();
    assert!(!done.same && done.comparison.first.is_none());
}

#[test]
fn a_truncated_log_is_compared_up_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let (log, cut) = (folder.path().join("a.mcap"), folder.path().join("cut.mcap"));
    play(&log);
    // Killed within a tick: no further messages, no result, no summary.
    let total = support::theirs(&log).len();
    let (mut seen, short) = (0, folder.path().join("short.mcap"));
    let keep = |_: &_, _: &mut Vec<u8>| {
        seen += 1;
        seen < total * 2 / 3
    };
    let lose = |record: &mut mcap::records::Metadata| {
        record.metadata.remove("digest");
    };
    rewrite(&log, &short, keep, lose, |_| true);
    let bytes = std::fs::read(&short).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() - 1_000]).unwrap();
    let recovered = folder.path().join("recovered.mcap");
    recover(&cut, &recovered, false, &mut watch()).unwrap();
    for log in [&cut, &recovered] {
        let done = rerun(log, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap();
        assert!(done.same && !done.whole, "{done:?}");
        assert_eq!(done.digest_logged, None);
        let comparison = done.comparison;
        assert!(comparison.equal() > 20, "{comparison:?}");
    }
}

#[test]
fn a_repetition_does_not_go_on_past_the_end_of_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("a.mcap");
    let set = ["rules.time_limit=60".to_owned()];
    let scenario = load("chase_exact", &set, Some(3)).unwrap();
    let options = InProcessOptions {
        out: Some(log.clone()),
        last_tick: Some(7),
        ..InProcessOptions::default()
    };
    let ticks = in_process::run(&scenario, &options).unwrap().summary.ticks;
    let done = rerun(&log, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap();
    assert!(done.same && !done.whole, "{done:?}");
    assert_eq!((ticks, done.ticks), (7, 7));
}

#[test]
fn runs_that_cannot_be_repeated_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let (log, other) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    play(&log);
    let refused = |words: &str| {
        let error = rerun(&other, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap_err();
        assert!(error.to_string().contains(words), "{words}: {error}");
        error
    };
    let replaced = |text: &mut Vec<u8>, from: &str, to: &str| {
        let old = String::from_utf8(text.clone()).unwrap();
        assert!(old.contains(from), "{old}");
        *text = old.replace(from, to).into_bytes();
        true
    };
    let forget = |record: &mut mcap::records::Metadata| {
        record.metadata.remove("scenario_blake3");
    };
    rewrite(
        &log,
        &other,
        |_, _| true,
        |_| {},
        |t| replaced(t, "seed = 3", "seed = 4"),
    );
    refused("not the one of the run");
    rewrite(
        &log,
        &other,
        |_, _| true,
        forget,
        |t| replaced(t, "lock_step", "real_time"),
    );
    refused("in real time");
    rewrite(
        &log,
        &other,
        |_, _| true,
        forget,
        |t| replaced(t, "kind = \"pursuer\"", "command = [\"./mine\"]"),
    );
    refused("--allow-external");
    rewrite(
        &log,
        &other,
        |_, _| true,
        forget,
        |t| replaced(t, "seed = 3", "sead = 3"),
    );
    refused("unknown key");
    rewrite(&log, &other, |_, _| true, |_| {}, |_| false);
    assert!(matches!(
        refused("no scenario"),
        ReplayError::Log(LogReadError::Foreign { .. })
    ));
    std::fs::remove_file(&other).unwrap();
    record_run(&other, 2, 4_000, |_, _| {});
    refused("its scenario is not valid for this version");
}

#[test]
fn logs_of_another_version_are_refused() {
    use std::sync::Arc;

    use mcap_log::output::Output;
    use mcap_log::reader::{Item, Reader};
    let folder = tempfile::tempdir().unwrap();
    let (log, other) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    play(&log);
    for (change, words) in [
        ("other", "have the layout other"),
        ("none", "have the layout none"),
    ] {
        let mut reader = Reader::open(&log, None).unwrap();
        let mut output = Output::create(&other, &log, true, "").unwrap();
        while let Some(item) = reader.next().unwrap() {
            match item {
                Item::Schema(id, schema) => output.schema(id, &schema).unwrap(),
                Item::Channel(channel) if channel.topic == "robot/plan" => {
                    if change == "other" {
                        let mut channel = Arc::unwrap_or_clone(channel);
                        channel
                            .metadata
                            .insert("schema_hash".into(), "other".into());
                        output.channel(&channel).unwrap();
                    }
                }
                Item::Channel(channel) => output.channel(&channel).unwrap(),
                Item::Attachment(header, data) => output.attachment(&header, data).unwrap(),
                Item::Metadata(record) => output.metadata(&record).unwrap(),
                Item::Message(..) | Item::Header { .. } => {}
            }
        }
        output.finish().unwrap();
        let error = rerun(&other, kinds::KINDS, IN_PROCESS, &mut watch()).unwrap_err();
        assert!(
            matches!(error, ReplayError::Log(LogReadError::Layout { .. })),
            "{error}"
        );
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn a_log_of_another_program_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("other.mcap");
    std::fs::write(&log, small(mcap::WriteOptions::new(), 2, 3)).unwrap();
    let error = rerun(&log, kinds::KINDS, RerunOptions::default(), &mut watch()).unwrap_err();
    assert!(
        matches!(error, ReplayError::Log(LogReadError::Foreign { .. })),
        "{error}"
    );
}
