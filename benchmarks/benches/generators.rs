//! Points per second of the generators, on one core: `cargo bench -p benchmarks --bench
//! generators`.
//!
//! A table is printed before Criterion's measurements: the best of many short repetitions (least
//! affected by a busy machine). Each kind of key is measured as a concrete type, which a planner
//! could choose at compile time, and as [`AnySource`], which dispatches at every step.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::time::Instant;

use chaotic_maps::{AnySource, Key, KeyKind, Source};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

const POINTS: u32 = 100_000;
const REPETITIONS: usize = 200;
const SEED: u64 = 1;

/// Returns the sum of the next points, so that none is optimised away.
fn run(source: &mut impl Source) -> [f64; 2] {
    (0..POINTS).fold([0.0; 2], |[x, y], _| {
        let [dx, dy] = source.next_unit();
        [x + dx, y + dy]
    })
}

/// Returns the best rate of the repetitions (points/s).
fn best_rate(source: &mut impl Source) -> f64 {
    let best = (0..REPETITIONS)
        .map(|_| {
            let start = Instant::now();
            black_box(run(source));
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    f64::from(POINTS) / best
}

/// Returns the best rate of the inner generator, without dispatch at every step.
fn best_rate_alone(source: AnySource) -> f64 {
    match source {
        AnySource::CatP(mut s) => best_rate(&mut s),
        AnySource::Cat64(mut s) => best_rate(&mut s),
        AnySource::CatF64(mut s) => best_rate(&mut s),
        AnySource::ChebP(mut s) => best_rate(&mut s),
        AnySource::ChebF64(mut s) => best_rate(&mut s),
        AnySource::Logistic(mut s) => best_rate(&mut s),
        AnySource::Standard(mut s) => best_rate(&mut s),
        AnySource::Keyed(mut s) => best_rate(s.as_mut()),
    }
}

fn source(kind: KeyKind) -> AnySource {
    Key::from_seed(kind, SEED)
        .source()
        .expect("keys from seeds are sound")
}

fn generators(c: &mut Criterion) {
    println!("{:<20} {:>14} {:>14}", "kind", "alone [M/s]", "any [M/s]");
    for kind in KeyKind::ALL {
        let (alone, any) = (best_rate_alone(source(kind)), best_rate(&mut source(kind)));
        let name = kind.to_string();
        println!("{name:<20} {:>14.1} {:>14.1}", alone / 1e6, any / 1e6);
    }
    let mut group = c.benchmark_group("generators");
    group.throughput(Throughput::Elements(u64::from(POINTS)));
    for kind in KeyKind::ALL {
        group.bench_function(kind.to_string(), |b| {
            b.iter_batched(
                || source(kind),
                |mut source| run(&mut source),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, generators);
criterion_main!(benches);
