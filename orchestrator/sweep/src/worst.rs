//! Worst missions of each cell: the seeds that are worth a look.

use std::cmp::Ordering;
use std::str::FromStr;

use super::columns::{Part as _, ResultColumn};
use super::mission_id::MissionId;
use super::results::Results;
use super::row::{Outcome, Row};
use tables::{Cell, Type};

/// Maximum number of worst missions of a cell.
const PER_CELL: usize = 3;

/// End of a column of numbers at which the worst missions are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measure {
    /// Index of the column in the results.
    column: usize,
    /// `true` if the highest values are the worst.
    is_max: bool,
}

/// Measure that is not `COLUMN=max` or `COLUMN=min` with a column of numbers.
#[derive(Debug, thiserror::Error)]
#[error("expected COLUMN=max or COLUMN=min; the columns are {}", columns())]
pub struct MeasureError;

/// Returns the names of the columns of numbers.
fn columns() -> String {
    let numbers = Row::COLUMNS.iter().filter(|column| is_number(column));
    let names: Vec<&str> = numbers.map(|column| column.name).collect();
    names.join(", ")
}

fn is_number(column: &ResultColumn<Row>) -> bool {
    matches!(column.kind, Type::Int | Type::F64)
}

impl FromStr for Measure {
    type Err = MeasureError;

    fn from_str(text: &str) -> Result<Self, MeasureError> {
        let (name, end) = text.split_once('=').ok_or(MeasureError)?;
        let is_named = |column: &ResultColumn<Row>| column.name == name && is_number(column);
        let column = Row::COLUMNS.iter().position(is_named);
        let is_max = match end {
            "max" => true,
            "min" => false,
            _ => return Err(MeasureError),
        };
        let column = column.ok_or(MeasureError)?;
        Ok(Self { column, is_max })
    }
}

/// Returns the worst missions that did not fail, at most three of each cell, the worst of all first, each with its
/// reason. Without a measure these are the missions at the time limit, then those with contacts: with more contacts
/// first, then with a longer simulated time.
pub fn worst(results: &Results, measure: Option<Measure>) -> Vec<(MissionId, String)> {
    let mut found: Vec<_> = results
        .rows()
        .filter(|(_, row)| !row.is_failed())
        .filter_map(|(mission, row)| {
            let (badness, reason) = judged(row, measure)?;
            Some((mission, badness, reason))
        })
        .collect();
    // Equal ones stay in the order of the results.
    found.sort_by(|(_, a, _), (_, b, _)| b.partial_cmp(a).unwrap_or(Ordering::Equal));
    let mut taken = vec![0; results.manifest().cells.len()];
    found.retain(|(mission, ..)| {
        taken.get_mut(mission.cell).is_some_and(|taken| {
            *taken += 1;
            *taken <= PER_CELL
        })
    });
    let missions = found.into_iter();
    missions
        .map(|(mission, _, reason)| (mission, reason))
        .collect()
}

/// Returns the badness of a mission, worse if greater, and its reason; `None` if it has nothing bad.
fn judged(row: &Row, measure: Option<Measure>) -> Option<([f64; 3], String)> {
    if let Some(Measure { column, is_max }) = measure {
        let column = Row::COLUMNS.get(column)?;
        let value = match column.cell(row) {
            Cell::Int(value) => value as f64,
            Cell::F64(value) => value,
            _ => return None,
        };
        let badness = if is_max { value } else { -value };
        return Some(([badness, 0.0, 0.0], format!("{} = {value}", column.name)));
    }
    let is_late = row.outcome == Outcome::TimeLimit;
    (is_late || row.contacts > 0).then(|| {
        let badness = [
            f64::from(u8::from(is_late)),
            row.contacts.into(),
            row.sim_time_s,
        ];
        let (outcome, contacts, time) = (row.outcome.name(), row.contacts, row.sim_time_s);
        (
            badness,
            format!("{outcome}, {contacts} contacts, {time:.2} s"),
        )
    })
}
