//! Cost of exact geometry and shortest paths in the city, compared with common alternatives.
//!
//! Baselines: parry's exact distance of a segment to every piece, and A* on the grid of the map
//! (the `pathfinding` crate, cells of 5 cm, eight neighbours).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../algorithms/planner_view/tests/scenes/mod.rs"]
mod scenes;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Point2;
use navigation::tangent_graph::TangentGraph;
use planner_view::free_space::{Arc, FreeSpace};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use scenes::{RADIUS, city, parry_segment_distance, unit};

const EXIT: Point2<f64> = Point2::new(9.0, 0.0);
/// Queries per measurement.
const COUNT: usize = 1024;

fn generator() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(3)
}

fn free_points(space: &FreeSpace) -> Vec<Point2<f64>> {
    let mut rng = generator();
    (0..COUNT)
        .map(|_| {
            space
                .random_free(&mut rng, RADIUS)
                .expect("the city has streets")
        })
        .collect()
}

/// Returns a function that yields the elements cyclically.
fn cycle<T: Copy>(items: &[T]) -> impl FnMut() -> T {
    let mut next = 0;
    move || {
        next = (next + 1) % items.len();
        items[next]
    }
}

fn travel(criterion: &mut Criterion) {
    let space = city();
    let mut rng = generator();
    let mut angle = || core::f64::consts::TAU * (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    // As a tree grows: from a free point a metre in any direction.
    let segments: Vec<_> = free_points(&space)
        .into_iter()
        .map(|p| (p, p + unit(angle())))
        .collect();
    let free: Vec<_> = segments
        .iter()
        .copied()
        .filter(|&(a, b)| space.segment_is_free(a, b, RADIUS))
        .collect();
    let arcs: Vec<_> = segments
        .iter()
        .map(|&(p, q)| {
            let start = angle();
            let center = p - unit(start) * 0.8;
            let sweep = (q - p).norm() / 0.8;
            Arc {
                center,
                radius: 0.8,
                start,
                sweep,
            }
        })
        .collect();
    println!("{} of {COUNT} segments are free", free.len());
    let mut group = criterion.benchmark_group("travel");
    let mut next = cycle(&segments);
    group.bench_function("segment_1m_is_free", |b| {
        b.iter(|| {
            let (p, q) = next();
            space.segment_is_free(black_box(p), q, RADIUS)
        });
    });
    let mut next = cycle(&free);
    group.bench_function("segment_1m_that_is_free", |b| {
        b.iter(|| {
            let (p, q) = next();
            space.segment_is_free(black_box(p), q, RADIUS)
        });
    });
    let mut next = cycle(&segments);
    group.bench_function("baseline_parry_segment_distance", |b| {
        b.iter(|| {
            let (p, q) = next();
            parry_segment_distance(&space, black_box(p), q) >= RADIUS
        });
    });
    let mut next = cycle(&arcs);
    group.bench_function("arc_1m_is_free", |b| {
        b.iter(|| space.arc_is_free(black_box(&next()), RADIUS));
    });
    group.finish();
}

fn paths(criterion: &mut Criterion) {
    let space = city();
    let graph = TangentGraph::new(&space, RADIUS).expect("the city has few corners");
    println!("{} sites, {} tangents", graph.sites(), graph.tangents());
    let points = free_points(&space);
    let pairs: Vec<_> = points
        .iter()
        .copied()
        .zip(points.iter().copied().rev())
        .collect();
    let mut group = criterion.benchmark_group("shortest_path");
    group.sample_size(20);
    group.bench_function("build", |b| {
        b.iter(|| TangentGraph::new(&space, black_box(RADIUS)).is_ok());
    });
    group.bench_function("free_space_of_the_city", |b| {
        b.iter(|| {
            let parts = space.shapes().parts().to_vec();
            FreeSpace::new(parts, *space.bounds(), black_box(0.05)).is_ok()
        });
    });
    group.sample_size(100);
    let mut next = cycle(&pairs);
    group.bench_function("distance_random_pairs", |b| {
        b.iter(|| {
            let (p, q) = next();
            graph.distance(black_box(p), q)
        });
    });
    let mut next = cycle(&pairs);
    group.bench_function("path_random_pairs", |b| {
        b.iter(|| {
            let (p, q) = next();
            graph.shortest(black_box(p), q)
        });
    });
    let start = Point2::new(-4.5, 7.5);
    group.bench_function("distance_start_to_exit", |b| {
        b.iter(|| graph.distance(black_box(start), EXIT));
    });
    group.bench_function("towards_a_goal", |b| {
        b.iter(|| graph.towards(black_box(EXIT)));
    });
    let towards = graph.towards(EXIT);
    let mut next = cycle(&points);
    group.bench_function("towards_distance", |b| {
        b.iter(|| towards.distance(black_box(next())));
    });
    for &p in &points {
        towards.lower_bound(p);
    }
    let mut next = cycle(&points);
    group.bench_function("towards_lower_bound", |b| {
        b.iter(|| towards.lower_bound(black_box(next())));
    });
    let mut next = cycle(&pairs);
    group.sample_size(10);
    group.bench_function("baseline_a_star_on_the_grid", |b| {
        b.iter(|| {
            let (p, q) = next();
            a_star(&space, black_box(p), q)
        });
    });
    group.finish();
}

/// Returns the length of the shortest path over the cells' centres (cells / 1000).
fn a_star(space: &FreeSpace, from: Point2<f64>, to: Point2<f64>) -> Option<u64> {
    let (frame, clearance) = (space.shapes().frame(), &space.shapes().clearance().cells);
    let (from, to) = (frame.cell_at(from)?, frame.cell_at(to)?);
    let neighbours = |&(col, row): &(usize, usize)| {
        let offsets = [-1i64, 0, 1];
        let all = offsets
            .into_iter()
            .flat_map(move |dy| offsets.map(|dx| (dx, dy)));
        all.filter_map(move |(dx, dy)| {
            let (col, row) = (
                col.checked_add_signed(dx as isize)?,
                row.checked_add_signed(dy as isize)?,
            );
            let is_free = (dx, dy) != (0, 0)
                && col < frame.width
                && row < frame.height
                && (f64::from(clearance[frame.index(col, row)]) >= RADIUS || (col, row) == to);
            let cost = if dx != 0 && dy != 0 { 1414 } else { 1000 };
            is_free.then_some(((col, row), cost))
        })
    };
    let octile = |&(col, row): &(usize, usize)| {
        let (dx, dy) = (col.abs_diff(to.0) as u64, row.abs_diff(to.1) as u64);
        1000 * dx.max(dy) + 414 * dx.min(dy)
    };
    pathfinding::directed::astar::astar(&from, neighbours, octile, |&cell| cell == to)
        .map(|(_, cost)| cost)
}

criterion_group!(benches, travel, paths);
criterion_main!(benches);
