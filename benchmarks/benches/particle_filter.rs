//! Particle-filter updates per second against a straightforward version (f64, array of structs, one
//! random number after the other): `cargo bench -p benchmarks --bench particle_filter`.
//!
//! One update is predict + weigh + resample, on a 6 m × 6 m street grid of 384 × 384 cells with
//! four observers. "Seen" has σ = 0.1 m. "Unseen" is a belief two seconds after the opponent (0.6
//! m/s) was lost. A table is printed before Criterion's measurements: the best of several
//! repetitions (least affected by a busy machine).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/streets.rs"]
mod streets;

use std::collections::BTreeSet;
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use geometry::blur::BlurredMap;
use geometry::pose::Pose2;
use nalgebra::Point2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use streets::{BLUR, RESOLUTION, SIDE, streets};
use tracking::params::{FilterParams, SensorParams};
use tracking::particle_filter::{MotionLimits, ParticleFilter};
use tracking::sighting::{Measurement, Sighting};
use tracking::space::Space;
use tracking::watch::Watch;

const DT: f64 = 0.05;
const LIMITS: MotionLimits = MotionLimits {
    v_max: 0.6,
    v_reverse_max: 0.06,
    omega_max: 1.2,
};

struct Scene {
    map: BlurredMap,
    space: Space,
    watch: Watch,
    police: [Point2<f64>; 4],
    start: Pose2,
    seen: Sighting,
}

fn scene() -> Scene {
    let map = BlurredMap::new(&streets(), BLUR).expect("the synthetic map is valid");
    let space = Space::new(&map);
    let police =
        [(5.65, 0.35), (5.65, 3.0), (3.0, 5.65), (4.3, 1.7)].map(|(x, y)| Point2::new(x, y));
    let mut watch = Watch::new(&SensorParams::default());
    watch.set(space.field(), &police.map(|p| Pose2::new(p.x, p.y, 0.0)));
    let start = Pose2::new(1.65, 1.0, 1.57);
    let measurement = Measurement {
        position: start.position(),
        sigma: 0.1,
        heading: None,
    };
    let seen = Sighting {
        visibility: 0.9,
        observer: Some(0),
        measurement: Some(measurement),
    };
    Scene {
        map,
        space,
        watch,
        police,
        start,
        seen,
    }
}

/// Returns a filter after two seconds without a sighting.
fn lost(scene: &Scene, n: usize) -> ParticleFilter {
    let params = FilterParams {
        particles: n,
        ..FilterParams::default()
    };
    let rng = ChaCha8Rng::seed_from_u64(7);
    let mut filter = ParticleFilter::new(&params, LIMITS, Some(scene.start), &scene.space, rng);
    for _ in 0..40 {
        filter.update(&scene.space, &scene.watch, &Sighting::default(), DT);
    }
    filter
}

/// The straightforward version.
#[derive(Clone)]
struct Naive {
    particles: Vec<State>,
    rng: ChaCha8Rng,
}

#[derive(Clone, Copy)]
struct State {
    x: f64,
    y: f64,
    heading: f64,
    v: f64,
    omega: f64,
    weight: f64,
}

impl Naive {
    fn new(filter: &ParticleFilter) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let particles = filter
            .particles()
            .map(|p| State {
                x: p.x.into(),
                y: p.y.into(),
                heading: p.theta.into(),
                v: rng.random_range(-LIMITS.v_reverse_max..LIMITS.v_max),
                omega: rng.random_range(-LIMITS.omega_max..LIMITS.omega_max),
                weight: 1.0,
            })
            .collect();
        Self { particles, rng }
    }

    #[allow(clippy::disallowed_methods)] // The baseline is the straightforward version.
    fn update(&mut self, scene: &Scene, sighting: &Sighting) {
        for p in &mut self.particles {
            let (dv, domega) = (
                self.rng.random_range(-0.15..0.15),
                self.rng.random_range(-0.46..0.46),
            );
            p.v = (p.v + dv).clamp(-LIMITS.v_reverse_max, LIMITS.v_max);
            p.omega = (p.omega + domega).clamp(-LIMITS.omega_max, LIMITS.omega_max);
            p.x += p.v * DT * p.heading.cos();
            p.y += p.v * DT * p.heading.sin();
            p.heading += p.omega * DT;
            if self.rng.random_range(0.0..1.0) < 0.25 * DT {
                p.x += self.rng.random_range(-1.0..1.0);
                p.y += self.rng.random_range(-1.0..1.0);
                p.heading += self.rng.random_range(-0.5..0.5);
            }
            let at = Point2::new(p.x, p.y);
            p.weight = if scene.map.is_blocked(at) {
                0.0
            } else if let Some(m) = &sighting.measurement {
                let d = at - m.position;
                (-0.5 * d.norm_squared() / (m.sigma * m.sigma)).exp()
            } else {
                let seen = scene.police.iter().map(|&q| product(&scene.map, q, at));
                1.0 - seen.fold(0.0, f64::max)
            };
        }
        let total: f64 = self.particles.iter().map(|p| p.weight).sum();
        let step = total / self.particles.len() as f64;
        let mut pointer = self.rng.random_range(0.0..1.0) * step;
        let mut sum = self.particles[0].weight;
        let mut i = 0;
        let mut resampled = Vec::with_capacity(self.particles.len());
        for _ in 0..self.particles.len() {
            while sum < pointer && i + 1 < self.particles.len() {
                i += 1;
                sum += self.particles[i].weight;
            }
            resampled.push(self.particles[i]);
            pointer += step;
        }
        self.particles = resampled;
    }
}

