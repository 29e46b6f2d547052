//! The per-cell memo against exact rays, in the chasing game's city with four observers.

use nalgebra::Point2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sim_backend::blur::{BlurredMap, PAPER_SIGMA};
use sim_backend::grid::{Grid, GridFrame};
use sim_backend::pose::Pose2;
use tracking::memo::VisibilityMemo;
use tracking::params::SensorParams;
use tracking::space::Space;
use tracking::watch::Watch;

/// 25 blocks of 2 m in streets of 1 m, an outer wall with an exit, on 300 × 300 cells.
fn city() -> Space {
    let frame = GridFrame {
        width: 300,
        height: 300,
        resolution: 19.0 / 300.0,
        origin: Point2::new(-9.5, -9.5),
    };
    let near_block = |c: f64| (0..5).any(|i| (c - (f64::from(i) * 3.0 - 6.0)).abs() <= 1.0);
    let mut free = Grid::filled(frame, true);
    for row in 0..frame.height {
        for col in 0..frame.width {
            let p = frame.center(col, row);
            let out = p.x.abs().max(p.y.abs());
            let ring = out > 8.0 && out < 9.0 && !(p.x > 8.0 && p.y.abs() < 1.25);
            free.cells[frame.index(col, row)] = !(ring || (near_block(p.x) && near_block(p.y)));
        }
    }
    Space::new(&BlurredMap::new(&free, PAPER_SIGMA).unwrap())
}

struct Errors {
    largest: f64,
    mean: f64,
    wrong_shadow: usize,
}

fn compare(space: &Space, sensor: &SensorParams, observers: &[Pose2], seed: u64) -> Errors {
    let mut watch = Watch::new(sensor);
    watch.set(space.field(), observers);
    let mut memo = VisibilityMemo::default();
    memo.clear(space);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut errors = Errors {
        largest: 0.0,
        mean: 0.0,
        wrong_shadow: 0,
    };
    let n = 100_000;
    for _ in 0..n {
        let (x, y) = (
            rng.random_range(-9.6..9.6_f32),
            rng.random_range(-9.6..9.6_f32),
        );
        let p = Point2::new(f64::from(x), f64::from(y));
        let found = memo.visibility(space, &watch, x, y);
        assert_eq!(found.is_some(), space.is_valid(p), "{p}");
        let found = f64::from(found.unwrap_or(0.0));
        let exact = watch.best(space.field(), p).map_or(0.0, |(v, _)| v);
        errors.wrong_shadow += usize::from((found > 0.0) != (exact > 0.0));
        errors.largest = errors.largest.max((found - exact).abs());
        errors.mean += (found - exact).abs() / f64::from(n);
    }
    errors
}

#[test]
fn the_memo_agrees_with_exact_rays() {
    let space = city();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for seed in 0..4 {
        let observers: Vec<_> = (0..4)
            .map(|_| {
                loop {
                    let p = Pose2::new(
                        rng.random_range(-8.0..8.0),
                        rng.random_range(-8.0..8.0),
                        0.0,
                    );
                    if space.is_valid(p.position()) {
                        return p;
                    }
                }
            })
            .collect();
        let e = compare(&space, &SensorParams::default(), &observers, seed);
        assert!(e.largest < 0.02, "largest error {}", e.largest);
        assert!(e.mean < 5e-5, "mean error {}", e.mean);
        assert_eq!(e.wrong_shadow, 0);
    }
}

#[test]
fn the_memo_keeps_the_edges_of_range_and_field_of_view() {
    let space = city();
    let sensor = SensorParams {
        range: Some(4.0),
        field_of_view: Some(1.5),
        ..SensorParams::default()
    };
    let observers = [Pose2::new(-1.5, 1.5, 0.3), Pose2::new(7.5, -4.5, 2.0)];
    let e = compare(&space, &sensor, &observers, 9);
    // A circle may cut into a cell between two corners.
    assert!(e.wrong_shadow <= 2, "{}", e.wrong_shadow);
    assert!(e.mean < 1e-4, "{}", e.mean);
}

#[test]
fn a_cleared_memo_follows_observers_and_map() {
    let space = city();
    let mut memo = VisibilityMemo::default();
    let mut watch = Watch::new(&SensorParams::default());
    for x in [-7.5, 1.5, 7.5] {
        watch.set(space.field(), &[Pose2::new(x, 1.5, 0.0)]);
        memo.clear(&space);
        let v = memo.visibility(&space, &watch, 1.52, 4.5);
        let exact = watch.best(space.field(), Point2::new(f64::from(1.52_f32), 4.5));
        assert!((f64::from(v.unwrap()) - exact.map_or(0.0, |(v, _)| v)).abs() < 1e-3);
    }
    let small = GridFrame {
        width: 9,
        height: 5,
        resolution: 0.5,
        origin: Point2::new(0.0, 0.0),
    };
    let open = Space::new(&BlurredMap::new(&Grid::filled(small, true), 0.5).unwrap());
    watch.set(open.field(), &[Pose2::new(0.1, 0.1, 0.0)]);
    memo.clear(&open);
    for (x, y) in [(0.0, 0.0), (4.49, 2.49), (2.2, 1.1), (4.49, 0.0)] {
        assert!((memo.visibility(&open, &watch, x, y).unwrap() - 1.0).abs() < 1e-6);
    }
    assert_eq!(memo.visibility(&open, &watch, 4.51, 1.0), None);
}
