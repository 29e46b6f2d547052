//! Summaries of the cells of an experiment of plans.

use serde_json::{Value as Json, json};
use statistics::quantile;
use statistics::{Interval, wilson};

use super::PlanResults;
use super::row::PlanRow;
use crate::row::Record as _;
use crate::runner::RunReport;
use crate::summary::{cell_table, heading, interval, json_head, missing, pace, parameters};

/// Summary of the plans of one cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellSummary {
    /// Number of plans that did not crash.
    pub plans: u64,
    /// Problems without a solution.
    pub no_path: u64,
    /// Solvable problems without a valid plan.
    pub failed: u64,
    /// Valid plans.
    pub honest: u64,
    /// Durations of the valid plans (s), ascending.
    pub t_s: Vec<f64>,
    /// Gaps of the valid plans, ascending.
    pub gap: Vec<f64>,
    /// CPU times of the valid plans (ms), ascending.
    pub cpu_ms: Vec<f64>,
}

impl CellSummary {
    /// Returns the number of problems that have a solution.
    pub fn solvable(&self) -> u64 {
        self.plans - self.no_path
    }

    /// Returns Wilson's 95 % interval of the chance to fail; `None` without problems.
    pub fn failure(&self) -> Option<Interval> {
        (self.solvable() > 0).then(|| wilson(self.failed, self.solvable()))
    }

    fn add(&mut self, row: &PlanRow, cpu_ms: Option<f64>) {
        self.plans += 1;
        self.no_path += u64::from(row.is_unsolvable());
        self.honest += u64::from(row.is_valid());
        self.failed += u64::from(!row.is_unsolvable() && !row.is_valid());
        if row.is_valid() {
            self.t_s.extend(row.t_s);
            self.gap.extend(row.gap);
            self.cpu_ms.extend(cpu_ms);
        }
    }
}

/// Summarises every cell, in the order of the experiment.
pub fn cells(results: &PlanResults) -> Vec<CellSummary> {
    let mut cells = vec![CellSummary::default(); results.manifest().cells.len()];
    for (mission, row) in results.rows().filter(|(_, row)| !row.is_failed()) {
        if let Some(cell) = cells.get_mut(mission.cell) {
            cell.add(row, results.cpu_ms(mission));
        }
    }
    for cell in &mut cells {
        for values in [&mut cell.t_s, &mut cell.gap, &mut cell.cpu_ms] {
            values.sort_by(f64::total_cmp);
        }
    }
    cells
}

/// Returns the summary as text.
pub fn text(results: &PlanResults, report: Option<&RunReport>) -> String {
    let manifest = results.manifest();
    let columns = [
        ("plans", 0),
        ("no path", 4),
        ("failed", 0),
        ("95 % interval", 3),
        ("time (s)", 1),
        ("gap [%] median / p95 / max", 2),
        ("CPU [ms] median / p99", 5),
    ];
    let number = |values: &[f64], share: f64, factor: f64, digits: usize| {
        quantile(values, share).map_or_else(|| "-".into(), |v| format!("{:.digits$}", factor * v))
    };
    let rows = cells(results).into_iter().map(|of| {
        vec![
            of.plans.to_string(),
            of.no_path.to_string(),
            format!("{}/{}", of.failed, of.solvable()),
            interval(of.failure()),
            number(&of.t_s, 0.5, 1.0, 2),
            [0.5, 0.95, 1.0]
                .map(|share| number(&of.gap, share, 100.0, 3))
                .join(" / "),
            [0.5, 0.99]
                .map(|share| number(&of.cpu_ms, share, 1.0, 2))
                .join(" / "),
        ]
    });
    let table = cell_table(manifest, &columns, rows);
    let mut text = format!("{}\n\n{table}\n", heading(manifest));
    text += &pace(report, "plans");
    let broken: Vec<_> = results.rows().filter(|(_, row)| row.is_failed()).collect();
    for (mission, row) in broken.iter().take(20) {
        text += &format!("\nfailed: {}: {}", results.describe(*mission), row.error);
    }
    if !broken.is_empty() {
        text += "\n--retry-failed runs them again\n";
    }
    let missing = missing(results, report).len();
    if missing > 0 {
        text += &format!("\n{missing} plans are missing\n");
    }
    text
}

/// Returns the summary as JSON.
pub fn json(results: &PlanResults, report: Option<&RunReport>) -> Json {
    let manifest = results.manifest();
    let summaries = manifest.cells.iter().zip(cells(results));
    let cells: Vec<Json> = summaries
        .map(|(cell, of)| {
            let quantiles = |values: &[f64]| [0.5, 0.95, 0.99, 1.0].map(|q| quantile(values, q));
            json!({
                "case": cell.case,
                "parameters": parameters(&manifest.parameters, &cell.values),
                "plans": of.plans,
                "no_path": of.no_path,
                "failed": of.failed,
                "wilson_95": of.failure().map(|i| [i.low, i.high]),
                "honest": of.honest,
                "t_s": quantiles(&of.t_s),
                "gap": quantiles(&of.gap),
                "cpu_ms": quantiles(&of.cpu_ms),
            })
        })
        .collect();
    let broken = results.rows().filter(|(_, row)| row.is_failed()).count();
    let mut all = json_head(results, report);
    all.extend([
        ("quantiles".to_owned(), json!([0.5, 0.95, 0.99, 1.0])),
        ("cells".to_owned(), json!(cells)),
        ("broken_down".to_owned(), json!(broken)),
        ("missing".to_owned(), json!(missing(results, report).len())),
    ]);
    Json::Object(all)
}
