//! Input of the page: results of two experiments.

use std::collections::BTreeMap;

use sweep::planning::{PlanResults, PlanRow};

use crate::place::{PlaceError, empty_place};
use crate::statistics::BySeed;

/// Name of the experiment of Table 2.
pub(super) const SENSITIVITY: &str = "vmc_lp_sensitivity";
/// Name of the experiment of Tables 3 and 4.
pub(super) const VERSUS: &str = "vmc_lp_tables_3_4";

/// Input of the page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// Results for Table 2.
    pub sensitivity: Option<Study>,
    /// Results for Tables 3 and 4.
    pub versus: Option<Study>,
}

/// The results of an experiment with one parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Study {
    /// Version of the program.
    pub program: String,
    /// Its seeds, as text.
    pub seeds: String,
    /// The cells, by case and value of the parameter.
    pub cells: BTreeMap<(String, String), Cell>,
}

/// The plans of a cell, by seed.
pub(super) type Cell = BTreeMap<u64, Plan>;

/// Figures of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// `true` if the problem has no solution.
    pub unsolvable: bool,
    /// Duration of the plan (s); `None` without a valid one.
    pub time: Option<f64>,
    /// CPU time (ms).
    pub cpu_ms: Option<f64>,
}

impl Plan {
    fn of(row: &PlanRow, cpu_ms: Option<f64>) -> Self {
        Self {
            unsolvable: row.is_unsolvable(),
            time: row.t_s.filter(|_| row.is_valid()),
            cpu_ms,
        }
    }
}

impl Evidence {
    /// Adds the results of one of the page's experiments.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn add(&mut self, results: &PlanResults) -> Result<(), PlaceError> {
        let places = [
            (SENSITIVITY, &mut self.sensitivity),
            (VERSUS, &mut self.versus),
        ];
        let name = &results.manifest().experiment;
        let place = empty_place(places, results.directory(), name)?;
        *place = Some(Study::of(results));
        Ok(())
    }
}

impl Study {
    fn of(results: &PlanResults) -> Self {
        let manifest = results.manifest();
        let mut cells: BTreeMap<(String, String), Cell> = BTreeMap::new();
        for (mission, row) in results.rows() {
            let Some(cell) = manifest.cells.get(mission.cell) else {
                continue;
            };
            let value = cell.values.first().map(ToString::to_string);
            let key = (cell.case.clone(), value.unwrap_or_default());
            let plan = Plan::of(row, results.cpu_ms(mission));
            cells.entry(key).or_default().insert(mission.seed, plan);
        }
        Self {
            program: manifest.program.clone(),
            seeds: manifest.seeds.to_string(),
            cells,
        }
    }

    /// Returns the cell of a case and a value.
    pub(super) fn cell(&self, case: &str, value: &str) -> Option<&Cell> {
        self.cells.get(&(case.to_owned(), value.to_owned()))
    }

    /// Returns the failures among the solvable problems of a case, by seed; `None` if there are no such
    /// problems.
    pub(super) fn failed_seeds(&self, case: &str, value: &str) -> Option<BySeed> {
        let plans = self.cell(case, value)?.iter();
        let failures = plans
            .filter(|(_, plan)| !plan.unsolvable)
            .map(|(seed, plan)| (*seed, (u32::from(plan.time.is_none()), 1)));
        let failures: BySeed = failures.collect();
        (!failures.is_empty()).then_some(failures)
    }

    /// Returns the numbers of failed and of solvable problems of a case; `None` if there are no
    /// problems.
    pub(super) fn failures(&self, case: &str, value: &str) -> Option<(u64, u64)> {
        let failures = self.failed_seeds(case, value)?;
        let failed = failures.values().map(|f| u64::from(f.0)).sum();
        Some((failed, failures.len() as u64))
    }

    /// Returns `true` if two values are one and the same set of runs: the same problems with the same plans in
    /// every case.
    pub(super) fn are_same_runs(&self, a: &str, b: &str) -> bool {
        let of = |value: &str| {
            let cells = self.cells.iter().filter(|((_, v), _)| v == value);
            let runs = cells.flat_map(|((case, _), cell)| {
                let plan = |(seed, plan): (&u64, &Plan)| (*seed, plan.unsolvable, plan.time);
                cell.iter().map(plan).map(|run| (case.clone(), run))
            });
            runs.collect::<Vec<_>>()
        };
        let runs = of(a);
        !runs.is_empty() && runs == of(b)
    }

    /// Returns the number of problems of a value without a solution.
    pub(super) fn unsolvable(&self, value: &str) -> usize {
        let cells = self.cells.iter().filter(|((_, v), _)| v == value);
        let counts = cells.map(|(_, cell)| cell.values().filter(|p| p.unsolvable).count());
        counts.max().unwrap_or_default()
    }
}
