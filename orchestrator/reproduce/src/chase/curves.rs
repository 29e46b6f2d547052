//! The curves of a study, with the published points.

use draw::figures::{Chart, Point, Series, Unit};
use statistics::Z95;

use super::evidence::Study;
use super::published::Published;

/// Meaning of the hollow marks.
const REFERENCE: &str = "published (about 10 games each; dotted: their 95 % interval)";

/// Returns the chart of a study.
pub(super) fn chart(
    study: &Study,
    published: &[Published],
    title: &str,
    conditions: &str,
) -> Chart {
    let series = study.methods.iter().map(|method| {
        let cells = study.cells.iter().filter(|c| c.method == method.name);
        let points = cells.filter_map(|cell| {
            let interval = cell.escapes().interval(Z95);
            Some(Point {
                x: cell.ratio,
                y: cell.escapes().share()?,
                interval: Some((interval.low, interval.high)),
            })
        });
        let reference = published
            .iter()
            .filter(|v| v.method == method.name)
            .map(|v| {
                let interval = v.interval();
                Point {
                    x: v.ratio,
                    y: v.share(),
                    interval: Some((interval.low, interval.high)),
                }
            });
        Series {
            name: method.title.clone(),
            points: points.collect(),
            reference: reference.collect(),
        }
    });
    let games: Vec<u64> = study.cells.iter().map(|c| c.escapes().groups()).collect();
    let games = match (games.iter().min(), games.iter().max()) {
        (Some(least), Some(most)) if least == most => format!("{most} games per point"),
        (Some(least), Some(most)) => format!("{least} to {most} games per point"),
        _ => "no games".to_owned(),
    };
    Chart {
        title: title.to_owned(),
        subtitle: format!("{conditions} {games}; intervals by game."),
        x_label: "speed of the evaders by that of the Police".to_owned(),
        x_names: Vec::new(),
        y_label: "evaders that escape".to_owned(),
        unit: Unit::Share,
        series: series.collect(),
        reference: REFERENCE.to_owned(),
        ..Chart::default()
    }
}
