//! Tables of results as files: `results.csv`, `results.parquet`, and those of parts of missions.
//!
//! The columns are `case`, the parameters, `seed`, and those of the table ([`Record::TABLES`]).

use std::io::{self, Write};

use tables::{self, Cell, Column, Format, Type};

use super::cell::Value;
use super::columns::ResultTable;
use super::manifest::Manifest;
use super::mission_id::MissionId;
use super::row::Record;

/// Returns `true` if a table of these rows has a column of this name, so that no parameter can.
pub fn is_taken<R: Record>(name: &str) -> bool {
    let tables = R::TABLES.iter();
    let mut columns = tables.flat_map(ResultTable::columns);
    ["case", "seed"].contains(&name) || columns.any(|column| column.name() == name)
}

/// Writes a table, mission by mission in their order.
///
/// Numbers have the shortest form that reads back as the same number. Missing values are empty, in
/// Parquet null.
///
/// # Errors
/// The error of the writer.
pub fn write<'a, R: Record + 'a, W: Write + Send + 'static>(
    table: &ResultTable<R>,
    format: Format,
    file: W,
    manifest: &Manifest,
    rows: impl Iterator<Item = (MissionId, &'a R)>,
) -> io::Result<W> {
    let parameters = 0..manifest.parameters.len();
    let parameters: Vec<Type> = parameters.map(|index| type_of(manifest, index)).collect();
    let mut columns = vec![Column::new("case", Type::Text)];
    let names = manifest.parameters.iter().zip(&parameters);
    columns.extend(names.map(|(name, &kind)| Column::new(name, kind)));
    columns.push(Column::new("seed", Type::Int));
    columns.extend(table.columns());
    let mut written = tables::begin(format, file, &columns)?;
    for (mission, row) in rows {
        let cell = manifest.cells.get(mission.cell);
        let mut cells = Vec::with_capacity(columns.len());
        cells.push(cell.map_or(Cell::Empty, |c| Cell::Text(c.case.clone())));
        for (index, &kind) in parameters.iter().enumerate() {
            let value = cell.and_then(|c| c.values.get(index));
            cells.push(value.map_or(Cell::Empty, |v| parameter(v, kind)));
        }
        // Seeds are below 2^63.
        cells.push(Cell::Int(mission.seed.cast_signed()));
        let of_mission = cells.len();
        for own in table.rows(row) {
            cells.truncate(of_mission);
            cells.extend(own);
            written.row(&cells)?;
        }
    }
    written.finish()
}

/// Returns the type of all values of a parameter.
fn type_of(manifest: &Manifest, index: usize) -> Type {
    let values = manifest.cells.iter().filter_map(|c| c.values.get(index));
    let all = |is: fn(&Value) -> bool| values.clone().all(is);
    if all(|v| matches!(v, Value::Int(_))) {
        Type::Int
    } else if all(|v| v.number().is_some()) {
        Type::F64
    } else if all(|v| matches!(v, Value::Bool(_))) {
        Type::Bool
    } else {
        Type::Text
    }
}

