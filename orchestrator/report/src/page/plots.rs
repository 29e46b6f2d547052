//! Plots of the page.

use ipc_types::messages::observer::Prediction;
use serde_json::{Value as Json, json};

use super::gather::Gathered;
use super::measured::{Curve, Figure};
use super::pack::{Lists, Range, pack_time};

/// Title and unit of a plot.
fn heading(figure: Figure) -> (String, &'static str) {
    let (title, unit) = match figure {
        Figure::Outcome => ("Evaders", ""),
        Figure::Nearest => ("Distance from an evader to the nearest pursuer", "m"),
        Figure::Coverage => ("Area visited", "%"),
        Figure::Idleness => ("Time since the last visit", "s"),
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

/// Returns all plots in order; moves the curves out of `gathered` and their values into the lists
/// `curve.N.time` and `curve.N.value`.
pub(super) fn plots(gathered: &mut Gathered, lists: &mut Lists) -> Json {
    let measured = core::mem::take(&mut gathered.measured);
    let watched = measured
        .curves
        .keys()
        .filter_map(|(_, curve)| match curve {
            Curve::Method(robot, _) => Some(*robot),
            _ => None,
        })
        .collect::<std::collections::BTreeSet<u32>>()
        .len();
    let mut plots: Vec<(Figure, Vec<Json>)> = Vec::new();
    for (number, ((figure, curve), values)) in measured.curves.into_iter().enumerate() {
        let values = values.finish();
        let scale = match figure {
            Figure::Coverage | Figure::SafeShare => 100.0,
            _ => 1.0,
        };
        let range = Range::of(values.iter().map(|s| s.item * scale));
        let times = values.iter().map(|s| pack_time(s.time_ns)).collect();
        lists.u32(&format!("curve.{number}.time"), times, 2);
        let packed = values.iter().map(|s| range.pack(s.item * scale)).collect();
        lists.u16(&format!("curve.{number}.value"), packed, 1);
        let by = match curve {
            Curve::Method(_, method) if watched == 1 => Some(method),
            _ => None,
        };
        let (name, robot) = match curve {
            Curve::Robot(robot) => (gathered.name(robot), Some(robot)),
            Curve::Method(robot, method) => {
                let method = Prediction::method_name(method).replace('_', " ");
                let name = if watched > 1 {
                    format!("{}: {method}", gathered.name(robot))
                } else {
                    method
                };
                (name, None)
            }
            Curve::Named(name) => (name.to_owned(), None),
        };
        let curve =
            json!({ "name": name, "robot": robot, "method": by, "list": number, "range": range });
        match plots.last_mut() {
            Some((last, curves)) if *last == figure => curves.push(curve),
            _ => plots.push((figure, vec![curve])),
        }
    }
    plots
        .into_iter()
        .map(|(figure, curves)| {
            let (title, unit) = heading(figure);
            let steps = figure == Figure::Outcome;
            json!({ "title": title, "unit": unit, "steps": steps, "curves": curves })
        })
        .collect()
}
