//! Line-of-sight rays per second against the literal formula of the paper, on a 384 × 384 street
//! grid: `cargo bench -p benchmarks --bench visibility`.
//!
//! A table is printed before Criterion's measurements: the best of many short repetitions (least
//! affected by a busy machine), the ratio to the literal formula, and the largest error against the
//! same integral in f64.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/streets.rs"]
mod streets;

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use geometry::blur::BlurredMap;
use geometry::math;
use geometry::visibility::VisibilityField;
use nalgebra::Point2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use streets::{BLUR, RESOLUTION, SIDE, streets};

type Ray = (Point2<f64>, Point2<f64>);

const RAYS: usize = 4096;

/// Returns pairs of uniformly drawn points in free cells.
fn random_pairs(field: &VisibilityField, rng: &mut ChaCha8Rng) -> Vec<Ray> {
    let mut point = || {
        loop {
            let p = Point2::new(rng.random_range(0.0..6.0), rng.random_range(0.0..6.0));
            if field.is_free(p) {
                return p;
            }
        }
    };
    (0..RAYS).map(|_| (point(), point())).collect()
}

fn visible_pairs(field: &VisibilityField, rng: &mut ChaCha8Rng) -> Vec<Ray> {
    let mut pairs = Vec::new();
    while pairs.len() < RAYS {
        pairs.extend(
            random_pairs(field, rng)
                .into_iter()
                .filter(|&(a, b)| field.is_visible(a, b)),
        );
    }
    pairs.truncate(RAYS);
    pairs
}

/// The paper's formula as written: a product over one-cell steps of v to the power of the step.
#[allow(clippy::disallowed_methods)] // The baseline is the straightforward version.
fn literal(map: &BlurredMap, (a, b): Ray) -> f64 {
    let length = (b - a).norm();
    let step = map.frame().resolution;
    let samples = (length / step).ceil() as usize;
    let mut product = 1.0_f64;
    for i in 0..samples {
        let p = a + (b - a) * ((i as f64 + 0.5) / samples as f64);
        if map.is_blocked(p) {
            return 0.0;
        }
        let value = map.grid().at(p).copied().unwrap_or(0.0);
        product *= f64::from(value).powf(length / samples as f64);
    }
    product
}

/// The usual approximation: an f32 product with one power at the end (it underflows on long rays).
#[allow(clippy::disallowed_methods)]
fn product(map: &BlurredMap, (a, b): Ray) -> f64 {
    let length = (b - a).norm();
    let samples = (length / map.frame().resolution).ceil() as usize;
    let mut product = 1.0_f32;
    for i in 0..samples {
        let p = a + (b - a) * ((i as f64 + 0.5) / samples as f64);
        if map.is_blocked(p) {
            return 0.0;
        }
        product *= map.grid().at(p).copied().unwrap_or(0.0);
    }
    f64::from(product).powf(length / samples as f64)
}

/// Returns ∫ ln B ds in f64, cell by cell between the grid lines that the segment crosses.
fn exact(map: &BlurredMap, (a, b): Ray) -> f64 {
    let frame = map.frame();
    let mut cuts = vec![0.0, 1.0];
    for (from, to, origin) in [(a.x, b.x, frame.origin.x), (a.y, b.y, frame.origin.y)] {
        for line in 0..=SIDE {
            let t = (origin + line as f64 * frame.resolution - from) / (to - from);
            if t > 0.0 && t < 1.0 {
                cuts.push(t);
            }
        }
    }
    cuts.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for pair in cuts.windows(2) {
        let middle = a + (b - a) * f64::midpoint(pair[0], pair[1]);
        if map.is_blocked(middle) {
            return 0.0;
        }
        let value = map.grid().at(middle).copied().unwrap_or(0.0);
        sum += math::ln(f64::from(value)) * (pair[1] - pair[0]);
    }
    math::exp(sum * (b - a).norm())
}

/// Returns the best time of many repetitions (s) for one pass over the rays.
fn best(rays: &[Ray], repetitions: usize, query: impl Fn(Ray) -> f64) -> f64 {
    let mut fastest = f64::INFINITY;
    for _ in 0..repetitions {
        let start = Instant::now();
        let mut sum = 0.0;
        for &ray in rays {
            sum += query(ray);
        }
        black_box(sum);
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    fastest
}

fn table(map: &BlurredMap, field: &VisibilityField, name: &str, rays: &[Ray]) {
    let blocked = rays
        .iter()
        .filter(|&&(a, b)| !field.is_visible(a, b))
        .count();
    let samples: f64 = rays.iter().map(|&(a, b)| (b - a).norm() / RESOLUTION).sum();
    let worst = rays
        .iter()
        .map(|&(a, b)| (field.visibility(a, b) - exact(map, (a, b))).abs())
        .fold(0.0, f64::max);
    println!(
        "{name}: {:.0} % blocked, {:.0} cells long on average; largest error {worst:.1e}",
        100.0 * blocked as f64 / rays.len() as f64,
        samples / rays.len() as f64,
    );
    let baseline = best(rays, 5, |ray| literal(map, ray));
    let rows = [
        ("literal f64 powf", baseline),
        (
            "f32 product, one powf",
            best(rays, 20, |ray| product(map, ray)),
        ),
        (
            "VisibilityField f64",
            best(rays, 200, |(a, b)| field.visibility(a, b)),
        ),
        (
            "VisibilityField is_visible",
            best(rays, 200, |(a, b)| field.is_visible(a, b).into()),
        ),
    ];
    for (method, time) in rows {
        println!(
            "  {method:<28} {:8.2} M rays/s  {:6.1} ×",
            rays.len() as f64 / time / 1e6,
            baseline / time
        );
    }
}

fn benches(c: &mut Criterion) {
    let map = BlurredMap::new(&streets(), BLUR).expect("the synthetic map is valid");
    let field = VisibilityField::new(&map);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let random = random_pairs(&field, &mut rng);
    let visible = visible_pairs(&field, &mut rng);
    table(&map, &field, "random pairs", &random);
    table(&map, &field, "visible pairs", &visible);

    let mut group = c.benchmark_group("visibility");
    group.throughput(Throughput::Elements(RAYS as u64));
    group.bench_function("random/literal", |b| {
        b.iter(|| random.iter().map(|&ray| literal(&map, ray)).sum::<f64>());
    });
    for (name, rays) in [("random", &random), ("visible", &visible)] {
        group.bench_function(format!("{name}/field"), |b| {
            b.iter(|| {
                rays.iter()
                    .map(|&(p, q)| field.visibility(p, q))
                    .sum::<f64>()
            });
        });
    }
    group.finish();

    let free = streets();
    let mut group = c.benchmark_group("map");
    group.bench_function("blur 384 x 384", |b| {
        b.iter(|| BlurredMap::new(&free, BLUR));
    });
    group.bench_function("tables 384 x 384", |b| {
        b.iter(|| VisibilityField::new(&map));
    });
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
