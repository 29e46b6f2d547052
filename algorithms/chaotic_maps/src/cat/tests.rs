use super::*;
use proptest::prelude::*;

#[test]
fn both_halves_step_from_the_old_state() {
    let mut map = CatP::new(P - 1, 3).unwrap();
    map.step();
    // (P − 1 + 3, P − 1 + 6) modulo P.
    assert_eq!(map.state(), (2, 5));
    let mut map = Cat64::new(u64::MAX, 3).unwrap();
    map.step();
    assert_eq!(map.state(), (2, 5));
}

#[test]
fn the_prime_map_has_the_full_period_for_every_key() {
    // The order of the matrix divides P + 1, but no (P + 1)/q for a prime q that divides P + 1: so
    // no orbit is shorter. (The map has no eigenvalue in the field, so all orbits are alike.)
    let factors = prime_factors(P + 1);
    for (a, b) in [(1, 0), (0, 1), (123_456_789, 987_654_321), (P - 1, P - 1)] {
        let start = CatP::new(a, b).unwrap();
        let after = |steps| {
            let mut map = start;
            map.advance(steps);
            map
        };
        assert_eq!(after(P + 1), start);
        for &q in &factors {
            assert_ne!(after((P + 1) / q), start, "divided by {q}");
        }
    }
}

fn prime_factors(mut n: u64) -> Vec<u64> {
    let mut factors = Vec::new();
    let mut q = 2;
    while q * q <= n {
        if n.is_multiple_of(q) {
            factors.push(q);
            while n.is_multiple_of(q) {
                n /= q;
            }
        }
        q += 1;
    }
    if n > 1 {
        factors.push(n);
    }
    factors
}

#[test]
fn the_period_modulo_two_to_the_k_is_three_quarters_of_it() {
    for bits in [2_u32, 3, 4, 5, 7, 10, 51, 53, 64] {
        let mask = u64::MAX >> (64 - bits);
        let order = period_modulo_power_of_two(bits);
        assert_eq!(u128::from(order), 3 << (bits - 2));
        // The matrix is the identity when it is so for both unit vectors.
        let identity = |steps: u64| {
            [(1, 0), (0, 1)].into_iter().all(|unit| {
                let (a, b) = advance_wrapping(unit, steps);
                (a & mask, b & mask) == unit
            })
        };
        assert!(identity(order), "{bits} bits");
        assert!(!identity(order / 3), "{bits} bits");
        assert!(!identity(order / 2), "{bits} bits");
    }
}

#[test]
fn every_odd_state_has_the_period_of_the_matrix() {
    for bits in [2_u32, 5, 8] {
        let mask = (1_u64 << bits) - 1;
        for a in 0..=mask {
            for b in 0..=mask {
                if (a | b) & 1 == 0 {
                    continue;
                }
                let start = (a, b);
                let mut steps = 0_u64;
                let (mut a, mut b) = start;
                loop {
                    (a, b) = ((a + b) & mask, (a + 2 * b) & mask);
                    steps += 1;
                    if (a, b) == start {
                        break;
                    }
                }
                assert_eq!(steps, period_modulo_power_of_two(bits), "{start:?}");
            }
        }
    }
}

/// Period of the cat map modulo `m`.
fn period(start: (u64, u64), m: u64) -> u64 {
    let (mut a, mut b) = start;
    let mut steps = 0;
    loop {
        (a, b) = ((a + b) % m, (a + 2 * b) % m);
        steps += 1;
        if (a, b) == start {
            return steps;
        }
    }
}

#[test]
fn short_decimal_keys_are_periodic_in_exact_arithmetic() {
    // The key of the paper, (0.4, 0.644) = (100, 161)/250.
    assert_eq!(period((100, 161), 250), 750);
    assert_eq!(period((400, 644), 1000), 750);
    // The matrix's order is the period of a unit vector (a prime power apart, its maximum).
    assert_eq!(period((0, 1), 10_000), 7_500);
    assert_eq!(period((0, 1), 100_000), 75_000);
    assert_eq!(period((0, 1), 1_000_000), 750_000);
}

#[test]
fn the_paper_form_starts_as_the_paper_s_figure_does() {
    // Fig. 5: segment (1, 4) → (5, 1), α = 2, v = 0.5; the waypoints follow from the outputs.
    let mut map = CatF64::new(0.4, 0.644).unwrap();
    let expected = [
        (1.696, 3.948),
        (2.8752, 2.3936),
        (2.5296, 3.0328),
        (3.5136, 1.6048),
    ];
    for (j, (qx, qy)) in expected.into_iter().enumerate() {
        let [x, y] = map.next_unit();
        let along = 0.5 * (j + 1) as f64 + 2.0 * x;
        let across = 2.0 * (y - 0.5);
        assert!((1.0 + 0.8 * along + 0.6 * across - qx).abs() < 1e-9);
        assert!((4.0 - 0.6 * along + 0.8 * across - qy).abs() < 1e-9);
    }
}

#[test]
fn in_f64_the_orbit_is_the_integer_map_of_51_bits() {
    let mut map = CatF64::new(0.4, 0.644).unwrap();
    assert_eq!(map.grid(), None);
    map.step();
    let mask = (1_u64 << 51) - 1;
    let (mut a, mut b) = map.grid().unwrap();
    // One half is odd: the period is 3·2⁴⁹.
    assert_eq!((a | b) & 1, 1);
    for _ in 0..100_000 {
        map.step();
        (a, b) = ((a + b) & mask, (a + 2 * b) & mask);
        assert_eq!(map.grid(), Some((a, b)));
    }
}

