//! Plans driven on maps, and checked against the obstacles alone.

use chaotic_maps::{Key, KeyKind};
use coverage::decomposition::Decomposition;
use coverage::plan::{CoveragePlan, PlanSpec};
use coverage::tour::{Iterations, Route};
use coverage::transit::Transit;
use coverage::workplace::Workplace;
use nalgebra::Point2;

use super::RandomMaps;

/// Points of a straight leg (m), without the start and with the end, in equal parts of at most `step` (m).
pub fn interpolate(
    from: Point2<f64>,
    to: Point2<f64>,
    step: f64,
) -> impl Iterator<Item = Point2<f64>> {
    let line = to - from;
    let parts = (line.norm() / step).ceil().max(1.0) as u32;
    (1..=parts).map(move |part| from + line * (f64::from(part) / f64::from(parts)))
}

/// Result of driving a plan.
#[derive(Debug, Clone, Copy, Default)]
pub struct Driven {
    /// Number of legs.
    pub legs: u64,
    /// Number of points on legs where the robot's disc meets an obstacle or the border.
    pub collisions: u64,
    /// Number of rectangles of the start's component without a sub-goal.
    pub missed: u64,
}

/// Drives large loops from a random place in the first rectangle. The check uses obstacles at their
/// own size, by the distance from points 0.05 m apart on the legs.
pub fn drive(
    workplace: &Workplace,
    decomposition: &Decomposition,
    maps: &mut RandomMaps,
    loops: u32,
) -> Driven {
    let first = decomposition.rectangles()[0];
    let start = first.min + (first.max - first.min) * maps.unit();
    let seed = (maps.unit() * 1e15) as u64;
    let source = Key::from_seed(KeyKind::Keyed, seed)
        .source()
        .expect("a sound key");
    let spec = PlanSpec {
        route: Route::Walk,
        iterations: Iterations::Each(3),
        transit: Transit::Direct,
        loops,
    };
    let mut plan = CoveragePlan::new(decomposition.clone(), start, &spec, source)
        .expect("the start is free and can be toured");
    let (bounds, radius) = (workplace.bounds(), workplace.radius() - 1e-9);
    let mut driven = Driven::default();
    let mut seen = vec![false; decomposition.rectangles().len()];
    let mut last = start;
    while let Some(goal) = plan.step() {
        let p = goal.waypoint.point;
        for (seen, r) in seen.iter_mut().zip(decomposition.rectangles()) {
            *seen |= r.contains(p);
        }
        driven.legs += 1;
        for p in interpolate(last, p, 0.05) {
            let walls = (p - bounds.min).inf(&(bounds.max - p)).min();
            let hit = workplace
                .rectangles()
                .iter()
                .any(|o| o.distance(p) < radius);
            driven.collisions += u64::from(hit || walls < radius);
        }
        last = p;
    }
    let reachable = decomposition.component(0);
    driven.missed = reachable.filter(|&r| !seen[r]).count() as u64;
    driven
}
