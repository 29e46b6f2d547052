//! Cost of geodesic waves and of the referee's dominance regions, in the paper's city.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use geometry::region::Region;
use nalgebra::Point2;
use navigation::dominance::{Arena, Dominance, DominanceParams, Runner};
use navigation::wavefront::{Lattice, Medium, SIGHT, Source, Wave};
use planner_view::map::PlannerMap;
use testing::{EXIT, RADIUS};

const POLICE: [(f64, f64); 4] = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)];
const EVADERS: [(f64, f64); 2] = [(-4.5, 7.5), (-4.5, -7.5)];

fn medium(map: &PlannerMap, pitch: f64) -> Medium {
    Medium::new(map, Lattice::new(map, pitch, RADIUS), SIGHT)
}

fn waves(criterion: &mut Criterion) {
    let map = testing::Arena::city().map();
    let sources = |places: &[(f64, f64)]| -> Vec<Source> {
        let points = places.iter().map(|&(x, y)| Point2::new(x, y));
        points.map(|at| Source::new(at, 0.3, 0)).collect()
    };
    let mut group = criterion.benchmark_group("wave");
    for pitch in [0.1, 0.15, 0.2] {
        group.bench_with_input(
            BenchmarkId::new("lattice", pitch),
            &pitch,
            |bencher, &pitch| {
                bencher.iter(|| medium(black_box(&map), pitch));
            },
        );
        let medium = medium(&map, pitch);
        println!("pitch {pitch} m: {} free cells", medium.lattice().len());
        for (name, sources) in [
            ("one_robot", sources(&EVADERS[..1])),
            ("four_robots", sources(&POLICE)),
        ] {
            let mut wave = Wave::default();
            group.bench_with_input(
                BenchmarkId::new(name, pitch),
                &sources,
                |bencher, sources| {
                    bencher.iter(|| wave.spread(&medium, &map, black_box(sources), None));
                },
            );
        }
    }
    group.finish();
}

fn judgement(criterion: &mut Criterion) {
    let map = testing::Arena::city().map();
    let params = DominanceParams::default();
    let exit = Region::Circle {
        center: [EXIT.x, EXIT.y],
        radius: 0.5,
    };
    let arena = Arena::new(&map, &params, RADIUS, &[exit], 0.3);
    let runners = |places: &[(f64, f64)], speed: f64| -> Vec<Runner> {
        let points = places.iter().map(|&(x, y)| Point2::new(x, y));
        let runner = |at| Runner {
            at,
            speed,
            reach: 0.3,
        };
        points.map(runner).collect()
    };
    let (police, evaders) = (runners(&POLICE, 0.3), runners(&EVADERS, 0.45));
    let mut dominance = Dominance::default();
    criterion.bench_function("judge_4_police_2_evaders", |bencher| {
        bencher.iter(|| {
            let verdicts = dominance.assess(&map, &arena, black_box(&police), &evaders);
            verdicts.len()
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = waves, judgement
}
criterion_main!(benches);
