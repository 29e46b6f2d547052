//! Tables of messages.

use std::path::Path;

use mcap_log::{DerivedError, Topics};
use tables::{ColumnValues, Format, Values};

use super::record_run;
use super::support::{theirs, watch};
use crate::{
    ExportOptions, ExportReport, LogInfo, Measured, TopicColumns, events, export, ros2bag,
};

fn options(format: Format, only: &[&str]) -> ExportOptions {
    ExportOptions {
        format,
        topics: Topics {
            only: only.iter().map(|&topic| topic.to_owned()).collect(),
            without: Vec::new(),
        },
        force: false,
    }
}

fn csv(path: &Path) -> (Vec<String>, Vec<csv::StringRecord>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    (header, reader.records().map(Result::unwrap).collect())
}

fn exported(folder: &Path) -> ExportReport {
    let log = folder.join("run.mcap");
    record_run(&log, 6);
    export(
        &log,
        &folder.join("tables"),
        &options(Format::Csv, &[]),
        &mut watch(),
    )
    .unwrap()
}

#[test]
fn every_protean_topic_is_a_table_with_a_row_for_every_element() {
    let folder = tempfile::tempdir().unwrap();
    let done = exported(folder.path());
    let messages = theirs(&folder.path().join("run.mcap"));
    for (topic, table) in &done.tables {
        let source = match topic.as_str() {
            "beliefs" => "perception/belief",
            topic => topic,
        };
        let expected = messages.iter().filter(|m| m.0 == source).count() as u64;
        assert_eq!(
            (table.messages, table.undecodable),
            (expected, 0),
            "{topic}"
        );
        assert_eq!(csv(&table.file).1.len() as u64, table.rows, "{topic}");
    }
    let with: std::collections::BTreeSet<&str> = messages.iter().map(|m| m.0.as_str()).collect();
    // With the table that is measured.
    assert_eq!(done.tables.len() + done.skipped.len(), with.len() + 1);
    assert!(done.skipped.keys().all(|topic| topic.starts_with('/')));

    let tables = folder.path().join("tables");
    let (header, rows) = csv(&tables.join("world.state.csv"));
    let column = |name: &str| header.iter().position(|n| n == name).expect(name);
    assert_eq!(rows.len(), 6 * 3);
    let row = &rows[3 * 4 + 2];
    for (name, value) in [
        ("log_time_ns", "200000000"),
        ("stamp.tick", "4"),
        ("robots.index", "2"),
        ("robots.robot", "2"),
        ("robots.robot_name", "baddie_1"),
        ("robots.y", "2.0"),
        ("robots.x", "0.4"),
    ] {
        assert_eq!(&row[column(name)], value, "{name}");
    }
    let (header, rows) = csv(&tables.join("robot.scan.csv"));
    let ranges = header.iter().position(|n| n == "ranges").unwrap();
    let values: Vec<&str> = rows[..3].iter().map(|row| &row[ranges]).collect();
    assert_eq!(values, ["1.0", "1e999", "2.5"]);
    let (header, rows) = csv(&tables.join("process.status.csv"));
    let error = header.iter().position(|n| n == "error").unwrap();
    assert_eq!(&rows[0][error], "fine");
}

#[test]
fn a_refused_export_leaves_no_files() {
    let folder = tempfile::tempdir().unwrap();
    exported(folder.path());
    let (log, out) = (folder.path().join("run.mcap"), folder.path().join("tables"));
    let error = export(&log, &out, &options(Format::Csv, &[]), &mut watch()).unwrap_err();
    assert!(matches!(error, DerivedError::Exists { .. }), "{error}");
    let other = folder.path().join("other");
    assert!(export(&log, &other, &options(Format::Csv, &["nope"]), &mut watch()).is_err());
    assert!(!other.exists());
    let done = export(
        &log,
        &other,
        &options(Format::Csv, &["robot/*"]),
        &mut watch(),
    )
    .unwrap();
    assert!(done.tables.keys().all(|topic| topic.starts_with("robot/")));
    assert_eq!(
        std::fs::read_dir(&other).unwrap().count(),
        done.tables.len()
    );
}

