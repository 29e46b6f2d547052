//! Planners of sub-goals on random maps.

use chaotic_maps::{Key, KeyKind};
use coverage::boustrophedon::Boustrophedon;
use coverage::decomposition::{Decomposition, Place};
use coverage::goal::GoalSource;
use coverage::keyed::{KeyedCoverage, KeyedParams};
use coverage::plan::{CoveragePlan, PlanSpec};
use coverage::random_bounce::RandomBounce;
use coverage::uniform::UniformGoals;
use coverage::workplace::Workplace;
use nalgebra::Point2;

use crate::random_map::RandomMaps;

/// A map that has free space, its division, and a free start.
fn scenes(count: usize) -> Vec<(Workplace, Decomposition, Point2<f64>)> {
    let mut maps = RandomMaps::new(21);
    let mut scenes = Vec::new();
    while scenes.len() < count {
        let workplace = maps.next_map(3 + scenes.len() % 6);
        if let Ok(parts) = Decomposition::new(&workplace) {
            let start = parts.rectangles()[0].center();
            scenes.push((workplace, parts, start));
        }
    }
    scenes
}

fn thrifty() -> KeyedParams {
    KeyedParams {
        candidates: 8,
        ..KeyedParams::default()
    }
}

/// Maximum depth of the straight leg in an obstacle (m), sampled every few millimetres.
fn depth(workplace: &Workplace, from: Point2<f64>, to: Point2<f64>) -> f64 {
    let steps = ((to - from).norm() / 0.004).ceil().max(1.0) as usize;
    let points = (0..=steps).map(|step| from + (to - from) * (step as f64 / steps as f64));
    let into = |p: Point2<f64>| {
        let obstacles = workplace.inflated().iter().map(move |o| {
            (p.x - o.min.x)
                .min(o.max.x - p.x)
                .min(p.y - o.min.y)
                .min(o.max.y - p.y)
        });
        let inner = workplace.inner();
        obstacles.fold(inner.distance(p), f64::max)
    };
    points.map(into).fold(0.0, f64::max)
}

fn drives_clear(workplace: &Workplace, planner: &mut dyn GoalSource, start: Point2<f64>) {
    let mut from = start;
    for _ in 0..150 {
        let Some(goal) = planner.next_goal(from) else {
            break;
        };
        let to = goal.waypoint.point;
        let deep = depth(workplace, from, to);
        assert!(deep < 1e-8, "{deep} m into an obstacle: {from} to {to}");
        if let Some(within) = goal.within {
            assert!(within.contains(from) && within.contains(to));
        }
        from = to;
    }
}

#[test]
fn no_planner_touches_an_obstacle() {
    for (workplace, parts, start) in scenes(12) {
        let key = [13; 32];
        let keyed = KeyedCoverage::new(&workplace, &parts, start, 0.1, key, thrifty());
        drives_clear(&workplace, &mut keyed.unwrap(), start);
        let lanes = Boustrophedon::new(&workplace, &parts, start, 0.1);
        drives_clear(&workplace, &mut lanes.unwrap(), start);
        let mut bounce = RandomBounce::new(&workplace, &parts, start, key);
        drives_clear(&workplace, &mut bounce, start);
        let mut uniform = UniformGoals::new(&workplace, &parts, start, key);
        drives_clear(&workplace, &mut uniform, start);
    }
}

/// Drives through a divided workplace; returns the length in the own part and in those of others (m).
fn lengths(
    workplace: &Workplace,
    parts: &Decomposition,
    planner: &mut dyn GoalSource,
    start: Point2<f64>,
) -> [f64; 2] {
    drives_clear(workplace, planner, start);
    let own = |p: Point2<f64>| {
        let mut all = parts.rectangles().iter().enumerate();
        all.any(|(r, rectangle)| parts.is_own(r) && rectangle.distance(p) < 1e-6)
    };
    let mut lengths = [0.0; 2];
    let mut from = start;
    for _ in 0..300 {
        let to = planner.next_goal(from).unwrap().waypoint.point;
        lengths[usize::from(!own(from + 0.5 * (to - from)))] += (to - from).norm();
        from = to;
    }
    lengths
}

#[test]
fn planners_drive_to_their_part_of_a_team_and_stay_there_but_for_transits() {
    let mut sums = [[0.0; 2]; 5];
    for (workplace, parts, start) in scenes(12) {
        let place = |at: Point2<f64>| Place {
            start: at,
            here: start,
        };
        let team = [start, Point2::new(0.0, 0.0), Point2::new(10.0, 10.0)].map(place);
        for own in 0..3 {
            let (parts, part) = parts.clone().divided(&workplace, &team, own).unwrap();
            let key = [13; 32];
            let keyed = KeyedCoverage::new(&workplace, &parts, start, 0.1, key, thrifty());
            let lanes = Boustrophedon::new(&workplace, &parts, start, 0.1);
            let source = Key::from_seed(KeyKind::Keyed, 5).source().unwrap();
            let plan = CoveragePlan::new(parts.clone(), start, &PlanSpec::default(), source);
            let planners: [Box<dyn GoalSource>; 5] = [
                Box::new(keyed.unwrap()),
                Box::new(lanes.unwrap()),
                Box::new(RandomBounce::new(&workplace, &parts, start, key)),
                Box::new(UniformGoals::new(&workplace, &parts, start, key)),
                Box::new(plan.unwrap()),
            ];
            for (sum, mut planner) in sums.iter_mut().zip(planners) {
                let [inside, outside] = lengths(&workplace, &parts, &mut *planner, start);
                assert!(inside > 10.0, "part {part}: {inside} m");
                *sum = [sum[0] + inside, sum[1] + outside];
            }
        }
    }
    for [inside, outside] in sums {
        assert!(outside < 0.15 * inside, "{sums:?}");
    }
}

#[test]
fn keyed_coverage_reaches_all_that_can_be_reached() {
    for (index, (workplace, parts, start)) in scenes(8).into_iter().enumerate() {
        let params = KeyedParams {
            round_at: 0.995,
            ..thrifty()
        };
        let mut planner =
            KeyedCoverage::new(&workplace, &parts, start, 0.1, [2; 32], params).unwrap();
        let mut from = start;
        let mut goals = 0;
        while planner.round() == 0 {
            from = planner.next_goal(from).unwrap().waypoint.point;
            goals += 1;
            assert!(goals < 5000, "map {index}: {} covered", planner.covered());
        }
    }
}

#[test]
fn boustrophedon_covers_all_that_can_be_reached() {
    use metrics::coverage::{CellGrid, SweptCells};
    for (workplace, parts, start) in scenes(12) {
        let mut planner = Boustrophedon::new(&workplace, &parts, start, 0.1).unwrap();
        let grid = CellGrid::new(&workplace.domain().unwrap(), 0.1).unwrap();
        let mut swept = SweptCells::new(grid, workplace.radius());
        let mut from = start;
        while let Some(goal) = planner.next_goal(from) {
            swept.sweep(from, goal.waypoint.point);
            from = goal.waypoint.point;
        }
        let component = parts.component_of(0).unwrap();
        for (cell, &covered) in swept.cells().iter().enumerate() {
            let center = swept.grid().center(cell);
            let mut mine = parts.component(component);
            let reachable = mine.any(|r| parts.rectangles()[r].contains(center));
            assert!(covered || !reachable, "{center} is left out");
        }
    }
}
