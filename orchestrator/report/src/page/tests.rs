//! Tests with pages of short runs.

use std::path::{Path, PathBuf};

use mcap_log::output::Output;
use mcap_log::reader::{Item, Reader};
use mcap_log::{DerivedError, LogReadError, ReadProgress};
use serde_json::Value as Json;

use super::{Report, report};
use kinds::load;
use mission::in_process::{self, InProcessOptions};
use recorder::Summary;

fn watch() -> ReadProgress {
    ReadProgress::new(std::sync::Arc::default(), true)
}

/// Runs a short chase with a log.
fn play(folder: &Path) -> (PathBuf, Summary) {
    let log = folder.join("run.mcap");
    let set = ["rules.time_limit=1".to_owned()];
    let scenario = load("chase", &set, Some(3)).unwrap();
    let options = InProcessOptions {
        out: Some(log.clone()),
        ..InProcessOptions::default()
    };
    let done = in_process::run(&scenario, &options).unwrap();
    (log, done.summary)
}

/// Writes the page of a log, and returns the facts in it.
fn facts(log: &Path) -> (Report, Json) {
    let out = log.with_extension("html");
    let mut reports = report(&[log], &out, true, None, &mut watch()).unwrap();
    let report = reports.remove(0);
    let page = std::fs::read_to_string(&out).unwrap();
    assert_eq!(page.len() as u64, report.bytes);
    let start = "<script class=\"facts\" type=\"application/json\">";
    let (_, rest) = page.split_once(start).unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    (report, serde_json::from_str(json).unwrap())
}

#[test]
fn the_page_shows_the_result_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let (log, summary) = play(folder.path());
    let (report, facts) = facts(&log);
    assert_eq!(report.robots, summary.robots);
    assert_eq!(facts["outcome"], serde_json::json!(summary.robots));
    assert_eq!(facts["digest"], summary.digest.as_str());
    assert_eq!(report.digest.as_ref(), Some(&summary.digest));
    assert_eq!(facts["missing"], serde_json::json!([]));
    assert_eq!(report.frames as u64, summary.ticks + 1);
    assert_eq!(facts["end_s"], summary.sim_time_s);
    assert_eq!(
        facts["events"].as_array().unwrap().len(),
        summary.events.len()
    );
    let words = recorder::outcome_words(&summary.robots, summary.coverage.as_ref());
    assert_eq!(facts["result"], words.as_str());
    let lists = facts["lists"].as_array().unwrap();
    let length = |name: &str| {
        let list = lists.iter().find(|list| list["name"] == name).unwrap();
        list["length"].as_u64().unwrap()
    };
    assert_eq!(
        length("x"),
        (summary.ticks + 1) * summary.robots.len() as u64
    );
    assert!(
        length("beliefs.x") > 0 && length("plans.x") > 0,
        "{lists:?}"
    );
    let plots = facts["plots"].as_array().unwrap();
    for title in ["Evaders", "Distance driven", "Forward speed"] {
        assert!(plots.iter().any(|plot| plot["title"] == title), "{title}");
    }
    // Neither another page nor the log is replaced without `force`.
    let again = super::report(
        &[&log],
        &log.with_extension("html"),
        false,
        None,
        &mut watch(),
    );
    assert!(
        matches!(again, Err(DerivedError::Exists { .. })),
        "{again:?}"
    );
    let itself = super::report(&[&log], &log, true, None, &mut watch());
    assert!(
        matches!(itself, Err(DerivedError::IsTheLog { .. })),
        "{itself:?}"
    );
}

#[test]
fn a_continuation_has_the_motion_from_its_moment_on_within_its_share_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let (log, summary) = play(folder.path());
    let states = |of: usize| {
        let motion = super::continuation(&log, 0.5, of, &mut watch()).unwrap();
        assert_eq!(motion["outcome"], serde_json::json!(summary.robots));
        assert_eq!(motion["end_s"], summary.sim_time_s);
        let lists = motion["lists"].as_array().unwrap();
        assert_eq!(lists[2]["name"], "x");
        lists[2]["length"].as_u64().unwrap()
    };
    let robots = summary.robots.len() as u64;
    // Every 0.1 s, and as few as possible.
    assert_eq!(states(1), 6 * robots);
    assert_eq!(states(super::MOTION_STATES), 3 * robots);
}

