use super::*;
use proptest::prelude::*;

#[test]
fn six_is_a_primitive_root() {
    // No power (P − 1)/q is 1 for a prime factor q of P − 1, found by trial division.
    let mut rest = P - 1;
    let mut q = 2;
    let mut factors = Vec::new();
    while q * q <= rest {
        if rest.is_multiple_of(q) {
            factors.push(q);
            while rest.is_multiple_of(q) {
                rest /= q;
            }
        }
        q += 1;
    }
    if rest > 1 {
        factors.push(rest);
    }
    assert_eq!(pow(6, P - 1), 1);
    for q in factors {
        assert_ne!(pow(6, (P - 1) / q), 1, "divided by {q}");
    }
}

#[test]
fn the_points_repeat_after_half_the_period_of_the_state() {
    let start = ChebP::new(
        123_456_789_012_345_678,
        987_654_321_098_765_432,
        Emission::Raw,
    )
    .unwrap();
    let mut half = start;
    half.advance((P - 1) / 2);
    assert_eq!(half.state(), (P - start.state().0, P - start.state().1));
    assert!(
        half.point()
            .iter()
            .zip(start.point())
            .all(|(a, b)| (a - b).abs() < 1e-12)
    );
}

#[test]
fn emissions_are_views_of_one_orbit() {
    let key = (123_456_789_012_345_678, 987_654_321_098_765_432);
    let of = |emission| ChebP::new(key.0, key.1, emission).unwrap();
    let (mut raw, mut arcsine) = (of(Emission::Raw), of(Emission::Arcsine));
    for _ in 0..1000 {
        let (r, s) = (raw.next_symmetric(), arcsine.next_symmetric());
        for axis in 0..2 {
            assert!((libm::sin(s[axis] / FRAC_2_PI) - r[axis]).abs() < 1e-14);
            assert!((-1.0..=1.0).contains(&r[axis]) && (-1.0..=1.0).contains(&s[axis]));
        }
    }
    let f64_of = |emission| ChebF64::new(0.1, 0.2, emission).unwrap();
    let (mut raw, mut arcsine) = (f64_of(Emission::Raw), f64_of(Emission::Arcsine));
    for _ in 0..1000 {
        let (r, s) = (raw.next_symmetric(), arcsine.next_symmetric());
        for axis in 0..2 {
            assert_eq!(s[axis], FRAC_2_PI * libm::asin(r[axis]));
        }
    }
}

#[test]
fn the_paper_form_starts_with_its_polynomial() {
    // T6(0.1) = 32·10⁻⁶ − 48·10⁻⁴ + 18·10⁻² − 1.
    let mut map = ChebF64::new(0.1, 0.2, Emission::Raw).unwrap();
    let [x, y] = map.next_symmetric();
    assert!((x - -0.824_768).abs() < 1e-14);
    assert!(
        (y - (32.0 * 0.2_f64.powi(6) - 48.0 * 0.2_f64.powi(4) + 18.0 * 0.04 - 1.0)).abs() < 1e-14
    );
}

#[test]
fn close_starts_part_at_index_eleven() {
    // Coverage paper, Fig. 6: x1 = 0.10000 and y1 = 0.10001 (index 1 is the start).
    let mut map = ChebF64::new(0.1, 0.10001, Emission::Raw).unwrap();
    let first = (2..100).find(|_| {
        let [x, y] = map.next_symmetric();
        (x - y).abs() > 0.5
    });
    assert_eq!(first, Some(11));
}

#[test]
fn the_triangular_wave_in_f64_collapses_which_the_exact_map_does_not() {
    let (mut u, mut collapsed) = (0.1_f64, false);
    for _ in 0..100 {
        // Folds 6 half-waves into [0, 1].
        let wave = (6.0 * u).rem_euclid(2.0);
        u = if wave > 1.0 { 2.0 - wave } else { wave };
        collapsed |= u == 1.0 || u == 0.0;
    }
    assert!(collapsed);
    let mut map = ChebP::new(1, 2, Emission::Arcsine).unwrap();
    map.advance(100);
    assert!((0..10_000).all(|_| map.next_symmetric().iter().all(|c| c.abs() < 1.0)));
}

#[test]
fn degenerate_keys_are_refused() {
    for (tx, ty) in [(0, 1), (1, 0), (P, 1), (1, u64::MAX)] {
        assert!(matches!(
            ChebP::new(tx, ty, Emission::Raw),
            Err(KeyError::OutOfRange { .. })
        ));
    }
    for ty in [5, P - 5] {
        assert!(matches!(
            ChebP::new(5, ty, Emission::Raw),
            Err(KeyError::Linked { .. })
        ));
    }
    for special in [
        0.0,
        0.5,
        -0.5,
        0.866_025_403_784_438_6,
        -0.866_025_403_7,
        1.0,
        -1.0,
        5e-10,
    ] {
        let error = ChebF64::new(0.1, special, Emission::Arcsine);
        assert!(
            matches!(error, Err(KeyError::FixedPoint { name: "y", .. })),
            "{special}"
        );
    }
    for (x, y) in [(0.1, 0.1), (0.1, -0.1), (0.1, 0.100_000_000_1)] {
        assert!(matches!(
            ChebF64::new(x, y, Emission::Arcsine),
            Err(KeyError::Linked { .. })
        ));
    }
    for bad in [f64::NAN, 1.1, f64::NEG_INFINITY] {
        assert!(matches!(
            ChebF64::new(bad, 0.1, Emission::Arcsine),
            Err(KeyError::OutOfRange { name: "x", .. })
        ));
    }
}

proptest! {
    #[test]
    fn jumping_ahead_is_stepping(tx in 1..P, ty in 1..P, steps in 0_u64..300) {
        prop_assume!(tx != ty && tx != P - ty);
        let mut jumped = ChebP::new(tx, ty, Emission::Arcsine).unwrap();
        let mut walked = jumped;
        jumped.advance(steps);
        for _ in 0..steps {
            walked.step();
        }
        prop_assert_eq!(jumped, walked);
    }

    #[test]
    fn a_step_is_the_polynomial_of_degree_six(tx in 1..P, ty in 1..P) {
        prop_assume!(tx != ty && tx != P - ty);
        let mut map = ChebP::new(tx, ty, Emission::Raw).unwrap();
        let before = map.point();
        let after = map.next_symmetric();
        for (x, image) in before.into_iter().zip(after) {
            let s = x * x;
            prop_assert!((((32.0 * s - 48.0) * s + 18.0) * s - 1.0 - image).abs() < 1e-12);
        }
    }
}
