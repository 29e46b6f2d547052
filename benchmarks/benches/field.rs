//! Cost of the field velocity of one robot in one tick, in the paper's city.
//!
//! Baseline: the same sum (goals, four repulsors, obstacle gradient) in the chasing-game paper's
//! published Python took 0.064 ms of CPU with 1 goal and 0.389 ms with 30.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;

use avoidance::potential_field::{
    Goal, RepulsionParams, Repulsor, attraction, capped, obstacle, repulsion,
};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{Point2, Vector2};
use navigation::bearing::Bearings;
use navigation::routes::{NavGrid, RouteFinder, RouteTree, Threat};
use parameters::Fidelity;
use planner_view::map::PlannerMap;
use testing::{Arena, EXIT, RADIUS};

const POLICE: [(f64, f64); 4] = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)];

fn velocity(
    map: &PlannerMap,
    at: Point2<f64>,
    goals: &[Goal],
    bearings: &Bearings,
) -> Vector2<f64> {
    let repulsors = POLICE.map(|(x, y)| Repulsor {
        at: Point2::new(x, y),
        weight: 0.5,
    });
    let goal = attraction(at, goals.iter().copied(), bearings);
    let scatter = repulsion(
        at,
        repulsors,
        &Bearings::Straight,
        &RepulsionParams::default(),
    );
    capped(goal + scatter + obstacle(map, at, Fidelity::Ours), 2.0)
}

fn field(criterion: &mut Criterion) {
    println!("baseline, paper's Python: 64 us with 1 goal, 389 us with 30 goals");
    let map = Arena::city().map();
    let here = Point2::new(7.45, 4.4);
    let mut finder = RouteFinder::default();
    finder.prepare(&map, RADIUS);
    let routes = finder
        .routes(&map, 0, here, [Point2::new(-7.5, 7.5)])
        .expect("room for the robot");
    let mut group = criterion.benchmark_group("field_velocity");
    for count in [1, 30, 200] {
        let goals: Vec<Goal> = (0..count)
            .map(|i| {
                let along = f64::from(i) * 0.02;
                Goal {
                    at: Point2::new(-4.5 + along, 7.5 - 0.1 * along),
                    weight: 1.0,
                }
            })
            .collect();
        for (name, bearings) in [
            ("straight", Bearings::Straight),
            ("geodesic", Bearings::Along(routes)),
        ] {
            group.bench_with_input(BenchmarkId::new(name, count), &goals, |bencher, goals| {
                bencher.iter(|| velocity(&map, black_box(here), black_box(goals), &bearings));
            });
        }
    }
    group.finish();
}

fn routes(criterion: &mut Criterion) {
    let map = Arena::city().map();
    let mut group = criterion.benchmark_group("routes");
    group.bench_function("nav_grid", |bencher| {
        bencher.iter(|| NavGrid::new(black_box(&map), RADIUS));
    });
    let grid = NavGrid::new(&map, RADIUS);
    let root = grid
        .node_at(Point2::new(-4.5, 7.5))
        .expect("room for the robot");
    let exit = grid.node_at(EXIT).expect("room for the robot");
    let mut tree = RouteTree::default();
    group.bench_function("way_to_exit", |bencher| {
        bencher.iter(|| {
            tree.plant(&grid, black_box(root));
            tree.reach(&grid, exit);
            tree.gate(&map, &grid, exit)
        });
    });
    let threats = POLICE.map(|(x, y)| Threat {
        at: Point2::new(x, y),
        gain: 3.0,
        reach: 1.5,
    });
    group.bench_function("way_to_exit_past_4_police", |bencher| {
        bencher.iter(|| {
            tree.plant_without_gates(&grid, &[black_box(exit)], &threats);
            tree.reach(&grid, root)
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = field, routes
}
criterion_main!(benches);