#[test]
fn rounding_takes_the_paper_key_off_its_decimal_orbit_in_37_steps() {
    let mut map = CatF64::new(0.4, 0.644).unwrap();
    let (mut a, mut b) = (400_u64, 644_u64);
    let mut first = [None; 4];
    for step in 1..=40 {
        let [x, y] = map.next_unit();
        (a, b) = ((a + b) % 1000, (a + 2 * b) % 1000);
        let error = (x - a as f64 / 1000.0)
            .abs()
            .max((y - b as f64 / 1000.0).abs());
        for (first, bound) in first.iter_mut().zip([1e-12, 1e-6, 1e-2, 0.1]) {
            if error > bound {
                first.get_or_insert(step);
            }
        }
    }
    assert_eq!(first, [Some(11), Some(25), Some(35), Some(37)]);
}

#[test]
fn with_the_new_x_in_y_the_orbit_collapses_at_step_105() {
    let (mut x, mut y) = (0.4_f64, 0.644_f64);
    let mut collapse = None;
    for step in 1..=200 {
        x = x + y - (x + y).floor();
        y = x + 2.0 * y - (x + 2.0 * y).floor();
        if (x, y) == (0.0, 0.0) {
            collapse = Some(step);
            break;
        }
    }
    assert_eq!(collapse, Some(105));
    let mut map = CatF64::new(0.4, 0.644).unwrap();
    assert!((0..100_000).all(|_| map.next_unit() != [0.0, 0.0]));
}

#[test]
fn dyadic_keys_of_the_paper_form_are_refused_with_their_period() {
    for (x, y, expected) in [(0.5, 0.25, 3), (0.3125, 0.6875, 12), (0.5, 0.0, 3)] {
        assert!(
            matches!(CatF64::new(x, y), Err(KeyError::ShortPeriod { period, .. }) if period == expected)
        );
        let mut map = CatF64 { x, y };
        let mut steps = 0;
        while steps == 0 || map.state() != (x, y) {
            map.step();
            steps += 1;
        }
        assert_eq!(steps, expected);
    }
    // 31 bits are too few, 32 enough.
    let unit = 1.0 / f64::from(1_u32 << 31);
    assert!(CatF64::new(unit, 3.0 * unit).is_err());
    assert!(CatF64::new(0.5 * unit, 3.0 * unit).is_ok());
}

#[test]
fn degenerate_keys_are_refused() {
    assert!(matches!(CatP::new(0, 0), Err(KeyError::Zero { .. })));
    assert!(matches!(
        CatP::new(P, 1),
        Err(KeyError::OutOfRange { name: "a", .. })
    ));
    assert!(matches!(
        CatP::new(1, u64::MAX),
        Err(KeyError::OutOfRange { name: "b", .. })
    ));
    assert!(matches!(Cat64::new(0, 0), Err(KeyError::Zero { .. })));
    assert!(matches!(Cat64::new(2, 4), Err(KeyError::Even { .. })));
    assert!(matches!(CatF64::new(0.0, 0.0), Err(KeyError::Zero { .. })));
    for bad in [f64::NAN, -0.1, 1.0, f64::INFINITY] {
        assert!(matches!(
            CatF64::new(bad, 0.4),
            Err(KeyError::OutOfRange { name: "x", .. })
        ));
        assert!(matches!(
            CatF64::new(0.4, bad),
            Err(KeyError::OutOfRange { name: "y", .. })
        ));
    }
    assert!(CatF64::new(5e-324, 5e-324).is_ok());
}

proptest! {
    #[test]
    fn jumping_ahead_is_stepping(a in 0..P, b in 1..P, steps in 0_u64..300, x in 0.0..1.0_f64) {
        let mut jumped = CatP::new(a, b).unwrap();
        let mut walked = jumped;
        jumped.advance(steps);
        let (mut jumped64, mut walked64) = (Cat64::new(a, b | 1).unwrap(), Cat64::new(a, b | 1).unwrap());
        jumped64.advance(steps);
        let mut jumped_f64 = CatF64::new(x, 0.1).unwrap();
        let mut walked_f64 = jumped_f64;
        jumped_f64.advance(steps);
        for _ in 0..steps {
            walked.step();
            walked64.step();
            walked_f64.step();
        }
        prop_assert_eq!(jumped, walked);
        prop_assert_eq!(jumped64, walked64);
        prop_assert_eq!(jumped_f64, walked_f64);
    }

    #[test]
    fn stepping_back_undoes_a_step(a in 0..P, b in 1..P) {
        let start = CatP::new(a, b).unwrap();
        let mut map = start;
        map.step();
        map.step_back();
        prop_assert_eq!(map, start);
        let start = Cat64::new(a, b | 1).unwrap();
        let mut map = start;
        map.step();
        map.step_back();
        prop_assert_eq!(map, start);
    }

    #[test]
    fn outputs_are_the_top_53_bits(a in 0..P, b in 1..P) {
        let mut map = CatP::new(a, b).unwrap();
        let [x, y] = map.next_unit();
        prop_assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
        prop_assert_eq!((x * (1_u64 << 53) as f64) as u64, map.state().0 >> 10);
        prop_assert_eq!((y * (1_u64 << 53) as f64) as u64, map.state().1 >> 10);
    }
}
