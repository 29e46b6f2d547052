//! A run, its log, its tables as Parquet: what the format's own reader finds in them is what the
//! messages of the log say.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use ipc_types::cdr;
use ipc_types::topics::{Topic as _, WorldState};
use orchestrator::in_process::{self, InProcessOptions};
use orchestrator::logs::{ExportOptions, Exported, Format, Topics, Watch, export};
use orchestrator::scenario;
use parquet::basic::Compression;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};

/// A second of a chase, as a log and as tables.
fn tables(folder: &Path) -> Exported {
    let log = folder.join("run.mcap");
    let changes = ["rules.time_limit=1".to_owned()];
    let scenario = scenario::load("chase_exact", &changes, Some(3)).unwrap();
    let options = InProcessOptions {
        out: Some(log.clone()),
        ..InProcessOptions::default()
    };
    in_process::run(&scenario, &options).unwrap();
    let options = ExportOptions {
        format: Format::Parquet,
        topics: Topics::default(),
        force: false,
    };
    let mut watch = Watch::new(Arc::default(), true);
    export(&log, &folder.join("tables"), &options, &mut watch).unwrap()
}

fn column<'r>(row: &'r Row, name: &str) -> &'r Field {
    let mut columns = row.get_column_iter();
    let found = columns.find(|(found, _)| *found == name);
    found.unwrap_or_else(|| panic!("no column {name}: {row}")).1
}

fn whole(row: &Row, name: &str) -> u64 {
    match column(row, name) {
        Field::ULong(value) => *value,
        Field::Long(value) => u64::try_from(*value).unwrap(),
        Field::UInt(value) => u64::from(*value),
        Field::Int(value) => u64::try_from(*value).unwrap(),
        other => panic!("{name}: {other:?}"),
    }
}

fn real(row: &Row, name: &str) -> f64 {
    match column(row, name) {
        Field::Double(value) => *value,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn the_states_of_a_run_are_read_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let exported = tables(folder.path());
    let bytes = std::fs::read(folder.path().join("run.mcap")).unwrap();
    let mut expected = Vec::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic == WorldState::NAME {
            let (header, robots) = cdr::decode::<WorldState>(&message.data).unwrap();
            for robot in robots {
                expected.push((message.log_time, header.stamp.tick, robot));
            }
        }
    }
    // Six robots, twenty ticks a second.
    assert!(expected.len() > 100, "{}", expected.len());

    let table = &exported.tables[WorldState::NAME];
    assert_eq!(table.rows, expected.len() as u64);
    let reader = SerializedFileReader::new(File::open(&table.file).unwrap()).unwrap();
    let group = reader.metadata().row_group(0);
    assert!(matches!(
        group.column(0).compression(),
        Compression::ZSTD(_)
    ));
    let mut rows = reader.get_row_iter(None).unwrap();
    for (time, tick, robot) in expected {
        let row = rows.next().unwrap().unwrap();
        assert_eq!(whole(&row, "log_time_ns"), time);
        assert_eq!(whole(&row, "stamp.tick"), tick);
        assert_eq!(whole(&row, "robots.robot"), u64::from(robot.robot));
        for (name, value) in [
            ("robots.x", robot.x),
            ("robots.y", robot.y),
            ("robots.theta", robot.theta),
            ("robots.distance", robot.distance),
        ] {
            assert_eq!(real(&row, name).to_bits(), value.to_bits(), "{name}");
        }
    }
    assert!(rows.next().is_none());
}

#[test]
fn every_table_has_the_rows_that_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let exported = tables(folder.path());
    assert!(exported.tables.len() > 5, "{:?}", exported.tables.keys());
    for (topic, table) in &exported.tables {
        let reader = SerializedFileReader::new(File::open(&table.file).unwrap()).unwrap();
        let rows = reader.get_row_iter(None).unwrap().map(Result::unwrap);
        assert_eq!(rows.count() as u64, table.rows, "{topic}");
        assert_eq!(table.undecodable, 0, "{topic}");
    }
}
