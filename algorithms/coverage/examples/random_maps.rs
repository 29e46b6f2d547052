//! Divides random maps, drives on them, and counts errors.
//!
//! `cargo run -p coverage --example random_maps [maps] [seed]`: 10 000 maps by default, of 1 to 12
//! obstacles.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Instant;

use coverage::decomposition::Decomposition;

use random_map::drive::drive;
use random_map::{RandomMaps, free_components};

#[path = "../tests/all/random_map/mod.rs"]
mod random_map;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let mut argument = |default| arguments.next().and_then(Result::ok).unwrap_or(default);
    let (count, seed) = (argument(10_000), argument(1));
    let mut maps = RandomMaps::new(seed);
    let mut taken = core::time::Duration::ZERO;
    let (mut full, mut stalls, mut connected, mut rectangles) = (0, 0, 0, 0);
    let (mut inexact, mut miscounted) = (0, 0);
    let (mut legs, mut collisions, mut missed) = (0, 0, 0);
    for (_, obstacles) in (0..count).zip([1, 2, 3, 5, 8, 12].into_iter().cycle()) {
        let workplace = maps.next_map(obstacles);
        let (area, components) = free_components(&workplace);
        let begun = Instant::now();
        let decomposition = Decomposition::new(&workplace);
        taken += begun.elapsed();
        let Ok(decomposition) = decomposition else {
            full += u64::from(area == 0.0);
            stalls += u64::from(area > 0.0);
            continue;
        };
        rectangles += decomposition.rectangles().len();
        connected += u64::from(components == 1);
        inexact += u64::from((decomposition.area() - area).abs() > 1e-9 * area);
        miscounted += u64::from(decomposition.components() != components);
        let driven = drive(&workplace, &decomposition, &mut maps, 1);
        legs += driven.legs;
        collisions += driven.collisions;
        missed += driven.missed;
    }
    println!("{count} maps (seed {seed}): {connected} connected, {full} without free space");
    println!("stalls {stalls}, areas not exact {inexact}, component counts wrong {miscounted}");
    println!("legs driven {legs}, collisions {collisions}, reachable rectangles missed {missed}");
    println!(
        "{rectangles} rectangles, {:.1} µs per map",
        taken.as_secs_f64() * 1e6 / count as f64
    );
}