/// Returns the value of a parameter in a column of this type.
fn parameter(value: &Value, kind: Type) -> Cell {
    match (kind, value) {
        (Type::Int, Value::Int(v)) => Cell::Int(*v),
        (Type::F64, value) => value.number().map_or(Cell::Empty, Cell::F64),
        (Type::Bool, Value::Bool(v)) => Cell::Bool(*v),
        (_, value) => Cell::Text(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;
    use tempfile::NamedTempFile;

    use super::super::tests::{GOOD, load};
    use super::super::{Outcome, Row};
    use super::*;
    use recorder::{AttackTotals, LapFigures, PredictionOutcome, RobotOutcome, WaypointOutcome};

    /// A robot that visits waypoints.
    fn guard() -> RobotOutcome {
        let lap = LapFigures {
            length_m: 40.5,
            mae_m: 0.3,
            turns: 12.0,
            maa: 0.7,
            maa_fold: 0.6,
        };
        RobotOutcome {
            name: "guard".to_owned(),
            waypoints: Some(WaypointOutcome {
                reached: 12,
                inside_obstacle: 1,
                timed_out: 0,
                unreachable: 2,
                stuck: 1,
                route_left_out: 0,
                farthest_m: 0.2,
                laps: Some(3),
                longest_lap_s: Some(61.5),
                lap_limit_s: None,
                planned: Some(lap),
                driven: None,
            }),
            ..RobotOutcome::default()
        }
    }

    fn rows() -> Vec<(MissionId, Row)> {
        let of = |cell, seed| {
            let row = Row {
                evaders: 2,
                escaped: 1,
                sim_time_s: 12.25,
                first_escape_s: (seed == 1).then_some(0.1 + 0.2),
                digest: "é".repeat(3),
                predictions: vec![PredictionOutcome {
                    robot: "evader_1".to_owned(),
                    method: "curve, \"fitted\"".to_owned(),
                    observer: 7,
                    horizon_s: 2.0,
                    predictions: 40,
                    without: 0,
                    mean_m: Some(0.25),
                    median_m: None,
                    rms_m: None,
                    goals_observed: 3,
                    key_recovered_s: None,
                    key_recovered_after: None,
                }],
                attacks: vec![AttackTotals {
                    attacker: "intruder".to_owned(),
                    method: "history".to_owned(),
                    attacks: 9,
                    detected: 4,
                }],
                robots: vec![guard(), RobotOutcome::default()],
                outcome: Outcome::Ended,
                ..Row::failed("")
            };
            let row = if seed == 1 {
                row
            } else {
                Row::failed("broken")
            };
            (MissionId { cell, seed }, row)
        };
        (0..6).flat_map(|cell| [of(cell, 1), of(cell, 2)]).collect()
    }

    fn written(table: &ResultTable<Row>, format: Format) -> NamedTempFile {
        let manifest = load(GOOD).unwrap().manifest();
        let rows = rows();
        let file = NamedTempFile::new().unwrap();
        let rows = rows.iter().map(|(m, r)| (*m, r));
        write(table, format, file, &manifest, rows).unwrap()
    }

    /// Returns the lines of a table after the header, by column.
    fn lines(table: &ResultTable<Row>) -> Vec<BTreeMap<String, String>> {
        let file = written(table, Format::Csv);
        let mut csv = csv::Reader::from_path(file.path()).unwrap();
        csv.deserialize().map(Result::unwrap).collect()
    }

    #[test]
    fn parquet_and_csv_have_equal_values() {
        for (table, length) in Row::TABLES.iter().zip([12, 12, 6, 6]) {
            let (text, parquet) = (written(table, Format::Csv), written(table, Format::Parquet));
            let mut csv = csv::Reader::from_path(text.path()).unwrap();
            let names = csv.headers().unwrap().clone();
            let reader = SerializedFileReader::new(parquet.reopen().unwrap()).unwrap();
            let read: Vec<_> = reader
                .get_row_iter(None)
                .unwrap()
                .map(Result::unwrap)
                .collect();
            let records: Vec<_> = csv.records().map(Result::unwrap).collect();
            assert_eq!((read.len(), records.len()), (length, length));
            for (record, row) in records.iter().zip(&read) {
                for (index, (name, field)) in row.get_column_iter().enumerate() {
                    assert_eq!(*name, names[index]);
                    let text = match field {
                        Field::Null => String::new(),
                        Field::Str(v) => v.clone(),
                        Field::Long(v) => v.to_string(),
                        Field::Double(v) => format!("{v:?}"),
                        other => panic!("{name}: {other:?}"),
                    };
                    assert_eq!(record[index], text, "{name}");
                }
            }
        }
    }

    #[test]
    fn values_of_a_mission_are_typed() {
        let parquet = written(&Row::TABLES[0], Format::Parquet);
        let reader = SerializedFileReader::new(parquet.reopen().unwrap()).unwrap();
        let first = reader.get_row_iter(None).unwrap().next().unwrap().unwrap();
        let first: BTreeMap<_, _> = first.get_column_iter().collect();
        let at = |name: &str| first[&name.to_owned()];
        assert_eq!(*at("seed"), Field::Long(1));
        assert_eq!(*at("first_escape_s"), Field::Double(0.1 + 0.2));
        assert_eq!(*at("first_capture_s"), Field::Null);
    }

    #[test]
    fn long_tables_have_the_cell_and_the_seed_of_every_robot_and_prediction() {
        let [results, robots, predictions, adversaries] = Row::TABLES else {
            panic!("four tables");
        };
        assert!(!lines(results)[0].contains_key("robots"));
        let (robots, predictions) = (lines(robots), lines(predictions));
        let robot = |index: usize, name: &str| robots[index][name].clone();
        let keys = [
            "case",
            "relative_speed",
            "seed",
            "robot",
            "waypoints_reached",
        ];
        assert_eq!(
            keys.map(|k| robot(0, k)),
            ["potential", "0.8", "1", "guard", "12"]
        );
        assert_eq!(keys.map(|k| robot(1, k)), ["potential", "0.8", "1", "", ""]);
        assert_eq!(robot(2, "relative_speed"), "1.5");
        assert_eq!(
            (robot(0, "planned_turns"), robot(0, "driven_turns")),
            ("12.0".into(), String::new())
        );
        let prediction = |name: &str| predictions[5][name].clone();
        let keys = [
            "case",
            "relative_speed",
            "seed",
            "robot",
            "predictor",
            "horizon_s",
            "mean_m",
            "median_m",
        ];
        let expected = [
            "braitenberg",
            "2.0",
            "1",
            "evader_1",
            "curve, \"fitted\"",
            "2.0",
            "0.25",
            "",
        ];
        assert_eq!(keys.map(prediction), expected);
        let adversary = &lines(adversaries)[5];
        let keys = [
            "seed",
            "attacker",
            "adversary",
            "attacks",
            "attacks_detected",
        ];
        let expected = ["1", "intruder", "history", "9", "4"];
        assert_eq!(keys.map(|key| &*adversary[key]), expected);
        let mission = &lines(results)[0];
        assert_eq!(mission["detection_share"].parse(), Ok(4.0 / 9.0));
    }

    #[test]
    fn columns_of_all_tables_are_no_names_of_parameters() {
        for name in ["case", "seed", "outcome", "robot", "horizon_s"] {
            assert!(is_taken::<Row>(name), "{name}");
        }
        assert!(!is_taken::<Row>("method") && !is_taken::<Row>("gap"));
        assert!(is_taken::<crate::planning::PlanRow>("gap"));
    }
}