#[test]
fn parquet_and_text_have_the_same_values() {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;
    let folder = tempfile::tempdir().unwrap();
    let text = exported(folder.path());
    let log = folder.path().join("run.mcap");
    let out = folder.path().join("parquet");
    let done = export(&log, &out, &options(Format::Parquet, &[]), &mut watch()).unwrap();
    for (topic, table) in &done.tables {
        let (header, records) = csv(&text.tables[topic].file);
        let file = std::fs::File::open(&table.file).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let mut rows = 0;
        for (row, record) in reader.get_row_iter(None).unwrap().zip(&records) {
            rows += 1;
            for (index, (name, field)) in row.unwrap().get_column_iter().enumerate() {
                assert_eq!(*name, header[index]);
                let cell = match field {
                    Field::Null => String::new(),
                    Field::Bool(v) => v.to_string(),
                    Field::Long(v) => v.to_string(),
                    Field::ULong(v) => v.to_string(),
                    Field::Float(v) => number(v),
                    Field::Double(v) => number(v),
                    Field::Str(v) => v.clone(),
                    other => panic!("{topic} {name}: {other:?}"),
                };
                assert_eq!(cell, record[index], "{topic} {name}");
            }
        }
        assert_eq!(rows as u64, table.rows, "{topic}");
    }
}

/// Returns the text of a number in CSV.
fn number(number: impl std::fmt::Debug) -> String {
    format!("{number:?}").replace("inf", "1e999")
}

/// Returns the text of a value in CSV.
fn text_of(column: &ColumnValues, row: usize) -> String {
    if column.empty.as_ref().is_some_and(|empty| empty[row]) {
        return String::new();
    }
    match &column.values {
        Values::Bool(values) => values[row].to_string(),
        Values::Int(values) => values[row].to_string(),
        Values::UInt(values) => values[row].to_string(),
        Values::F32(values) => number(values[row]),
        Values::F64(values) => number(values[row]),
        Values::Text(texts) => texts.distinct[texts.codes[row] as usize].clone(),
    }
}

#[test]
fn columns_in_memory_have_the_values_of_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let text = exported(folder.path());
    let log = folder.path().join("run.mcap");
    let info = LogInfo::read(&log, &mut watch()).unwrap();
    for (topic, table) in &text.tables {
        let (header, records) = csv(&table.file);
        let read = match info.topics.get(topic) {
            Some(info) => TopicColumns::read(&log, info.channel, &mut watch()),
            None => Measured::Beliefs.read(&log, &mut watch()),
        };
        let read = read.unwrap();
        let counts = (read.messages, read.rows, read.undecodable);
        assert_eq!(counts, (table.messages, table.rows, 0), "{topic}");
        let names: Vec<&str> = read.columns.iter().map(|column| &*column.name).collect();
        assert_eq!(names, header, "{topic}");
        for (row, record) in records.iter().enumerate() {
            let values = read.columns.iter().map(|column| text_of(column, row));
            let expected: Vec<&str> = record.iter().collect();
            assert_eq!(values.collect::<Vec<_>>(), expected, "{topic}");
        }
    }
}

#[test]
fn events_of_a_log_are_those_of_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    let summary = record_run(&log, 6);
    let read = events(&log, &mut watch()).unwrap();
    assert!(!read.is_empty());
    assert_eq!(read, summary.events);
}

#[test]
fn columns_in_memory_end_where_the_log_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    record_run(&log, 60);
    let whole = std::fs::read(&log).unwrap();
    let info = LogInfo::read(&log, &mut watch()).unwrap();
    let topic = &info.topics["world/state"];
    let error = TopicColumns::read(&log, 60_000, &mut watch()).unwrap_err();
    assert!(error.to_string().contains("no channel 60000"), "{error}");
    let mut least = u64::MAX;
    for length in [whole.len() - 100, whole.len() / 2] {
        std::fs::write(&log, &whole[..length]).unwrap();
        let cut = TopicColumns::read(&log, topic.channel, &mut watch()).unwrap();
        let counted = LogInfo::read(&log, &mut watch()).unwrap().topics;
        assert_eq!(cut.messages, counted["world/state"].messages);
        least = least.min(cut.messages);
    }
    assert!(0 < least && least < topic.messages, "{least}");
}

#[test]
fn a_bag_of_a_cut_log_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (log, bag) = (folder.path().join("run.mcap"), folder.path().join("bag"));
    record_run(&log, 6);
    let whole = std::fs::read(&log).unwrap();
    std::fs::write(&log, &whole[..whole.len() - 100]).unwrap();
    let error = ros2bag(&log, &bag, false, &mut watch()).unwrap_err();
    assert!(error.to_string().contains("protean recover"), "{error}");
    assert!(!bag.exists());
    std::fs::write(&log, &whole).unwrap();
    let made = ros2bag(&log, &bag, false, &mut watch()).unwrap();
    assert_eq!(made.messages, theirs(&log).len() as u64);
    assert_eq!(std::fs::read(&made.log).unwrap(), whole);
    let again = ros2bag(&log, &bag, false, &mut watch()).unwrap_err();
    assert!(matches!(again, DerivedError::Exists { .. }), "{again}");
}