#[test]
fn a_truncated_log_is_shown_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let (log, summary) = play(folder.path());
    let bytes = std::fs::read(&log).unwrap();
    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    // The chunk with the end of the run: on a busy machine, the last one is without.
    let end = index.chunk_indexes.iter().map(|i| i.message_end_time).max();
    let ends = index.chunk_indexes.iter();
    let ends = ends.filter(|i| Some(i.message_end_time) == end);
    let last = ends.map(|i| i.chunk_start_offset).min();
    let cut = folder.path().join("cut.mcap");
    std::fs::write(&cut, &bytes[..last.unwrap() as usize + 40]).unwrap();
    let (report, facts) = facts(&cut);
    let missing = facts["missing"].to_string();
    assert!(missing.contains("ends in the middle"), "{missing}");
    assert!(missing.contains("no result of the run"), "{missing}");
    assert_eq!(
        (&facts["digest"], &facts["over"]),
        (&Json::Null, &false.into())
    );
    assert!(!report.condition.is_whole());
    let names = |robots: &[recorder::RobotOutcome]| -> Vec<String> {
        robots.iter().map(|r| r.name.clone()).collect()
    };
    if report.frames > 0 {
        assert_eq!(names(&report.robots), names(&summary.robots));
        assert!(report.robots.iter().all(|r| r.time_s <= report.sim_time_s));
    }
    // At any length of the log, there is a page or an error.
    let out = folder.path().join("any.html");
    for part in 0..40 {
        std::fs::write(&cut, &bytes[..bytes.len() * part / 40]).unwrap();
        match super::report(&[&cut], &out, true, None, &mut watch()) {
            Ok(reports) => assert!(!reports[0].missing.is_empty()),
            Err(DerivedError::Log(LogReadError::NotMcap { .. } | LogReadError::Foreign { .. })) => {
            }
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn missing_topics_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (log, summary) = play(folder.path());
    let without = folder.path().join("without.mcap");
    let mut reader = Reader::open(&log, None).unwrap();
    let mut output = Output::create(&without, &log, false, "").unwrap();
    let mut omitted = Vec::new();
    while let Some(item) = reader.next().unwrap() {
        match item {
            Item::Header { .. } => {}
            Item::Schema(id, schema) => output.schema(id, &schema).unwrap(),
            Item::Channel(channel)
                if channel.topic == "world/state" || channel.topic.starts_with("perception/") =>
            {
                omitted.push(channel.id);
            }
            Item::Channel(channel) => output.channel(&channel).unwrap(),
            Item::Message(header, _) if omitted.contains(&header.channel_id) => {}
            Item::Message(header, data) => output.message(&header, data).unwrap(),
            Item::Attachment(header, data) => output.attachment(&header, data).unwrap(),
            Item::Metadata(record) => output.metadata(&record).unwrap(),
        }
    }
    output.finish().unwrap();
    let (report, facts) = facts(&without);
    let missing = report.missing.join("\n");
    assert!(
        missing.contains("no world/state: robots are shown at their start poses"),
        "{missing}"
    );
    assert_eq!(facts["outcome"], serde_json::json!(summary.robots));
    assert_eq!(facts["digest"], Json::Null);
}

#[test]
fn a_page_of_two_logs_has_both_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (log, summary) = play(folder.path());
    let other = folder.path().join("other.mcap");
    std::fs::copy(&log, &other).unwrap();
    let out = folder.path().join("both.html");
    let reports = super::report(&[&log, &other], &out, false, None, &mut watch()).unwrap();
    let page = std::fs::read_to_string(&out).unwrap();
    for report in &reports {
        assert_eq!(report.robots, summary.robots);
        assert_eq!((&report.page, report.bytes), (&out, page.len() as u64));
    }
    assert_eq!(page.matches("<script class=\"facts\"").count(), 2);
    assert!(
        page.contains("\"same\":true"),
        "the comparison is on the page"
    );
    let itself = super::report(&[&log, &other], &other, true, None, &mut watch());
    assert!(
        matches!(itself, Err(DerivedError::IsTheLog { .. })),
        "{itself:?}"
    );
}
