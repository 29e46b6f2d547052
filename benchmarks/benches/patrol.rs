//! Cost of planning a patrol: a lap of 120 waypoints (case 1 of the cat-map patrol paper) with each
//! kind of generator, compared with the generator's steps alone; and the choice of the zig-zag's
//! width.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::time::Duration;

use chaotic_maps::{Key, KeyKind, Source as _};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Point2;
use patrol::alpha::{LAPS, alpha_max};
use patrol::awg::{Awg, AwgParams, Preset};
use patrol::contour::Contour;
use patrol::danger::DangerZones;

const KINDS: [KeyKind; 4] = [
    KeyKind::CatP,
    KeyKind::Cat64,
    KeyKind::CatF64,
    KeyKind::Keyed,
];

fn octagon() -> Awg {
    let corners = [
        (5, 0),
        (0, 5),
        (0, 10),
        (5, 15),
        (10, 15),
        (15, 10),
        (15, 5),
        (10, 0),
    ];
    let corners = corners.map(|(x, y)| Point2::new(f64::from(x), f64::from(y)));
    let contour = Contour::closed(&corners).expect("a contour");
    let params = AwgParams {
        t_max: 120.0,
        alpha: 1.7,
        mode: Preset::Default.mode(),
    };
    Awg::new(&contour, &DangerZones::default(), params).expect("a zig-zag")
}

fn laps(criterion: &mut Criterion) {
    let awg = octagon();
    let mut group = criterion.benchmark_group("lap");
    group.throughput(Throughput::Elements(awg.waypoints_per_lap()));
    for kind in KINDS {
        let key = Key::from_seed(kind, 1);
        let mut source = key.source().expect("a sound key");
        let mut waypoints = Vec::new();
        group.bench_function(BenchmarkId::new("planned", kind), |b| {
            b.iter(|| {
                waypoints.clear();
                awg.lap_into(0, &mut source, &mut waypoints);
                black_box(waypoints.len())
            });
        });
        group.bench_function(BenchmarkId::new("steps alone", kind), |b| {
            b.iter(|| {
                for _ in 0..awg.steps_per_lap() {
                    black_box(source.next_unit());
                }
            });
        });
    }
    group.finish();
}

fn width(criterion: &mut Criterion) {
    let awg = octagon();
    let key = Key::from_seed(KeyKind::CatP, 1);
    criterion.bench_function("alpha_max", |b| {
        b.iter(|| {
            let mut source = key.source().expect("a sound key");
            alpha_max(&awg, 1.0, LAPS, &mut source).expect("a width")
        });
    });
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(20);
    targets = laps, width
}
criterion_main!(all);
