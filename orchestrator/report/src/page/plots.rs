//! Plots of the page.

use ipc_types::messages::observer::Prediction;
use serde::Serialize;
use serde_json::{Value as Json, json};

use super::content::PageContent;
use super::pack::{Lists, Range, pack_time};
use super::series::{Curve, Figure};

/// Title and unit of a plot.
fn heading(figure: Figure) -> (String, &'static str) {
    let (title, unit) = match figure {
        Figure::Outcome => ("Evaders", ""),
        Figure::Nearest => ("Distance from an evader to the nearest pursuer", "m"),
        Figure::Coverage => ("Area visited", "%"),
        Figure::Idleness => ("Time since the last visit", "s"),
        Figure::PlacesVisited => ("Places of the patrol visited so far", "%"),
        Figure::PatrolIdleness => ("Time since the last visit of the places of the patrol", "s"),
        Figure::BeliefError => ("Belief error: distance from its mean to the evader", "m"),
        Figure::BeliefSpread => ("Spread of the belief (standard deviation)", "m"),
        Figure::SafeShare => ("Area that the evader reaches safely", "%"),
        Figure::PredictionError(bits) => {
            let ahead = f64::from_bits(bits);
            return (
                format!("Mean error so far of predictions {ahead} s ahead"),
                "m",
            );
        }
        Figure::Distance => ("Distance driven", "m"),
        Figure::Speed => ("Forward speed", "m/s"),
    };
    (title.to_owned(), unit)
}

/// Quantities of a run over time, with one title and unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plot {
    /// Title of the plot.
    pub title: String,
    /// Unit of the values; empty for numbers.
    pub unit: &'static str,
    /// `true` if values hold until the next one.
    pub steps: bool,
    /// The curves.
    pub curves: Vec<PlotCurve>,
}

/// A curve of a plot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlotCurve {
    /// Name of the curve.
    pub name: String,
    /// Index of the robot that it belongs to.
    pub(super) robot: Option<u32>,
    /// Code of the prediction method that it belongs to, if all are about one robot.
    pub(super) method: Option<u8>,
    /// Simulated times (ns).
    pub times_ns: Vec<u64>,
    /// Values in the unit; may be infinite, which JSON has not.
    pub values: Vec<f64>,
}

/// Returns all plots in order; moves the curves out of `content`.
pub fn plots(content: &mut PageContent) -> Vec<Plot> {
    let series = core::mem::take(&mut content.series);
    let watched = series
        .curves
        .keys()
        .filter_map(|(_, curve)| match curve {
            Curve::Method(robot, _) => Some(*robot),
            _ => None,
        })
        .collect::<std::collections::BTreeSet<u32>>()
        .len();
    let mut plots: Vec<(Figure, Plot)> = Vec::new();
    for ((figure, curve), values) in series.curves {
        let values = values.finish();
        let scale = match figure {
            Figure::Coverage | Figure::PlacesVisited | Figure::SafeShare => 100.0,
            _ => 1.0,
        };
        let method = match curve {
            Curve::Method(_, method) if watched == 1 => Some(method),
            _ => None,
        };
        let (name, robot) = match curve {
            Curve::Robot(robot) => (content.name(robot), Some(robot)),
            Curve::Method(robot, method) => {
                let method = Prediction::method_name(method).replace('_', " ");
                let name = if watched > 1 {
                    format!("{}: {method}", content.name(robot))
                } else {
                    method
                };
                (name, None)
            }
            Curve::Patrol(patrol, name) => (content.patrol_figure(patrol, name), None),
            Curve::Named(name) => (name.to_owned(), None),
        };
        let curve = PlotCurve {
            name,
            robot,
            method,
            times_ns: values.iter().map(|s| s.time_ns).collect(),
            values: values.iter().map(|s| s.item * scale).collect(),
        };
        match plots.last_mut() {
            Some((last, plot)) if *last == figure => plot.curves.push(curve),
            _ => {
                let (title, unit) = heading(figure);
                let plot = Plot {
                    title,
                    unit,
                    steps: figure == Figure::Outcome,
                    curves: vec![curve],
                };
                plots.push((figure, plot));
            }
        }
    }
    plots.into_iter().map(|(_, plot)| plot).collect()
}

/// Packs plots: their values go into the lists `curve.N.time` and `curve.N.value`.
pub fn pack(plots: &[Plot], lists: &mut Lists) -> Json {
    let mut number = 0;
    let mut pack = |curve: &PlotCurve| {
        let range = Range::from_values(curve.values.iter().copied());
        let times = curve.times_ns.iter().map(|&time| pack_time(time)).collect();
        lists.u32(&format!("curve.{number}.time"), times, 2);
        let packed = curve
            .values
            .iter()
            .map(|&value| range.pack(value))
            .collect();
        lists.u16(&format!("curve.{number}.value"), packed, 1);
        let PlotCurve {
            name,
            robot,
            method,
            ..
        } = curve;
        let packed = json!({ "name": name, "robot": robot, "method": method, "list": number, "range": range });
        number += 1;
        packed
    };
    let plots = plots.iter().map(|plot| {
        let curves: Vec<Json> = plot.curves.iter().map(&mut pack).collect();
        json!({ "title": plot.title, "unit": plot.unit, "steps": plot.steps, "curves": curves })
    });
    plots.collect()
}