/// Visibility as a product over one-cell steps, with early exit and one power at the end.
#[allow(clippy::disallowed_methods)]
fn product(map: &BlurredMap, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (values, occupied) = (&map.grid().cells, &map.occupied().cells);
    let length = (b - a).norm();
    let samples = (length / RESOLUTION).ceil();
    let step = (b - a) / (samples * RESOLUTION);
    let mut p = a / RESOLUTION + step * 0.5;
    let mut product = 1.0;
    for _ in 0..samples as usize {
        // Both ends are in the grid, whose corner is the origin.
        let cell = p.y as usize * SIDE + p.x as usize;
        if occupied[cell] {
            return 0.0;
        }
        product *= f64::from(values[cell]);
        p += step;
    }
    product.powf(length / samples)
}

/// Returns the best rate of several updates from the same belief (1/s).
fn rate<F: Clone>(filter: &F, n: usize, repetitions: usize, mut update: impl FnMut(&mut F)) -> f64 {
    let mut fastest = f64::INFINITY;
    for _ in 0..repetitions {
        let mut copy = filter.clone();
        // One unmeasured update: working memory and caches are then as in a running filter.
        update(&mut copy);
        let start = Instant::now();
        update(&mut copy);
        fastest = fastest.min(start.elapsed().as_secs_f64());
        black_box(copy);
    }
    n as f64 / fastest
}

fn table(scene: &Scene) {
    println!("million particles per second    n   naive   ours   ratio");
    let unseen = Sighting::default();
    for n in [1_000, 10_000, 100_000] {
        let filter = lost(scene, n);
        let cells: BTreeSet<_> = filter
            .particles()
            .map(|p| {
                scene
                    .map
                    .frame()
                    .cell_at(Point2::new(p.x.into(), p.y.into()))
            })
            .collect();
        let naive = Naive::new(&filter);
        let line = |name: &str, naive: f64, ours: f64| {
            println!(
                "  {name:<24} {n:>7} {:7.2} {:7.2} {:6.1} ×",
                naive / 1e6,
                ours / 1e6,
                ours / naive
            );
        };
        let base = rate(&naive, n, 10, |f| f.update(scene, &scene.seen));
        let ours = rate(&filter, n, 100, |f| {
            f.update(&scene.space, &scene.watch, &scene.seen, DT);
        });
        line("seen", base, ours);
        let base = rate(&naive, n, 2, |f| f.update(scene, &unseen));
        let ours = rate(&filter, n, 30, |f| {
            f.update(&scene.space, &scene.watch, &unseen, DT);
        });
        line("unseen, exact", base, ours);
        let start = Instant::now();
        black_box(filter.belief());
        println!(
            "  ({} cells occupied; summary {:.1} ns per particle)",
            cells.len(),
            start.elapsed().as_secs_f64() * 1e9 / n as f64
        );
    }
}

/// Returns the total time of updates that all begin with the same belief.
fn timed<F: Clone>(rounds: u64, filter: &F, mut update: impl FnMut(&mut F)) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..rounds {
        let mut copy = filter.clone();
        update(&mut copy);
        let start = Instant::now();
        update(&mut copy);
        total += start.elapsed();
    }
    total
}

fn benches(c: &mut Criterion) {
    let scene = scene();
    table(&scene);
    let n = 10_000;
    let filter = lost(&scene, n);
    let naive = Naive::new(&filter);
    let mut group = c.benchmark_group("particle filter, 10 000");
    group.throughput(Throughput::Elements(n as u64));
    for (name, sighting) in [("seen", scene.seen), ("unseen", Sighting::default())] {
        group.bench_function(format!("{name}/naive f64 structs"), |b| {
            b.iter_custom(|rounds| timed(rounds, &naive, |f| f.update(&scene, &sighting)));
        });
        group.bench_function(format!("{name}/arrays f32"), |b| {
            b.iter_custom(|rounds| {
                timed(rounds, &filter, |f| {
                    f.update(&scene.space, &scene.watch, &sighting, DT);
                })
            });
        });
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
