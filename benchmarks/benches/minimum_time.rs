//! Cost of minimum-time plans, by method, on random problems: from corner to corner, among many
//! large discs, and with obstacles that have appeared.
//!
//! Baseline: the exact shortest path alone (`tangent`), with which every method begins. For a
//! comparison with FATROP and IPOPT see `benchmarks/collocation_baseline`, with Drake's graphs of
//! convex sets `benchmarks/drake_baseline.py`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;

use ::plan::Recipe;
use criterion::{Criterion, criterion_group, criterion_main};
use trajectory::{Method, Options, Problem, plan};

/// Seeds of the problems of a recipe.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=8;

fn problems(recipe: &str) -> Vec<Problem> {
    let recipe = Recipe::by_name(recipe).expect("it is one of the names");
    SEEDS
        .map(|seed| recipe.instance(seed.to_string(), seed).problem())
        .collect()
}

fn minimum_time(criterion: &mut Criterion) {
    for recipe in ["base", "dense", "t4b"] {
        let problems = problems(recipe);
        let mut group = criterion.benchmark_group(format!("minimum time/{recipe}"));
        group.sample_size(20);
        for method in Method::ALL {
            let options = Options {
                method,
                ..Options::default()
            };
            // All problems in turn, so that a measurement covers the recipe.
            let mut next = problems.iter().cycle();
            group.bench_function(method.name(), |bencher| {
                bencher.iter(|| {
                    let problem = black_box(next.next().expect("it goes round"));
                    plan(problem, &options, None, &mut || false)
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, minimum_time);
criterion_main!(benches);
