//! Width of the zig-zag: speed and error by α (cat-map patrol paper, Fig. 6 and 10).

use draw::figures::{Chart, Point, Series, Unit};
use sweep::Row;

use super::evidence::{Cell, Study, laps};
use crate::words::hundredths;

/// Time of a lap in the paper's first case, and in the experiment (s).
const T_MAX: f64 = 120.0;
/// The width that the paper chooses (m), with its speed (m/s) and MAE (m).
const PUBLISHED: (f64, f64, f64) = (1.7, 0.9651, 0.9352);

/// Returns the speed of a lap in [`T_MAX`] (m/s).
fn speed(row: &Row) -> Option<f64> {
    laps(row, false).map(|lap| lap.length_m / T_MAX)
}

fn mae(row: &Row) -> Option<f64> {
    laps(row, false).map(|lap| lap.mae_m)
}

fn points(study: &Study, case: &str, value: fn(&Row) -> Option<f64>) -> Vec<Point> {
    let cells = study.cells.iter().filter(|cell| cell.case == case);
    cells
        .filter_map(|cell| {
            let mean = cell.mean(value)?;
            let interval = mean.interval();
            Some(Point {
                x: cell.value.parse().ok()?,
                y: mean.value,
                interval: Some((interval.low, interval.high)),
            })
        })
        .collect()
}

fn chart(study: &Study, y_label: &str, value: fn(&Row) -> Option<f64>, published: f64) -> Chart {
    let names = [
        ("paper_fit", "as the paper's numbers were made"),
        ("default", "default"),
    ];
    Chart {
        x_label: "width of the zig-zag, α [m]".into(),
        y_label: y_label.into(),
        unit: Unit::Number,
        series: names
            .iter()
            .map(|(case, name)| Series {
                name: (*name).into(),
                points: points(study, case, value),
                reference: if *case == "paper_fit" {
                    vec![Point {
                        x: PUBLISHED.0,
                        y: published,
                        interval: None,
                    }]
                } else {
                    Vec::new()
                },
            })
            .collect(),
        reference: "the paper".into(),
        ..Chart::default()
    }
}

/// Fig. 6: the speed of a lap.
pub(super) fn speed_chart(study: &Study) -> Chart {
    chart(study, "speed needed [m/s]", speed, PUBLISHED.1)
}

/// Fig. 10: the distance from the route.
pub(super) fn mae_chart(study: &Study) -> Chart {
    chart(study, "MAE [m]", mae, PUBLISHED.2)
}

/// Returns the rows of the table of both figures.
pub(super) fn rows(study: &Study) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        let driven = |row: &Row| laps(row, true).map(|lap| lap.mae_m);
        let maa = |row: &Row| laps(row, false).map(|lap| lap.maa);
        let folded = |row: &Row| laps(row, false).map(|lap| lap.maa_fold);
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} |\n",
            cell.case,
            cell.value,
            mean(cell, speed),
            mean(cell, mae),
            mean(cell, driven),
            mean(cell, maa),
            mean(cell, folded),
        );
    }
    text
}

/// Returns the mean of a value over a cell's missions, with its 95 % interval; without one if all missions have
/// the same value.
pub(super) fn mean(cell: &Cell, value: impl Fn(&Row) -> Option<f64>) -> String {
    let Some(mean) = cell.mean(&value) else {
        return "–".into();
    };
    let half = mean.interval().width() / 2.0;
    let mut values = cell.rows.values().filter_map(value);
    let first = values.next();
    let differ = values.any(|v| Some(v) != first);
    if half.is_finite() && differ {
        format!("{} ± {}", hundredths(mean.value), hundredths(half))
    } else {
        hundredths(mean.value)
    }
}
