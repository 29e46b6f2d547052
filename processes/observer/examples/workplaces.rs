//! Prediction of a coverage by an observer that knows the workplace and the method but not the key: the
//! table of `docs/results/coverage.md`.
//!
//! `cargo run --release -p observer --example workplaces -- [part of a workplace's name]`
//!
//! The real planner drives two large loops under each of [`KEYS`] keys. The observer measures poses
//! with a noise of 5 mm and 5 mrad. The errors of its predictions are averaged over the time after the
//! key is known, by the rectangle in which the robot then is.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/all/drive.rs"]
mod drive;

use std::collections::BTreeMap;

use chaotic_maps::{Emission, Key, KeyKind};
use coverage::decomposition::Decomposition;
use coverage::workplace::Workplace;
use drive::{DT, Hunter, Place, coverage, workplace};
use geometry::shape::{Aabb, Shape};
use metrics::quantile::quantile;
use nalgebra::Point2;
use observer::knowledge::ChebyshevKnowledge;

/// Number of keys, and the factor of Student's 95 % interval for them.
const KEYS: u64 = 20;
const STUDENT: f64 = 2.093;
/// Duration of a drive (s): about two large loops.
const DURATION_S: f64 = 2400.0;
/// Prediction horizons (s).
const HORIZONS: [f64; 2] = [2.0, 5.0];
const NOISE: f64 = 0.005;

/// Errors of one key, by rectangle and horizon: sum (m) and number.
type Errors = BTreeMap<usize, [(f64, u64); 2]>;

/// Result of one key.
struct WatchedRobot {
    /// Sub-goals reached when the key was known.
    after: Option<usize>,
    errors: Errors,
    /// Number of moments since then, and of those with a prediction.
    moments: [u64; 2],
}

fn rectangle_of(rectangles: &[Aabb], place: Point2<f64>) -> usize {
    let distance = |r: &Aabb| r.distance(place);
    let nearest = (0..rectangles.len())
        .min_by(|&a, &b| distance(&rectangles[a]).total_cmp(&distance(&rectangles[b])));
    nearest.unwrap_or(0)
}

fn watched(place: &Place, rectangles: &[Aabb], seed: u64) -> WatchedRobot {
    let knowledge = ChebyshevKnowledge::default();
    let key = Key::from_seed(KeyKind::ChebP(Emission::Arcsine), seed);
    let mut drive = coverage(place, &key.to_string());
    let layout = drive.layout(&knowledge);
    let mut hunter = Hunter::new(&layout, knowledge.finder(), (NOISE, seed));
    let mut pending: BTreeMap<(u64, usize), Point2<f64>> = BTreeMap::new();
    let (mut after, mut errors, mut moments) = (None, Errors::new(), [0; 2]);
    for tick in 0..(DURATION_S / DT) as u64 {
        hunter.observe(drive.pose(), tick, true);
        if hunter.key_recovered() && after.is_none() {
            after = Some(drive.reports.len());
        }
        if after.is_some() {
            moments[0] += 1;
            moments[1] += u64::from(hunter.predict(HORIZONS[0]).is_some());
        }
        for (horizon, ahead) in HORIZONS.iter().enumerate() {
            if let Some(predicted) = pending.remove(&(tick, horizon)) {
                let truth = drive.pose().position();
                let rectangle = rectangle_of(rectangles, truth);
                let entry = &mut errors.entry(rectangle).or_default()[horizon];
                entry.0 += (predicted - truth).norm();
                entry.1 += 1;
            }
            if tick % 5 == 0
                && let Some(predicted) = hunter.predict(*ahead)
            {
                pending.insert((tick + (ahead / DT).round() as u64, horizon), predicted);
            }
        }
        drive.tick();
    }
    WatchedRobot {
        after,
        errors,
        moments,
    }
}

/// Returns mean and half of the 95 % interval of the keys' means.
fn interval(means: &[f64]) -> String {
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (n - 1.0);
    format!("{mean:.2} ± {:.2}", STUDENT * (variance / n).sqrt())
}

