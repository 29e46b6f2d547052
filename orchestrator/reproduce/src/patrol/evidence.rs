//! Input of the page: results of three experiments.

use std::collections::BTreeMap;

use recorder::{LapFigures, PredictionOutcome};
use statistics::Mean;
use sweep::{Results, Row};

use crate::place::{PlaceError, empty_place};

/// Name of the experiment on the width of the zig-zag.
pub(super) const ALPHA: &str = "patrol_alpha";
/// Name of the experiment on zig-zag, fictive obstacles and both mixed, among obstacles.
pub(super) const SQUARE: &str = "patrol_square";
/// Name of the experiment on ways to choose sub-goals.
pub(super) const COVERAGE: &str = "coverage_sources";

/// Input of the page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// Results of `patrol_alpha`.
    pub alpha: Option<Study>,
    /// Results of `patrol_square`.
    pub square: Option<Study>,
    /// Results of `coverage_sources`.
    pub coverage: Option<Study>,
}

/// The results of an experiment with at most one parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Study {
    /// Version of the program.
    pub program: String,
    /// Its seeds, as text.
    pub seeds: String,
    /// The cells in the order of the experiment.
    pub cells: Vec<Cell>,
}

/// A cell of an experiment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// Name of its case.
    pub case: String,
    /// Value of the parameter; empty without one.
    pub value: String,
    /// Its missions that did not fail, by seed.
    pub rows: BTreeMap<u64, Row>,
}

impl Evidence {
    /// Adds the results of one of the page's experiments.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn add(&mut self, results: &Results) -> Result<(), PlaceError> {
        let places = [
            (ALPHA, &mut self.alpha),
            (SQUARE, &mut self.square),
            (COVERAGE, &mut self.coverage),
        ];
        let name = &results.manifest().experiment;
        let place = empty_place(places, results.directory(), name)?;
        *place = Some(Study::of(results));
        Ok(())
    }
}

impl Study {
    fn of(results: &Results) -> Self {
        let manifest = results.manifest();
        let mut rows: BTreeMap<usize, BTreeMap<u64, Row>> = BTreeMap::new();
        for (mission, row) in results.rows() {
            if !row.is_failed() {
                let of_cell = rows.entry(mission.cell).or_default();
                of_cell.insert(mission.seed, row.clone());
            }
        }
        let cells = manifest.cells.iter().enumerate();
        Self {
            program: manifest.program.clone(),
            seeds: manifest.seeds.to_string(),
            cells: cells
                .map(|(index, cell)| Cell {
                    case: cell.case.clone(),
                    value: cell
                        .values
                        .first()
                        .map(ToString::to_string)
                        .unwrap_or_default(),
                    rows: rows.remove(&index).unwrap_or_default(),
                })
                .collect(),
        }
    }
}

impl Cell {
    /// Returns the mean over the missions that have the value.
    pub(super) fn mean(&self, value: impl Fn(&Row) -> Option<f64>) -> Option<Mean> {
        let values: Vec<f64> = self.rows.values().filter_map(value).collect();
        Mean::of(&values)
    }
}

/// Returns the first robot's laps, planned or driven.
pub(super) fn laps(row: &Row, driven: bool) -> Option<&LapFigures> {
    let waypoints = row.robots.iter().find_map(|r| r.waypoints.as_ref())?;
    if driven {
        waypoints.driven.as_ref()
    } else {
        waypoints.planned.as_ref()
    }
}

/// Knowledge of an observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Knowledge {
    /// Knowledge of the observer.
    Sight,
    /// The method that makes the goals, without the key.
    Method,
}

impl Knowledge {
    fn of(prediction: &PredictionOutcome) -> Self {
        if prediction.method.ends_with("_key") {
            Self::Method
        } else {
            Self::Sight
        }
    }
}

/// Returns the smallest mean error of the prediction methods with this knowledge at this `horizon` (s) (m).
pub(super) fn least_error(row: &Row, knowledge: Knowledge, horizon: f64) -> Option<f64> {
    let of_horizon = row.predictions.iter().filter(|p| p.horizon_s == horizon);
    of_horizon
        .filter(|p| Knowledge::of(p) == knowledge)
        .filter_map(|p| p.mean_m)
        .min_by(f64::total_cmp)
}
