//! A soak as a chart: everything that was held by what it was in the middle of the soak, over time.

use std::collections::BTreeMap;

use super::mission::{Mission, ORCHESTRATOR};
use crate::figures::{Chart, Point, Series, Unit};
use crate::statistics::Spread;

/// Points of a curve.
const POINTS: usize = 40;

/// One quantity: of whom, by time [min].
type Track = Vec<(f64, f64)>;

/// The chart; curves that lie at 1 are flat.
pub fn chart(missions: &[Mission]) -> Chart {
    let mut tracks: BTreeMap<(bool, &'static str, String), Track> = BTreeMap::new();
    for mission in missions {
        let at = (mission.begun_s + mission.lasted_s) / 60.0;
        for (name, held) in &mission.processes {
            let ours = name == ORCHESTRATOR;
            let who = if ours {
                String::new()
            } else {
                format!("{}/{}/{name}", mission.scenario, mission.seed)
            };
            for (what, value) in [
                ("memory", held.memory_bytes),
                ("descriptors", held.descriptors),
            ] {
                let track = tracks.entry((ours, what, who.clone())).or_default();
                track.push((at, value as f64));
            }
        }
    }
    let end = missions
        .last()
        .map_or(0.0, |m| (m.begun_s + m.lasted_s) / 60.0);
    let mut series = Vec::new();
    for (ours, what, name) in [
        (true, "memory", "memory of the orchestrator"),
        (true, "descriptors", "descriptors of the orchestrator"),
        (false, "memory", "memory of the processes"),
        (false, "descriptors", "descriptors of the processes"),
    ] {
        let mut shares: Track = tracks
            .iter()
            .filter(|((o, w, _), _)| *o == ours && *w == what)
            .flat_map(|(_, track)| relative(track))
            .collect();
        shares.sort_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series {
            name: name.to_owned(),
            points: gathered(&shares, end),
            reference: Vec::new(),
        });
    }
    Chart {
        title: "What was held, by its own median".to_owned(),
        subtitle: format!(
            "{} missions back to back; medians over all processes",
            missions.len()
        ),
        x_label: "time [min]".to_owned(),
        y_label: "by its median".to_owned(),
        unit: Unit::Number,
        interval: "middle half".to_owned(),
        series,
        ..Chart::default()
    }
}

/// A track by its own median.
fn relative(track: &[(f64, f64)]) -> Track {
    let median = Spread::of(track.iter().map(|t| t.1)).map_or(0.0, |s| s.median);
    if median <= 0.0 {
        return Vec::new();
    }
    track.iter().map(|(at, v)| (*at, v / median)).collect()
}

/// Medians of equal parts of the time, with the middle half of the values.
fn gathered(shares: &[(f64, f64)], end: f64) -> Vec<Point> {
    let part = |at: f64| ((at / end.max(1e-9) * POINTS as f64) as usize).min(POINTS - 1);
    let mut parts: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (at, share) in shares {
        parts.entry(part(*at)).or_default().push(*share);
    }
    parts
        .into_iter()
        .filter_map(|(index, mut values)| {
            values.sort_by(f64::total_cmp);
            let at = |share: f64| values.get((share * (values.len() - 1) as f64).round() as usize);
            Some(Point {
                x: (index as f64 + 0.5) * end / POINTS as f64,
                y: *at(0.5)?,
                interval: Some((*at(0.25)?, *at(0.75)?)),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_track_lies_at_one() {
        let level: Track = (0..100).map(|i| (f64::from(i) * 0.6, 7e6)).collect();
        let points = gathered(&relative(&level), 60.0);
        assert_eq!(points.len(), POINTS);
        assert!(
            points
                .iter()
                .all(|p| p.y == 1.0 && p.interval == Some((1.0, 1.0)))
        );
        assert!(points.windows(2).all(|p| p[0].x < p[1].x));
        assert!(relative(&[(0.0, 0.0)]).is_empty());
    }
}
