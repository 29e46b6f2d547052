//! Time to plan a lap: the octagon of the cat-map patrol paper's case 1, 120 waypoints.
//!
//! `cargo run --release -p patrol --example lap_cost [KEY]…`, keys as in `catp:0.4,0.644`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use chaotic_maps::{Key, KeyKind};
use nalgebra::Point2;
use patrol::awg::{Awg, AwgParams, Preset};
use patrol::contour::Contour;
use patrol::danger::DangerZones;

const LAPS: u32 = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut keys: Vec<Key> = std::env::args()
        .skip(1)
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    if keys.is_empty() {
        let kinds = [
            KeyKind::CatP,
            KeyKind::Cat64,
            KeyKind::CatF64,
            KeyKind::Keyed,
        ];
        keys.extend(kinds.map(|kind| Key::from_seed(kind, 1)));
    }
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
    let contour = Contour::closed(&corners)?;
    let params = AwgParams {
        t_max: 120.0,
        alpha: 1.7,
        mode: Preset::Default.mode(),
    };
    let awg = Awg::new(&contour, &DangerZones::default(), params)?;
    for key in keys {
        let mut source = key.source()?;
        let mut waypoints = Vec::new();
        let began = Instant::now();
        for lap in 0..LAPS {
            waypoints.clear();
            awg.lap_into(lap, &mut source, &mut waypoints);
            black_box(&waypoints);
        }
        let each = began.elapsed().as_secs_f64() * 1e6 / f64::from(LAPS);
        println!("{each:6.2} us for {} waypoints, {key}", waypoints.len());
    }
    Ok(())
}