fn table(name: &str, place: &Place) {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let knowledge = ChebyshevKnowledge::default();
    let (margin, tolerance) = (knowledge.margin, knowledge.tolerance);
    let rectangles = Workplace::new(bounds, place.radius + margin, &place.obstacles, tolerance)
        .ok()
        .and_then(|workplace| Decomposition::new(&workplace).ok())
        .map_or_else(Vec::new, |free| free.rectangles().to_vec());
    let all: Vec<WatchedRobot> = (1..=KEYS)
        .map(|seed| watched(place, &rectangles, seed))
        .collect();
    let mut after: Vec<f64> = all.iter().filter_map(|w| Some(w.after? as f64)).collect();
    after.sort_by(f64::total_cmp);
    let found = after.len();
    let moments = |part: usize| all.iter().map(|w| w.moments[part]).sum::<u64>() as f64;
    println!(
        "{name}: {} rectangles; key recovered {found} of {KEYS}, after {:?} sub-goals in the median, {:?} at most; \
         known for {:.1} % of the time since",
        rectangles.len(),
        quantile(&after, 0.5),
        after.last(),
        100.0 * moments(1) / moments(0).max(1.0),
    );
    let means = |rectangle: Option<usize>, horizon: usize| -> Vec<f64> {
        let sum = |w: &WatchedRobot| {
            let chosen = w.errors.iter();
            let chosen = chosen.filter(|(at, _)| rectangle.is_none_or(|wanted| wanted == **at));
            chosen.fold((0.0, 0), |(sum, count), (_, errors)| {
                (sum + errors[horizon].0, count + errors[horizon].1)
            })
        };
        let sums = all.iter().map(sum).filter(|(_, count)| *count > 0);
        sums.map(|(sum, count)| sum / count as f64).collect()
    };
    let mut rows: Vec<Option<usize>> = vec![None];
    if rectangles.len() > 1 {
        rows.extend((0..rectangles.len()).map(Some));
    }
    for row in rows {
        let what = row.map_or_else(
            || "all".to_owned(),
            |at| {
                let r = rectangles[at];
                let size = r.max - r.min;
                format!("{at}: {:.1} m × {:.1} m", size.x, size.y)
            },
        );
        let near = means(row, 0);
        let far = means(row, 1);
        println!(
            "| {name} | {what} | {} | {} | {} |",
            near.len(),
            interval(&near),
            interval(&far)
        );
    }
}

fn main() {
    let part = std::env::args().nth(1).unwrap_or_default();
    let rectangle = |center, half_extents, angle| Shape::Rectangle {
        center,
        half_extents,
        angle,
    };
    let polygon = |vertices: &[[f64; 2]]| Shape::Polygon {
        vertices: vertices.to_vec(),
    };
    let polygons = [
        Shape::Circle {
            center: [2.5, 7.0],
            radius: 1.0,
        },
        polygon(&[[6.0, 6.2], [8.6, 6.6], [7.0, 8.8]]),
        rectangle([2.6, 2.8], [1.2, 0.5], 0.6),
        polygon(&[
            [6.0, 1.4],
            [8.8, 1.4],
            [8.8, 2.2],
            [6.8, 2.2],
            [6.8, 4.0],
            [6.0, 4.0],
        ]),
    ];
    for (name, place) in [
        ("coverage_open", workplace(&[], [5.0, 5.0])),
        (
            "coverage_case1",
            workplace(&[rectangle([5.0, 5.0], [2.5, 2.5], 0.0)], [1.0, 8.0]),
        ),
        (
            "coverage_case2",
            workplace(
                &[
                    rectangle([1.5, 5.0], [1.5, 1.5], 0.0),
                    rectangle([8.5, 5.0], [1.5, 1.5], 0.0),
                ],
                [1.0, 8.0],
            ),
        ),
        ("coverage_polygons", workplace(&polygons, [5.0, 5.0])),
    ] {
        if name.contains(&part) {
            table(name, &place);
        }
    }
}
