//! Knot placement of splines: breaks around the arcs of the guide and after the start.

use geometry::math;
use navigation::tangent_graph::PathLeg;

use crate::guide::Guide;

/// Distances of the breaks after the start (and before the goal), in turning radii: a robot whose
/// prescribed heading differs from the guide's turns into the guide there.
const TURN_IN: [f64; 3] = [3.0, 8.0, 20.0];
/// Minimum turning radius (m) for these distances.
const MIN_TURN: f64 = 5e-3;
/// Difference of headings (rad) below which no breaks are needed.
const SAME_HEADING: f64 = 2e-3;
/// Distance of breaks from the ends of an arc, before and behind them, as a fraction of its radius.
const AROUND: f64 = 0.4;
/// Maximum cost of an arc's end, as a fraction of the path's length.
const LOSS: f64 = 2e-5;
/// Maximum turn (rad) of a long arc between two breaks.
const TURN: f64 = 1.0;
/// Number of equal parts of the path with at least one break each.
const PARTS: f64 = 6.0;
/// Kinks (rad) of the guide that count as arcs.
const KINK: f64 = 1e-3;

/// Headings (rad) at the ends of the path, if prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Headings {
    /// At the start.
    pub start: Option<f64>,
    /// At the goal.
    pub goal: Option<f64>,
}

/// The breaks of a spline along a guide, as fractions of its length; at each `level` twice as many.
/// `turning` is the smallest radius (m) that the robot can drive at full speed.
pub fn breaks(guide: &Guide, headings: Headings, turning: f64, level: u32) -> Vec<f64> {
    let length = guide.length();
    let mut at: Vec<f64> = Vec::new();
    let unit = turning.max(MIN_TURN).min(0.05 * length);
    let differs = |asked: f64, u: nalgebra::Vector2<f64>| {
        math::angle_difference(asked, math::atan2(u.y, u.x)).abs() > SAME_HEADING
    };
    if headings
        .start
        .is_some_and(|h| differs(h, guide.heading(0.0)))
    {
        at.extend(TURN_IN.map(|d| d * unit));
    }
    if headings
        .goal
        .is_some_and(|h| differs(h, guide.heading(1.0)))
    {
        at.extend(TURN_IN.map(|d| length - d * unit));
    }
    let mut before: Option<nalgebra::Vector2<f64>> = None;
    for (s, leg) in guide.legs() {
        let begins = leg.heading(0.0);
        if before.is_some_and(|u| u.dot(&begins) < 1.0 - 0.5 * KINK * KINK) {
            let d = 2.0 * unit.max(0.01 * length);
            at.extend([s - d, s, s + d]);
        }
        before = Some(leg.heading(1.0));
        let PathLeg::Arc(arc) = leg else { continue };
        let (a, b) = (s, s + leg.length());
        // A spline rounds off the step of the curvature over d, which costs about d³ / 25 R².
        let little = LOSS * length * arc.radius * arc.radius * 25.0;
        let d = (AROUND * arc.radius).min(math::cbrt(little));
        if b - a <= 2.5 * d {
            at.extend([a - d, 0.5 * (a + b), b + d]);
        } else {
            at.extend([a - d, a + d, b - d, b + d]);
            let inside = b - a - 2.0 * d;
            let count = (inside / (TURN * arc.radius)).floor();
            at.extend((1..=count as usize).map(|i| a + d + inside * i as f64 / (count + 1.0)));
        }
    }
    let near = 0.5 * unit.max(0.4 * MIN_TURN).min(length / 64.0);
    at.retain(|&s| s > near && s < length - near);
    at.sort_by(f64::total_cmp);
    at.dedup_by(|b, a| *b - *a < near);
    let mut all = filled(&at, length, length / PARTS);
    for _ in 0..level {
        all = halved(&all, length);
    }
    all.iter().map(|s| s / length).collect()
}

/// Adds breaks in gaps that are wider than `most`.
fn filled(at: &[f64], length: f64, most: f64) -> Vec<f64> {
    let mut all = Vec::with_capacity(at.len() + PARTS as usize);
    let mut before = 0.0;
    for &next in at.iter().chain([&length]) {
        let count = ((next - before) / most).ceil().max(1.0);
        all.extend((1..count as usize).map(|i| before + (next - before) * i as f64 / count));
        if next < length {
            all.push(next);
        }
        before = next;
    }
    all
}

fn halved(at: &[f64], length: f64) -> Vec<f64> {
    let mut all = Vec::with_capacity(2 * at.len() + 1);
    let mut before = 0.0;
    for &next in at.iter().chain([&length]) {
        all.push(0.5 * (before + next));
        if next < length {
            all.push(next);
        }
        before = next;
    }
    all
}
