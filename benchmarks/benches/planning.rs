//! Cost of RRT* plans in the paper's city.
//!
//! Baseline: the chasing-game paper's published Python took 3.79 s of CPU for 1500 iterations with
//! four Police and found a path in 19 of 20 tries; on arcs 5.51 s for 5000 iterations, found in 2
//! of 6. For path lengths relative to the shortest, and a comparison with OMPL, see
//! `benchmarks/ompl_baseline`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../processes/evader_rrt_star/tests/support/mod.rs"]
mod support;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use evader_rrt_star::bound::Bound;
use evader_rrt_star::collision_map::CollisionMap;
use evader_rrt_star::cost::CostModel;
use evader_rrt_star::index::BucketIndex;
use evader_rrt_star::motion::{Arcs, Motion, Straight};
use evader_rrt_star::params::{Algorithm, CostParams, SearchParams};
use evader_rrt_star::search::{Scene, Search};
use nalgebra::Point2;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};
use statistics::quantile;
use support::{EXIT, RADIUS, START, city, costs};

const TRIES: u64 = 100;

/// Iterations between two readings of the clock.
const BETWEEN_LOOKS: u32 = 32;

fn cpu_ms() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

fn arcs(min_radius: f64) -> Arcs {
    Arcs {
        min_radius,
        max_bearing: core::f64::consts::FRAC_PI_4,
        free_start: false,
    }
}

fn scene<'a>(collision_map: &'a CollisionMap, cost: &'a CostModel) -> Scene<'a> {
    Scene {
        space: &collision_map.space,
        sampler: &collision_map.sampler,
        radius: RADIUS,
        cost,
        bodies: &[],
    }
}

/// Returns a search for paths from the start to the exit, before its first step.
fn search<M: Motion>(scene: &Scene<'_>, motion: M, seed: u64) -> Search<M> {
    let mut search = Search::new(SearchParams::default(), motion, seed);
    search.plant(
        scene,
        START,
        &[EXIT],
        Bound::straight(START.position(), &[EXIT]),
    );
    search
}

fn plan<M: Motion>(scene: &Scene<'_>, motion: M, seed: u64, iterations: u32) -> Search<M> {
    let mut search = search(scene, motion, seed);
    search.run(scene, iterations);
    search
}

/// Prints the number of successful tries, and CPU times: of the median try, and of the slowest.
fn tries<M: Motion + Copy>(what: &str, scene: &Scene<'_>, motion: M, iterations: u32, ms: f64) {
    let (mut times, mut found, mut costs) = (Vec::new(), 0, Vec::new());
    for seed in 0..TRIES {
        let begin = cpu_ms();
        let mut search = search(scene, motion, seed);
        let mut left = iterations;
        while left > 0 && cpu_ms() - begin < ms {
            let some = left.min(BETWEEN_LOOKS);
            search.run(scene, some);
            left -= some;
        }
        times.push(cpu_ms() - begin);
        if let Some(end) = search.way().last() {
            found += 1;
            costs.push(end.cost);
        }
    }
    times.sort_by(f64::total_cmp);
    costs.sort_by(f64::total_cmp);
    let middle = |values: &[f64]| quantile(values, 0.5).unwrap_or(f64::NAN);
    println!(
        "{what}: found {found}/{TRIES}, CPU {:.2} ms (slowest {:.2}), median cost {:.3}",
        middle(&times),
        times.last().copied().unwrap_or(f64::NAN),
        middle(&costs)
    );
}

/// Near neighbours in a tree that grows to 1500 points: the index, and a linear scan.
fn neighbours(criterion: &mut Criterion, collision_map: &CollisionMap) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let draw = |_| collision_map.sampler.draw(&collision_map.space, &mut rng);
    let points: Vec<Point2<f64>> = (0..1500).filter_map(draw).collect();
    let radius = 1.0;
    let mut group = criterion.benchmark_group("near_1500");
    group.bench_function("buckets", |bencher| {
        let mut found = Vec::new();
        bencher.iter(|| {
            let mut index = BucketIndex::new(*collision_map.space.bounds());
            for &p in &points {
                index.near(p, radius, &mut found);
                black_box(&found);
                index.insert(p);
            }
        });
    });
    group.bench_function("every_point", |bencher| {
        let mut found: Vec<(usize, f64)> = Vec::new();
        bencher.iter(|| {
            for (count, &p) in points.iter().enumerate() {
                found.clear();
                let before = points.iter().take(count).enumerate();
                let near = before.map(|(node, at)| (node, (at - p).norm_squared()));
                found.extend(near.filter(|(_, squared)| *squared <= radius * radius));
                black_box(&found);
            }
        });
    });
    group.finish();
}

fn planning(criterion: &mut Criterion) {
    println!("baseline, paper's Python: 3790 ms for 1500 iterations with 4 Police, found 19/20");
    let space = city();
    let collision_map = CollisionMap::new(&space, RADIUS, 1);
    let length = CostModel::new(CostParams::length(), Algorithm::Improved, 0.45);
    let paper = costs(CostParams::paper(), Algorithm::Published);
    let time_aware = costs(CostParams::default(), Algorithm::Improved);

    let never = f64::INFINITY;
    tries(
        "1500 iterations, 4 Police, paper's cost",
        &scene(&collision_map, &paper),
        Straight,
        1500,
        never,
    );
    tries(
        "1500 iterations, 4 Police, time-aware",
        &scene(&collision_map, &time_aware),
        Straight,
        1500,
        never,
    );
    tries(
        "20 ms, no Police",
        &scene(&collision_map, &length),
        Straight,
        u32::MAX,
        20.0,
    );
    for radius in [RADIUS * 1.5, 0.9, 1.8] {
        let what = format!("arcs from {radius:.2} m, 50 ms, 4 Police, paper's cost");
        tries(
            &what,
            &scene(&collision_map, &paper),
            arcs(radius),
            u32::MAX,
            50.0,
        );
    }

    let mut group = criterion.benchmark_group("plan_1500");
    for (name, cost) in [
        ("length", &length),
        ("paper", &paper),
        ("time_aware", &time_aware),
    ] {
        let scene = scene(&collision_map, cost);
        let mut seed = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                seed += 1;
                black_box(plan(&scene, Straight, seed, 1500).way())
            });
        });
    }
    let scene = scene(&collision_map, &paper);
    let mut seed = 0;
    group.bench_function("paper_arcs", |bencher| {
        bencher.iter(|| {
            seed += 1;
            black_box(plan(&scene, arcs(0.9), seed, 1500).way())
        });
    });
    group.finish();

    neighbours(criterion, &collision_map);

    criterion.bench_function("prepare_map", |bencher| {
        bencher.iter(|| black_box(CollisionMap::new(&space, RADIUS, 1)));
    });
}

criterion_group!(benches, planning);
criterion_main!(benches);
