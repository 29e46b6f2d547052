//! Steps, scans and clearances in the city, against parry2d without an index.
//!
//! `cargo bench -p benchmarks --bench world` prints Criterion's figures, then one line per ratio,
//! measured alternately in the same run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use core::f64::consts::PI;
use core::hint::black_box;
use core::time::Duration;
use std::path::Path;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use geometry::blur::BlurredMap;
use geometry::grid::Grid;
use geometry::map::{MapSpec, UnknownCells, WorldMap};
use geometry::pose::{Pose2, Twist2};
use geometry::visibility::VisibilityField;
use nalgebra::{Point2, Vector2};
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::{PointQuery, Ray, RayCast};
use parry2d_f64::shape::Compound;
use robot::spec::{RobotSpec, ScanSpec};
use robot::team::Role;
use sim_backend::random::Stream;
use sim_backend::spec::{CaptureSpec, RulesSpec, WorldSpec};
use sim_backend::world::World;

const DT: Duration = Duration::from_millis(50);
const STARTS: [(f64, f64, f64); 6] = [
    (7.5, 4.5, PI),
    (7.5, 1.5, PI),
    (7.5, -1.5, PI),
    (7.5, -4.5, PI),
    (-4.5, 7.5, 0.0),
    (-4.5, -7.5, 0.0),
];

fn city() -> MapSpec {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/maps/city.toml");
    let file = MapSpec::File {
        path,
        unknown: UnknownCells::default(),
    };
    file.load(Path::new(""))
        .expect("the city is part of the repository")
}

fn world() -> World {
    let robots = STARTS.iter().enumerate().map(|(i, &(x, y, theta))| {
        let role = if i < 4 { Role::Pursuer } else { Role::Evader };
        let mut robot = RobotSpec::new(&format!("robot_{i}"), role, Pose2::new(x, y, theta));
        robot.limits.v_max = Some(0.5);
        robot.limits.v_reverse_max = Some(0.5);
        robot.scan = Some(ScanSpec {
            noise: 0.0,
            ..ScanSpec::default()
        });
        robot
    });
    World::new(WorldSpec {
        map: city(),
        robots: robots.collect(),
        rules: RulesSpec {
            capture: Some(CaptureSpec::default()),
            ..RulesSpec::default()
        },
        seed: 1,
    })
    .expect("the chase's set-up")
}

/// Returns commands that keep the robots in their streets: back and forth, with small turns.
fn in_streets() -> Vec<[Option<Twist2>; 6]> {
    (0..160)
        .map(|k| {
            let v = if k < 80 { 0.3 } else { -0.3 };
            let omega = if k % 20 < 10 { 0.2 } else { -0.2 };
            [Some(Twist2::new(v, omega)); 6]
        })
        .collect()
}

/// Returns random commands, with which the robots often hit walls.
fn random_commands() -> Vec<[Option<Twist2>; 6]> {
    let mut random = Stream::new(1, 0, 0);
    let mut command = || Some(Twist2::new(random.uniform() * 0.5, random.uniform() - 0.5));
    (0..4096)
        .map(|_| core::array::from_fn(|_| command()))
        .collect()
}

fn random_points(map: &WorldMap, count: usize) -> Vec<Point2<f64>> {
    let mut random = Stream::new(2, 0, 0);
    let mut points = Vec::with_capacity(count);
    while points.len() < count {
        let p = Point2::new(random.uniform() * 16.0 - 8.0, random.uniform() * 16.0 - 8.0);
        if map.is_clear(p, 0.105) {
            points.push(p);
        }
    }
    points
}

fn field(map: &WorldMap) -> VisibilityField {
    let occupancy = map.occupancy();
    let cells = occupancy.cells.iter().map(|o| !o).collect();
    let free = Grid {
        frame: occupancy.frame,
        cells,
    };
    VisibilityField::new(&BlurredMap::new(&free, 0.19).expect("a map of sensible size"))
}

/// Steps, each with 4 × 2 soft lines of sight.
fn step_with_sight(world: &mut World, sight: &VisibilityField, commands: &[Option<Twist2>]) -> f64 {
    world.step(commands, DT);
    let robots = world.robots();
    let mut sum = 0.0;
    for police in &robots[..4] {
        for evader in &robots[4..] {
            sum += sight.visibility(police.pose.position(), evader.pose.position());
        }
    }
    sum
}

/// Steps, each with 4 × 2 exact lines of sight.
fn step_with_hard_sight(world: &mut World, commands: &[Option<Twist2>]) -> usize {
    world.step(commands, DT);
    (0..4)
        .flat_map(|p| [(p, 4), (p, 5)])
        .filter(|&(p, e)| world.sees(p, e))
        .count()
}

/// The map as plain parry2d shapes, without grid, index and special cases.
struct ByParry {
    compound: Compound,
}

