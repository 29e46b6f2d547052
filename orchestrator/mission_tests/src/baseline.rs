//! Results of an earlier run of the tests, and the changes since then.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use statistics::{Interval, Mean};

use crate::error::TestError;
use crate::report::{MissionRecord, SuiteReport, TestReport};

/// Results of an earlier run: the output of `protean test --json`.
pub struct Baseline(SuiteReport);

/// Missions of a test whose histories changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestChange {
    /// Name of the test.
    pub name: String,
    /// Number of missions in both results.
    pub missions: usize,
    /// Seeds of those that changed.
    pub seeds: Vec<u64>,
    /// First difference of the first of them that has one.
    pub first_difference: Option<String>,
    /// Columns that changed.
    pub columns: Vec<ColumnChange>,
}

/// Change of a column, paired by seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnChange {
    /// Name.
    pub column: String,
    /// Number of pairs.
    pub pairs: usize,
    /// Mean before.
    pub before: f64,
    /// Mean now.
    pub now: f64,
    /// 95 % interval of the mean difference; absent for a single pair.
    pub difference_95: Option<Interval>,
}

impl Baseline {
    /// Reads a baseline.
    ///
    /// # Errors
    /// [`TestError::Io`], [`TestError::Baseline`].
    pub fn load(path: &Path) -> Result<Self, TestError> {
        let text = std::fs::read(path).map_err(TestError::io(path, "cannot be read"))?;
        let report = serde_json::from_slice(&text);
        report.map(Self).map_err(|source| TestError::Baseline {
            path: path.to_owned(),
            source,
        })
    }

    /// Returns the result of a mission.
    pub(crate) fn mission(&self, test: &str, seed: u64) -> Option<&MissionRecord> {
        let test = self.0.tests.iter().find(|known| known.name == test)?;
        test.missions.iter().find(|mission| mission.seed == seed)
    }

    /// Returns the changes of tests whose histories changed.
    pub fn changes(&self, now: &SuiteReport) -> Vec<TestChange> {
        let changes = now.tests.iter().map(|test| self.change(test));
        changes.filter(|change| !change.seeds.is_empty()).collect()
    }

    fn change(&self, test: &TestReport) -> TestChange {
        let pairs = test.missions.iter();
        let pairs: Vec<(&MissionRecord, &MissionRecord)> = pairs
            .filter_map(|now| Some((self.mission(&test.name, now.seed)?, now)))
            .collect();
        let changed = pairs
            .iter()
            .filter(|(before, now)| before.digest != now.digest);
        let changed: Vec<&MissionRecord> = changed.map(|(_, now)| *now).collect();
        let mut values: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
        for (before, now) in &pairs {
            for (column, value) in &now.columns {
                if let Some(earlier) = before.columns.get(column) {
                    values.entry(column).or_default().push((*earlier, *value));
                }
            }
        }
        let columns = values
            .into_iter()
            .filter_map(|(column, pairs)| paired(column, &pairs));
        TestChange {
            name: test.name.clone(),
            missions: pairs.len(),
            seeds: changed.iter().map(|mission| mission.seed).collect(),
            first_difference: changed
                .iter()
                .find_map(|mission| mission.first_difference.clone()),
            columns: columns.collect(),
        }
    }
}

/// Returns the change of a column; `None` if no pair differs.
fn paired(column: &str, pairs: &[(f64, f64)]) -> Option<ColumnChange> {
    if pairs.iter().all(|(before, now)| before == now) {
        return None;
    }
    let mean = |value: fn(&(f64, f64)) -> f64| {
        Mean::from_values(&pairs.iter().map(value).collect::<Vec<_>>())
    };
    let difference = mean(|(before, now)| now - before)?;
    Some(ColumnChange {
        column: column.to_owned(),
        pairs: pairs.len(),
        before: mean(|(before, _)| *before)?.value,
        now: mean(|(_, now)| *now)?.value,
        difference_95: (difference.count > 1).then(|| difference.interval()),
    })
}
