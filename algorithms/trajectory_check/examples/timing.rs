//! Duration of a check: 1000 samples among no obstacles, 40 discs, 40 rectangles.
//!
//! `cargo run --release -p trajectory_check --example timing`

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::time::Instant;

use nalgebra::{Point2, Vector2};
use trajectory_check::{Contract, Obstacle, Sample, check};

/// Drives a slalom through a field of obstacles; collisions do not matter here.
fn main() {
    let (v, dt) = (0.15, 0.04);
    let mut sample = Sample {
        t: 0.0,
        x: 0.0,
        y: 0.0,
        theta: 0.0,
        v,
        omega: 0.5,
    };
    let mut samples = vec![sample];
    for k in 1..1000 {
        let next = sample.theta + sample.omega * dt;
        let (sin, cos) = libm::sincos(f64::midpoint(sample.theta, next));
        let chord = v * dt * (1.0 - (sample.omega * dt / 2.0).powi(2) / 6.0);
        (sample.x, sample.y) = (sample.x + chord * cos, sample.y + chord * sin);
        (sample.t, sample.theta) = (dt * f64::from(k), next);
        samples.push(sample);
        if k % 50 == 25 {
            sample.omega = -sample.omega;
            samples.push(sample);
        }
    }
    let center = |k: u32| {
        Point2::new(
            f64::from(k) * 0.15,
            if k.is_multiple_of(2) { 0.33 } else { -0.25 },
        )
    };
    let discs = (0..40).map(|k| Obstacle::Disc {
        center: center(k),
        radius: 0.1,
    });
    let rectangles = (0..40).map(|k| Obstacle::Polygon {
        vertices: [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]
            .map(|corner| center(k) + Vector2::from(corner))
            .to_vec(),
    });
    for (name, obstacles) in [
        ("nothing", Vec::new()),
        ("discs", discs.collect()),
        ("rectangles", rectangles.collect()),
    ] {
        let mut contract = Contract::new([0.0; 3], [sample.x, sample.y], v, 2.0);
        contract.obstacles = obstacles;
        contract.clearance = 0.05;
        contract.bounds = Some([-10.0, -10.0, 10.0, 10.0]);
        println!("{name}: {}", check(&contract, &samples));
        println!(
            "  min_clearance {:.6} m",
            check(&contract, &samples).min_clearance
        );
        let rounds = 2000_u32;
        let begin = Instant::now();
        for _ in 0..rounds {
            black_box(check(black_box(&contract), black_box(&samples)));
        }
        let each = begin.elapsed() / rounds;
        println!("  {} samples: {each:?} a check", samples.len());
    }
}
