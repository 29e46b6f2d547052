//! Predictability of goals for an observer that does not know the method.

use chaotic_maps::{AnySource, Cat64, ChebP, Emission, Key, Source as _};
use metrics::prediction::{View, chance_median, chance_median_along, next_goal_errors};
use nalgebra::Point2;

const STRETCHES: usize = 12;

/// Median next-goal errors after 200, 1000 and 2000 goals, of points in the plane seen together and
/// of coordinates seen apart: means over several stretches of the sequence.
fn medians(mut source: AnySource) -> [[f64; 3]; 2] {
    let stretches: Vec<Vec<_>> = (0..STRETCHES)
        .map(|_| {
            (0..2060)
                .map(|_| Point2::from(source.next_symmetric()))
                .collect()
        })
        .collect();
    [View::Plane, View::PerAxis].map(|view| {
        [200, 1000, 2000].map(|n| {
            let median = |points: &Vec<Point2<f64>>| {
                let errors = next_goal_errors(&points[..n + 60], n, view).unwrap();
                match view {
                    View::Plane => errors.plane.median,
                    View::PerAxis => errors.per_axis.median,
                }
            };
            stretches.iter().map(median).sum::<f64>() / STRETCHES as f64
        })
    })
}

fn near(found: [f64; 3], expected: [f64; 3], factor: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            found < expected * factor && found > expected / factor,
            "{found} is not about {expected}"
        );
    }
}

#[test]
fn goals_of_maps_are_predictable_and_independent_goals_are_not() {
    let chebyshev = ChebP::new(
        123_456_789_012_345_678,
        987_654_321_098_765_432,
        Emission::Arcsine,
    );
    let [plane, axes] = medians(AnySource::ChebP(chebyshev.unwrap()));
    near(plane, [0.39, 0.17, 0.12], 1.4);
    near(axes, [0.021, 0.0036, 0.0020], 1.5);
    let cat = Cat64::new(0x9e37_79b9_7f4a_7c15, 0x0123_4567_89ab_cdef).unwrap();
    let [plane, axes] = medians(AnySource::Cat64(cat));
    near(plane, [0.11, 0.043, 0.033], 1.4);
    near(axes, [0.54, 0.56, 0.60], 1.2);
    let key: Key = "keyed:000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f"
        .parse()
        .unwrap();
    let [plane, axes] = medians(key.source().unwrap());
    near(plane, [1.07; 3], 1.12);
    near(axes, [0.60; 3], 1.12);
    // Result of chance, without any sequence.
    assert!((chance_median(2.0, 2.0) - 1.024).abs() < 0.001);
    assert!((chance_median_along(2.0) - 0.586).abs() < 0.001);
}
