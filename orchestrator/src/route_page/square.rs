//! Zig-zag, fictive obstacles and both mixed, among obstacles (cat-map patrol paper, case 2).

use super::alpha::mean;
use super::evidence::{Study, laps};
use crate::sweep::Row;

/// What the paper's text says of its second case without obstacles: path, MAE [m], MAA [rad].
const PUBLISHED: [(&str, &str, &str); 2] =
    [("awg", "0.7120", "0.7854"), ("fto", "1.5769", "0.3681")];

/// The table.
pub(super) fn text(study: &Study) -> String {
    let mut text = "\
| obstacles | planner | MAE driven [m] | turns per lap | MAA [rad] | MAA folded [rad] | longest lap [s] | left out | contacts | error of the best observer, 2 s ahead [m] |
|---|---|---|---|---|---|---|---|---|---|
"
    .to_owned();
    for cell in &study.cells {
        let lap = |value: fn(&crate::recorder::LapFigures) -> f64| {
            mean(cell, move |row| laps(row, true).map(value))
        };
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
            cell.rows.iter().map(|row| row.contacts).sum::<u32>(),
            mean(cell, |row| super::evidence::least_error(row, 2.0)),
        );
    }
    for (path, mae, maa) in PUBLISHED {
        text += &format!("| none, the paper | {path} | {mae} | – | – | {maa} | – | – | – | – |\n");
    }
    text.push('\n');
    text
}
