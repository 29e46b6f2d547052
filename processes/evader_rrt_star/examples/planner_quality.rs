//! Convergence of the search to the shortest paths: `planner_quality [SEEDS [BUDGET_MS]]`.
//!
//! It prints one line per improvement, `planner,query,seed,cpu_ms,cost`, like
//! `benchmarks/ompl_baseline`, after the exact optima as `optimum,query,,,cost`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::sync::Arc;

use evader_rrt_star::bound::Bound;
use evader_rrt_star::collision_map::CollisionMap;
use evader_rrt_star::cost::CostModel;
use evader_rrt_star::motion::Straight;
use evader_rrt_star::params::{Algorithm, CostParams, SearchParams};
use evader_rrt_star::search::{Scene, Search};
use geometry::pose::Pose2;
use nalgebra::Point2;
use navigation::tangent_graph::{TangentGraph, Towards};
use rustix::time::{ClockId, clock_gettime};
use support::RADIUS;

/// From (x, y) to (x, y) (m).
const QUERIES: [[f64; 4]; 3] = [
    [-4.5, 7.5, 9.0, 0.0],
    [-7.5, -7.3, 7.3, 7.5],
    [1.5, -6.0, -6.0, 4.5],
];

/// Iterations between two readings of the clock.
const BETWEEN_LOOKS: u32 = 20;

/// CPU time of the process (ms).
fn cpu_ms() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

fn main() {
    let mut words = std::env::args().skip(1);
    let seeds = words.next().and_then(|w| w.parse().ok()).unwrap_or(21_u64);
    let budget_ms = words.next().and_then(|w| w.parse().ok()).unwrap_or(120.0);

    let mut collision_map = CollisionMap::new(&support::city(), RADIUS, 1);
    let cost = CostModel::new(CostParams::length(), Algorithm::Improved, 0.45);
    let Ok(graph) = TangentGraph::new(&collision_map.space, RADIUS) else {
        eprintln!("the city has no tangent graph");
        return;
    };
    println!("planner,query,seed,cpu_ms,cost");
    for (query, [x0, y0, x1, y1]) in QUERIES.into_iter().enumerate() {
        let (from, to) = (Point2::new(x0, y0), Point2::new(x1, y1));
        if let Some(optimum) = graph.distance(from, to) {
            println!("optimum,{query},,,{optimum:.9}");
        }
    }
    for (query, [x0, y0, x1, y1]) in QUERIES.into_iter().enumerate() {
        let goal = Point2::new(x1, y1);
        let towards: Vec<Arc<Towards>> = collision_map.towards(&[goal]);
        let scene = Scene {
            space: &collision_map.space,
            sampler: &collision_map.sampler,
            radius: RADIUS,
            cost: &cost,
            bodies: &[],
        };
        let root = Pose2::new(x0, y0, 0.0);
        for planner in ["ours", "ours_straight"] {
            for seed in 0..seeds {
                let mut search = Search::new(SearchParams::default(), Straight, seed);
                let bound = if planner == "ours" {
                    Bound::along_streets(root.position(), &towards)
                } else {
                    Bound::straight(root.position(), &[goal])
                };
                let begin = cpu_ms();
                search.plant(&scene, root, &[goal], bound);
                let mut best = f64::INFINITY;
                loop {
                    search.run(&scene, BETWEEN_LOOKS);
                    let ms = cpu_ms() - begin;
                    let found = search.way().last().map_or(f64::INFINITY, |end| end.cost);
                    if found < best {
                        best = found;
                        println!("{planner},{query},{seed},{ms:.4},{best:.9}");
                    }
                    if ms > budget_ms {
                        break;
                    }
                }
            }
        }
    }
}
