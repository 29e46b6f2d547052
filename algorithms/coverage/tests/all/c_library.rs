//! Coverage by the Chebyshev map in floating point, from 0.1 and 0.2, with the rounding of the C
//! library of most Linux machines: figures from an independent implementation.
//!
//! After some twenty steps the orbit depends on the last bits of cosine and arc cosine. Ours
//! ([`chaotic_maps::ChebF64`]) are those of `libm`, the same on every machine; the known figures were
//! computed with glibc's, which the standard library calls here.

#![expect(
    clippy::disallowed_methods,
    reason = "what depends on the machine is the point here"
)]

use metrics::coverage::{CELL_SIDES, CoverageDomain, Meter, Rectangle};
use nalgebra::Point2;

/// x after 1999 steps with the rounding of cosine and arc cosine of the known figures.
const FINGERPRINT: u64 = 0x3fe8_809c_de4d_dd14;

fn step(x: f64) -> f64 {
    (6.0 * x.clamp(-1.0, 1.0).acos()).cos()
}

/// The points after at least one step.
fn orbit(n: usize) -> Vec<[f64; 2]> {
    let mut state = [0.1_f64, 0.2_f64];
    (0..n)
        .map(|_| {
            state = state.map(step);
            state
        })
        .collect()
}

/// Points; length (m); goals at 0.5 m, path at 0.1, 0.25 and 0.5 m, disc.
type Row = (usize, f64, [f64; 5]);

fn check(rows: &[Row], emit: fn(f64) -> f64) {
    assert_eq!(CELL_SIDES, [0.1, 0.25, 0.5]);
    for &(n, length, rates) in rows {
        let bounds = Rectangle::new(Point2::new(0.0, 0.0), Point2::new(10.0, 10.0));
        let domain = CoverageDomain::new(bounds, 0.1, Vec::new()).unwrap();
        let mut meter = Meter::new(&domain, 0.125).unwrap();
        for point in orbit(n) {
            let [x, y] = point.map(|c| 5.0 + 4.9 * emit(c));
            meter.goal(Point2::new(x, y));
        }
        let f = meter.figures();
        // The lengths are known to within a metre.
        assert!((f.length - length).abs() <= 0.6, "{n}: {}", f.length);
        let found = [f.goals[2], f.path[0], f.path[1], f.path[2], f.disc];
        for (rate, expected) in found.into_iter().zip(rates) {
            let off = rate.covered as f64 - expected * rate.coverable as f64;
            assert!(
                off.abs() <= 2.0,
                "{n}: {rate:?} is {off} cells off {expected}"
            );
        }
    }
}

#[test]
fn the_orbit_of_the_c_library_covers_the_open_workplace_as_known() {
    let last = orbit(1999)[1998][0];
    if last.to_bits() != FINGERPRINT {
        eprintln!(
            "skipped: cosine and arc cosine are rounded otherwise here ({:#x})",
            last.to_bits()
        );
        return;
    }
    check(
        &[
            (200, 1007.0, [0.3925, 0.5036, 0.7700, 0.8975, 0.7294]),
            (1000, 5026.0, [0.9075, 0.8796, 0.9587, 0.9925, 0.9581]),
            (2000, 10_126.0, [0.9900, 0.9428, 0.9750, 1.0000, 0.9776]),
        ],
        |c| 2.0 * c.asin() / core::f64::consts::PI,
    );
    check(
        &[
            (200, 1240.0, [0.3600, 0.6269, 0.9331, 0.9925, 0.8913]),
            (1000, 6135.0, [0.8100, 0.9822, 0.9988, 1.0000, 0.9990]),
            (2000, 12_426.0, [0.9625, 0.9970, 0.9994, 1.0000, 0.9997]),
        ],
        |c| c,
    );
}
