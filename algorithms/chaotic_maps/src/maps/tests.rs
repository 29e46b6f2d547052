use super::*;

/// Asserts that every point lies in the range, and that the first axis is spread over all tenths of
/// it.
fn points_fill(mut source: impl Source, tenths: usize) {
    let mut seen = [[false; 10]; 2];
    for _ in 0..20_000 {
        for (axis, c) in source.next_unit().into_iter().enumerate() {
            assert!((0.0..=1.0).contains(&c), "{c}");
            seen[axis][((c * 10.0) as usize).min(9)] = true;
        }
        assert!(
            source
                .next_symmetric()
                .iter()
                .all(|c| (-1.0..=1.0).contains(c))
        );
    }
    for axis in seen {
        assert!(
            axis.iter().filter(|&&tenth| tenth).count() >= tenths,
            "{axis:?}"
        );
    }
}

#[test]
fn points_stay_in_range_and_fill_it() {
    for emission in [Emission::Raw, Emission::Arcsine] {
        points_fill(Logistic::new(0.1, 0.2, emission).unwrap(), 10);
    }
    points_fill(Standard::new(0.1, 0.2, Standard::K).unwrap(), 10);
}

#[test]
fn first_steps_are_those_of_the_formulas() {
    let [x, y] = Logistic::new(0.1, 0.2, Emission::Raw).unwrap().next_unit();
    assert!((x - 0.36).abs() < 1e-15 && (y - 0.64).abs() < 1e-15);
    let [x, _] = Logistic::new(0.1, 0.2, Emission::Arcsine)
        .unwrap()
        .next_unit();
    assert!((libm::sin(x / FRAC_2_PI).powi(2) - 0.36).abs() < 1e-15);
    // θ = π/2, so p' = p + 7 and θ' = θ + p'.
    let [x, y] = Standard::new(0.25, 0.2, 7.0).unwrap().next_unit();
    let p = 0.2 + 7.0 / TAU;
    assert!((y - p.fract()).abs() < 1e-14 && (x - (0.25 + p).fract()).abs() < 1e-14);
}

#[test]
fn degenerate_keys_are_refused() {
    let emission = Emission::Arcsine;
    for special in [0.0, 0.25, 0.5, 0.75, 1.0] {
        assert!(matches!(
            Logistic::new(special, 0.2, emission),
            Err(KeyError::FixedPoint { name: "x", .. })
        ));
    }
    for y in [0.1, 0.9] {
        assert!(matches!(
            Logistic::new(0.1, y, emission),
            Err(KeyError::Linked { .. })
        ));
    }
    assert!(matches!(
        Standard::new(0.5, 0.0, 7.0),
        Err(KeyError::FixedPoint { .. })
    ));
    assert!(matches!(
        Standard::new(0.1, 0.2, 0.5),
        Err(KeyError::OutOfRange { name: "k", .. })
    ));
    for bad in [f64::NAN, -0.1, 1.5] {
        assert!(Logistic::new(bad, 0.2, emission).is_err());
        assert!(Standard::new(bad, 0.2, 7.0).is_err());
        assert!(Standard::new(0.1, 0.2, -bad).is_err());
    }
}
