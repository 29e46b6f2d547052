//! Comparison of ways to choose sub-goals, at equal distances driven.

use draw::figures::{Chart, Point, Series, Unit};
use sweep::Row;

use super::alpha::mean;
use super::evidence::{Knowledge, Study, least_error};

/// Distances at which the covered part is compared (m).
const WAYS: [f64; 4] = [250.0, 500.0, 1000.0, 2000.0];

/// Returns the covered part of the reachable area after a way (m).
pub(super) fn at(row: &Row, way: f64) -> Option<f64> {
    let coverage = row.coverage.as_ref()?;
    let found = coverage.by_way.iter().find(|c| c.way_m == way)?;
    Some(found.coverable_fraction)
}

/// Returns the chart of the covered part by the distance driven.
pub(super) fn chart(study: &Study) -> Chart {
    Chart {
        x_label: "way driven [m]".into(),
        y_label: "covered".into(),
        unit: Unit::Share,
        series: study
            .cells
            .iter()
            .map(|cell| Series {
                name: cell.case.replace('_', " "),
                points: WAYS
                    .iter()
                    .filter_map(|&way| {
                        Some(Point {
                            x: way,
                            y: cell.mean(|row| at(row, way))?.value,
                            interval: None,
                        })
                    })
                    .collect(),
                reference: Vec::new(),
            })
            .collect(),
        ..Chart::default()
    }
}

/// Returns the rows of the table.
pub(super) fn rows(study: &Study) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        let covered: Vec<String> = WAYS
            .iter()
            .map(|&way| {
                cell.mean(|row| at(row, way))
                    .map_or_else(|| "–".into(), |mean| format!("{:.3}", mean.value))
            })
            .collect();
        text += &format!(
            "| {} | {} | {} | {} | {} | {} |\n",
            cell.case.replace('_', " "),
            covered.join(" | "),
            mean(cell, |row| row.coverage.as_ref().map(|c| c.unevenness)),
            mean(cell, |row| least_error(row, Knowledge::Sight, 2.0)),
            mean(cell, |row| least_error(row, Knowledge::Sight, 5.0)),
            mean(cell, |row| least_error(row, Knowledge::Method, 5.0)),
        );
    }
    text
}