impl ByParry {
    fn new(map: &WorldMap) -> Self {
        let parts = map.parts().iter().map(geometry::shape::Convex::to_parry);
        Self {
            compound: Compound::new(parts.collect()),
        }
    }

    fn distance(&self, p: Point2<f64>) -> f64 {
        self.compound
            .distance_to_point(&Pose::IDENTITY, Vector::new(p.x, p.y), true)
    }

    fn ray(&self, p: Point2<f64>, dir: Vector2<f64>, range: f64) -> Option<f64> {
        let ray = Ray::new(Vector::new(p.x, p.y), Vector::new(dir.x, dir.y));
        self.compound.cast_ray(&Pose::IDENTITY, &ray, range, true)
    }
}

fn criterion(c: &mut Criterion) {
    let mut group = c.benchmark_group("world");
    group.throughput(Throughput::Elements(1)).sample_size(30);
    let sight = field(world().map());
    for (name, commands) in [
        ("in_streets", in_streets()),
        ("into_walls", random_commands()),
    ] {
        let (mut w, mut k) = (world(), 0);
        group.bench_function(format!("step_6_robots/{name}"), |b| {
            b.iter(|| {
                k = (k + 1) % commands.len();
                w.step(&commands[k], DT).len()
            });
        });
    }
    let (mut w, mut k, commands) = (world(), 0, in_streets());
    group.bench_function("step_6_robots/with_8_soft_sights", |b| {
        b.iter(|| {
            k = (k + 1) % commands.len();
            step_with_sight(&mut w, &sight, &commands[k])
        });
    });
    let (mut w, mut k) = (world(), 0);
    group.bench_function("step_6_robots/with_8_exact_sights", |b| {
        b.iter(|| {
            k = (k + 1) % commands.len();
            step_with_hard_sight(&mut w, &commands[k])
        });
    });
    group.throughput(Throughput::Elements(360));
    let w = world();
    let mut ranges = Vec::new();
    group.bench_function("scan_360_beams", |b| {
        let mut robot = 0;
        b.iter(|| {
            robot = (robot + 1) % 6;
            w.scan(robot, &mut ranges);
            ranges.len()
        });
    });
    group.throughput(Throughput::Elements(1));
    let spec = city();
    group
        .sample_size(10)
        .bench_function("build_city_grids", |b| b.iter(|| WorldMap::new(&spec)));
    group.finish();
}

/// Returns calls per second of the first and of the second function, measured alternately.
fn compare<A, B>(
    name: &str,
    unit: &str,
    mut ours: impl FnMut() -> A,
    mut theirs: impl FnMut() -> B,
) {
    let measure = |f: &mut dyn FnMut()| {
        let (start, mut calls) = (Instant::now(), 0u64);
        while start.elapsed() < Duration::from_millis(60) {
            for _ in 0..256 {
                f();
            }
            calls += 256;
        }
        calls as f64 / start.elapsed().as_secs_f64()
    };
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for _ in 0..9 {
        a.push(measure(&mut || drop(black_box(ours()))));
        b.push(measure(&mut || drop(black_box(theirs()))));
    }
    a.sort_by(f64::total_cmp);
    b.sort_by(f64::total_cmp);
    println!(
        "{name}: ours {:.3} M/s, parry2d compound {:.3} M/s, ratio {:.1}  [{unit}, medians of 9]",
        a[4] / 1e6,
        b[4] / 1e6,
        a[4] / b[4]
    );
}

fn ratios() {
    let map = WorldMap::new(&city()).expect("the city");
    let parry = ByParry::new(&map);
    let points = random_points(&map, 4096);
    let mut random = Stream::new(3, 0, 0);
    let rays: Vec<_> = points
        .iter()
        .map(|&p| {
            let (sin, cos) = geometry::math::sincos(random.uniform() * 2.0 * PI);
            (p, Vector2::new(cos, sin))
        })
        .collect();
    let next = |k: &mut usize| {
        *k = (*k + 1) % 4096;
        *k
    };
    let (mut i, mut j) = (0, 0);
    compare(
        "clearance look-up against exact distance",
        "free points of the city",
        || map.clearance_at_least(points[next(&mut i)]),
        || parry.distance(points[next(&mut j)]),
    );
    let (mut i, mut j) = (0, 0);
    compare(
        "exact distance",
        "free points of the city",
        || map.distance(points[next(&mut i)]),
        || parry.distance(points[next(&mut j)]),
    );
    let (mut i, mut j) = (0, 0);
    compare(
        "exact ray of 3.5 m",
        "random rays in the city",
        || {
            let (p, dir) = rays[next(&mut i)];
            map.cast_ray(p, dir, 3.5)
        },
        || {
            let (p, dir) = rays[next(&mut j)];
            parry.ray(p, dir, 3.5)
        },
    );
}

fn main() {
    let mut c = Criterion::default().configure_from_args();
    criterion(&mut c);
    c.final_summary();
    ratios();
}
