//! Zig-zag, fictive obstacles and both mixed, among obstacles (cat-map patrol paper, case 2).

use recorder::LapFigures;
use sweep::Row;

use super::alpha::mean;
use super::evidence::{Knowledge, Study, laps, least_error};

/// Returns the rows of the table.
pub(super) fn rows(study: &Study) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        let lap = |value: fn(&LapFigures) -> f64| mean(cell, move |row| laps(row, true).map(value));
        let waypoints = |row: &Row| row.robots.iter().find_map(|r| r.waypoints.clone());
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            cell.value,
            cell.case,
            lap(|f| f.mae_m),
            lap(|f| f.turns),
            lap(|f| f.maa),
            lap(|f| f.maa_fold),
            mean(cell, |row| waypoints(row)?.longest_lap_s),
            mean(cell, |row| waypoints(row).map(|w| w.left_out_share())),
            cell.rows.values().map(|row| row.contacts).sum::<u32>(),
            mean(cell, |row| least_error(row, Knowledge::Sight, 2.0)),
        );
    }
    text
}
