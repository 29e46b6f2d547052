//! Cost of choosing sub-goals, and gain of summed cell values.
//!
//! The value of a leg comes from sums along rows and columns, which are recomputed after every
//! sweep. Baseline: a loop over the same cells, without sums.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;

use coverage::decomposition::Decomposition;
use coverage::freshness::Freshness;
use coverage::goal::GoalSource as _;
use coverage::keyed::{KeyedCoverage, KeyedParams};
use coverage::space::Space;
use coverage::workplace::Workplace;
use criterion::{Criterion, criterion_group, criterion_main};
use geometry::shape::Aabb;
use metrics::coverage::CellGrid;
use nalgebra::Point2;

const RADIUS: f64 = 0.1;
const SUB_GOALS: usize = 50;

/// The empty workplace of the coverage papers.
fn empty() -> (Workplace, Decomposition) {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let workplace = Workplace::new(bounds, RADIUS, &[], 0.01).expect("a sound workplace");
    let parts = Decomposition::new(&workplace).expect("free space");
    (workplace, parts)
}

fn coverage(criterion: &mut Criterion) {
    let (workplace, parts) = empty();
    let start = Point2::new(2.0, 7.0);
    criterion.bench_function("keyed_50_sub_goals", |bencher| {
        bencher.iter(|| {
            let params = KeyedParams::default();
            let planner = KeyedCoverage::new(&workplace, &parts, start, RADIUS, [4; 32], params);
            let mut planner = planner.expect("sound parameters");
            let mut from = start;
            for _ in 0..SUB_GOALS {
                let goal = planner.next_goal(from);
                from = goal.map_or(from, |goal| goal.waypoint.point);
            }
            from
        });
    });

    let space = Space::new(&workplace, &parts, start);
    let grid = workplace
        .domain()
        .and_then(|domain| CellGrid::new(&domain, 0.1));
    let grid = grid.expect("cells that suit the workplace");
    let mut freshness = Freshness::new(&grid, &space, RADIUS, 1.5, 2);
    let to = Point2::new(6.5, 4.0);
    let mut group = criterion.benchmark_group("leg_of_5_m");
    group.bench_function("by_sums", |bencher| {
        bencher.iter(|| black_box(freshness.worth_of(start, black_box(to))));
    });
    group.bench_function("cell_by_cell", |bencher| {
        bencher.iter(|| black_box(freshness.fresh_on(start, black_box(to))));
    });
    group.bench_function("sweep_and_sums", |bencher| {
        bencher.iter(|| {
            freshness.renew();
            black_box(freshness.sweep(start, to))
        });
    });
    group.finish();
}

criterion_group!(benches, coverage);
criterion_main!(benches);
