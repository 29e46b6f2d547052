//! The columns of results: name, type and value of each in one place, from which header, CSV and
//! Parquet follow.

use std::io;

use tables::{Cell, Type};

use super::planning::PlanRow;
use super::row::Row;

/// A column of the table of results, after the columns of the parameters and `seed`.
pub struct ResultColumn<R: 'static> {
    /// Its name.
    pub name: &'static str,
    get: Get<R>,
}

/// Takes the value of a column out of a row; the variant is the column's type.
enum Get<R: 'static> {
    Bool(fn(&R) -> Option<bool>),
    Int(fn(&R) -> Option<u64>),
    Float(fn(&R) -> Option<f64>),
    /// An empty text is no value.
    Text(fn(&R) -> &str),
    /// Text that holds JSON; an empty text is no value.
    Json(fn(&R) -> serde_json::Result<String>),
}

impl<R> ResultColumn<R> {
    const fn bool(name: &'static str, get: fn(&R) -> Option<bool>) -> Self {
        let get = Get::Bool(get);
        Self { name, get }
    }

    const fn int(name: &'static str, get: fn(&R) -> Option<u64>) -> Self {
        let get = Get::Int(get);
        Self { name, get }
    }

    const fn float(name: &'static str, get: fn(&R) -> Option<f64>) -> Self {
        let get = Get::Float(get);
        Self { name, get }
    }

    const fn text(name: &'static str, get: fn(&R) -> &str) -> Self {
        let get = Get::Text(get);
        Self { name, get }
    }

    const fn json(name: &'static str, get: fn(&R) -> serde_json::Result<String>) -> Self {
        let get = Get::Json(get);
        Self { name, get }
    }

    pub(super) fn kind(&self) -> Type {
        match self.get {
            Get::Bool(_) => Type::Bool,
            Get::Int(_) => Type::Int,
            Get::Float(_) => Type::F64,
            Get::Text(_) | Get::Json(_) => Type::Text,
        }
    }

    /// The value of a row.
    ///
    /// # Errors
    /// A value cannot be written as JSON.
    pub(super) fn cell(&self, row: &R) -> io::Result<Cell> {
        let text = |text: String| {
            if text.is_empty() {
                Cell::Empty
            } else {
                Cell::Text(text)
            }
        };
        Ok(match self.get {
            Get::Bool(get) => get(row).map_or(Cell::Empty, Cell::Bool),
            // Counts and ticks are below 2^63.
            Get::Int(get) => get(row).map_or(Cell::Empty, |v| Cell::Int(v.cast_signed())),
            Get::Float(get) => get(row).map_or(Cell::Empty, Cell::F64),
            Get::Text(get) => text(get(row).to_owned()),
            Get::Json(get) => text(get(row)?),
        })
    }
}

/// A value of a mission that did not fail.
fn known<T>(row: &Row, value: T) -> Option<T> {
    (!row.is_failed()).then_some(value)
}

fn count(row: &Row, value: u32) -> Option<u64> {
    known(row, value.into())
}

impl Row {
    /// The columns of missions.
    pub const COLUMNS: &'static [ResultColumn<Self>] = &[
        ResultColumn::text("outcome", |r| r.outcome.name()),
        ResultColumn::int("evaders", |r| count(r, r.evaders)),
        ResultColumn::int("escaped", |r| count(r, r.escaped)),
        ResultColumn::int("caught", |r| count(r, r.caught)),
        ResultColumn::int("held_out", |r| count(r, r.held_out)),
        ResultColumn::float("sim_time_s", |r| known(r, r.sim_time_s)),
        ResultColumn::float("first_capture_s", |r| r.first_capture_s),
        ResultColumn::float("first_escape_s", |r| r.first_escape_s),
        ResultColumn::int("contacts", |r| count(r, r.contacts)),
        ResultColumn::float("evader_distance_m", |r| known(r, r.evader_distance_m)),
        ResultColumn::float("evader_mean_speed", |r| r.evader_mean_speed),
        ResultColumn::int("ticks", |r| known(r, r.ticks)),
        ResultColumn::float("escape_possible_fraction", |r| r.escape_possible_fraction),
        ResultColumn::float("escape_impossible_from_s", |r| r.escape_impossible_from_s),
        ResultColumn::float("coverage_fraction", |r| Some(r.coverage.as_ref()?.fraction)),
        ResultColumn::float("coverable_fraction", |r| {
            Some(r.coverage.as_ref()?.coverable_fraction)
        }),
        ResultColumn::float("way_m", |r| Some(r.coverage.as_ref()?.way_m)),
        ResultColumn::text("digest", |r| &r.digest),
        ResultColumn::text("error", |r| &r.error),
        ResultColumn::json("robots", |r| match known(r, &r.robots) {
            Some(robots) => serde_json::to_string(robots),
            None => Ok(String::new()),
        }),
        ResultColumn::json("predictions", |r| match r.predictions.as_slice() {
            [] => Ok(String::new()),
            predictions => serde_json::to_string(predictions),
        }),
    ];
}

impl PlanRow {
    /// The columns of plans.
    pub const COLUMNS: &'static [ResultColumn<Self>] = &[
        ResultColumn::text("outcome", |r| r.outcome.name()),
        ResultColumn::bool("honest", |r| r.honest),
        ResultColumn::int("obstacles", |r| Some(r.obstacles.into())),
        ResultColumn::float("t_s", |r| r.t_s),
        ResultColumn::float("lower_bound_s", |r| r.lower_bound_s),
        ResultColumn::float("gap", |r| r.gap),
        ResultColumn::float("length_px", |r| r.length_px),
        ResultColumn::float("min_clearance_px", |r| r.min_clearance_px),
        ResultColumn::int("iterations", |r| r.iterations.map(u64::from)),
        ResultColumn::int("control_points", |r| r.control_points.map(u64::from)),
        ResultColumn::text("error", |r| &r.error),
    ];
}
