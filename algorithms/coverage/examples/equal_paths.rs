//! Disc coverage of the open workplace of 10 m by 10 m (r = 0.1 m) after equal lengths of path, for
//! the sources of the coverage papers: means over keys.
//!
//! `cargo run -p coverage --example equal_paths [keys]`: 30 keys by default.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use chaotic_maps::{Emission, Key, KeyKind, Source};
use coverage::plan::map;
use coverage::workplace::Workplace;
use geometry::shape::Aabb;
use metrics::coverage::Meter;
use nalgebra::Point2;

/// Lengths of path at which coverage is read (m).
const LENGTHS: [f64; 4] = [250.0, 500.0, 1000.0, 2000.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let keys = std::env::args().nth(1).map_or(Ok(30), |a| a.parse())?;
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    };
    let workplace = Workplace::from_parts(bounds, 0.1, &[], 0.1)?;
    let meter = Meter::new(&workplace.domain()?, 0.125)?;
    println!("source               250 m   500 m  1000 m  2000 m   CV (1000 m, cells of 0.5 m)");
    for (name, kind) in [
        ("Chebyshev raw", KeyKind::ChebP(Emission::Raw)),
        ("i.i.d. uniform", KeyKind::Keyed),
        ("Chebyshev arcsine", KeyKind::ChebP(Emission::Arcsine)),
        ("standard map K = 7", KeyKind::Standard),
        ("logistic arcsine", KeyKind::Logistic(Emission::Arcsine)),
        ("cat map", KeyKind::CatP),
    ] {
        let mut rates = [0.0; LENGTHS.len()];
        let mut variation = 0.0;
        for seed in 0..keys {
            let mut source = Key::from_seed(kind, seed).source()?;
            let mut meter = meter.clone();
            let mut goal = map(source.next_symmetric(), &workplace.inner());
            for (rate, length) in rates.iter_mut().zip(LENGTHS) {
                while meter.goal_within(goal, length) {
                    goal = map(source.next_symmetric(), &workplace.inner());
                }
                *rate += meter.disc().rate();
                if length == 1000.0 {
                    variation += meter.figures().variation[2];
                }
            }
        }
        let [a, b, c, d] = rates.map(|rate| rate / keys as f64);
        let variation = variation / keys as f64;
        println!("{name:20} {a:.3}   {b:.3}   {c:.3}   {d:.3}   {variation:.2}");
    }
    Ok(())
}
