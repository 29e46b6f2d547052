use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::cat::{CatModulus, CatRecovery};
use super::chebyshev::ChebyshevRecovery;
use chaotic_maps::chebyshev::Emission;
use chaotic_maps::key::{Key, KeyKind};
use chaotic_maps::{AnySource, Source as _};

/// Noise of the observer (side of the square).
const NOISES: [f64; 3] = [0.0, 0.002, 0.02];
const KEYS: u64 = 20;

fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    ((rng.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

fn noisy(point: [f64; 2], sd: f64, rng: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = sd * (-2.0 * libm::log(uniform(rng))).sqrt();
    let angle = core::f64::consts::TAU * uniform(rng);
    [
        point[0] + radius * libm::cos(angle),
        point[1] + radius * libm::sin(angle),
    ]
}

/// Returns the number of observations until the state of a cat map is recovered; asserts that it is
/// right.
fn observations_of_cat(modulus: CatModulus, mut source: AnySource, sd: f64, seed: u64) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut recovery = CatRecovery::new(modulus);
    for count in 1..=300 {
        recovery.observe(noisy(source.next_unit(), sd, &mut rng));
        if let Some(state) = recovery.state() {
            let mut predicted = state.clone();
            for _ in 0..1000 {
                assert_eq!(predicted.next_unit(), source.next_unit());
            }
            return count;
        }
    }
    panic!("not recovered within 300 observations, noise {sd}, key {seed}");
}

fn cat_is_recovered(kind: KeyKind, modulus: CatModulus, most: usize) {
    for sd in NOISES {
        let counts: Vec<_> = (0..KEYS)
            .map(|seed| {
                let mut source = Key::from_seed(kind, seed).source().unwrap();
                if let AnySource::CatF64(map) = &mut source {
                    while map.grid().is_none() {
                        map.step();
                    }
                }
                observations_of_cat(modulus, source, sd, seed)
            })
            .collect();
        assert!(
            counts.iter().all(|&count| count < most),
            "noise {sd}: {counts:?}"
        );
    }
}

#[test]
fn the_prime_cat_map_is_recovered_from_fewer_than_105_points() {
    cat_is_recovered(KeyKind::CatP, CatModulus::Prime, 105);
}

#[test]
fn the_wrapping_cat_map_is_recovered_from_fewer_than_105_points() {
    cat_is_recovered(KeyKind::Cat64, CatModulus::Wrapping64, 105);
}

#[test]
fn the_paper_s_cat_map_is_recovered_from_fewer_than_85_points_on_its_grid() {
    cat_is_recovered(KeyKind::CatF64, CatModulus::F64, 85);
}

#[test]
fn the_paper_s_own_key_is_recovered_within_a_lap() {
    let source = "catf64:0.4,0.644".parse::<Key>().unwrap().source().unwrap();
    assert!(observations_of_cat(CatModulus::F64, source, 0.02, 1) < 105);
}

/// Returns the number of observations until the state of a Chebyshev map is recovered, with noise
/// `sd` in units of [−1, 1]; asserts that it is right.
fn observations_of_chebyshev(emission: Emission, sd: f64, seed: u64) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut source = Key::from_seed(KeyKind::ChebP(emission), seed)
        .source()
        .unwrap();
    let mut recovery = ChebyshevRecovery::with_noise(emission, sd.max(0.02));
    for count in 1..=300 {
        recovery.observe(noisy(source.next_symmetric(), sd, &mut rng));
        if let Some(state) = recovery.state() {
            let mut predicted = state.clone();
            for _ in 0..1000 {
                let (expected, actual) = (predicted.next_symmetric(), source.next_symmetric());
                // The state is known up to sign, which the cosine's last bits may show.
                assert!(
                    (0..2).all(|axis| (expected[axis] - actual[axis]).abs() < 1e-12),
                    "wrong after {count} observations, noise {sd}, key {seed}"
                );
            }
            return count;
        }
    }
    panic!("not recovered within 300 observations, noise {sd}, key {seed}");
}

#[test]
fn the_chebyshev_map_is_recovered_from_fewer_than_30_points() {
    for sd in NOISES {
        let counts: Vec<_> = (0..KEYS)
            .map(|seed| observations_of_chebyshev(Emission::Arcsine, sd, seed))
            .collect();
        assert!(
            counts.iter().all(|&count| count < 30),
            "noise {sd}: {counts:?}"
        );
    }
}

#[test]
fn more_noise_or_raw_points_take_more_points_but_make_no_claim_wrong() {
    for (emission, sd) in [
        (Emission::Arcsine, 0.04),
        (Emission::Raw, 0.002),
        (Emission::Raw, 0.02),
    ] {
        let counts: Vec<_> = (0..KEYS)
            .map(|seed| observations_of_chebyshev(emission, sd, seed))
            .collect();
        assert!(
            counts.iter().all(|&count| count < 70),
            "noise {sd}: {counts:?}"
        );
    }
}

#[test]
fn no_state_is_recovered_from_a_keyed_stream() {
    for seed in 0..2 {
        let mut source = Key::from_seed(KeyKind::Keyed, seed).source().unwrap();
        let mut cats =
            [CatModulus::F64, CatModulus::Wrapping64, CatModulus::Prime].map(CatRecovery::new);
        let mut chebyshevs = [Emission::Arcsine, Emission::Raw].map(ChebyshevRecovery::new);
        for _ in 0..5000 {
            let point = source.next_unit();
            for cat in &mut cats {
                cat.observe(point);
                assert!(cat.state().is_none());
            }
            for chebyshev in &mut chebyshevs {
                chebyshev.observe(point.map(|c| 2.0 * c - 1.0));
                assert!(chebyshev.state().is_none());
            }
        }
    }
}

/// Two sources one after the other, for one observer.
fn after_a_change(mut observe: impl FnMut([f64; 2]) -> bool, kind: KeyKind, claimed_within: usize) {
    for seed in [1, 2] {
        let mut source = Key::from_seed(kind, seed).source().unwrap();
        let mut claimed = false;
        for _ in 0..claimed_within {
            claimed = observe(source.next_unit());
        }
        assert!(claimed);
    }
    // No recovery from here on.
    let mut keyed = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
    let claims: Vec<_> = (0..200).map(|_| observe(keyed.next_unit())).collect();
    assert!(claims[20..].iter().all(|claimed| !claimed));
}

#[test]
fn a_claim_is_given_up_when_the_points_no_longer_agree() {
    let mut cat = CatRecovery::new(CatModulus::Prime);
    after_a_change(
        |point| {
            cat.observe(point);
            cat.state().is_some()
        },
        KeyKind::CatP,
        130,
    );
    let emission = Emission::Arcsine;
    let mut chebyshev = ChebyshevRecovery::new(emission);
    after_a_change(
        |point| {
            chebyshev.observe(point.map(|c| 2.0 * c - 1.0));
            chebyshev.state().is_some()
        },
        KeyKind::ChebP(emission),
        60,
    );
}

#[test]
fn points_that_are_missing_cost_nothing_before_a_claim_nor_after_it() {
    let mut source = Key::from_seed(KeyKind::Cat64, 9).source().unwrap();
    let mut recovery = CatRecovery::new(CatModulus::Wrapping64);
    let mut claimed_at = None;
    for count in 1..=300 {
        let point = source.next_unit();
        if matches!(count, 20 | 40..=43 | 60 | 62 | 65 | 250) {
            recovery.gap();
        } else if count == 220 {
            // An error of the sensor.
            recovery.observe([point[0] + 0.5, point[1]]);
        } else if count == 240 {
            recovery.observe([f64::NAN, point[1]]);
        } else {
            recovery.observe(point);
        }
        if recovery.state().is_some() {
            claimed_at.get_or_insert(count);
        }
        assert_eq!(recovery.state().is_some(), claimed_at.is_some());
    }
    assert!(claimed_at.is_some_and(|at| at < 100), "{claimed_at:?}");
    assert_eq!(
        recovery.state().unwrap().clone().next_unit(),
        source.next_unit()
    );

    let emission = Emission::Arcsine;
    let mut source = Key::from_seed(KeyKind::ChebP(emission), 9)
        .source()
        .unwrap();
    let mut recovery = ChebyshevRecovery::new(emission);
    for count in 1..=100 {
        let point = source.next_symmetric();
        if matches!(count, 9 | 16 | 80) {
            recovery.gap();
        } else {
            recovery.observe(point);
        }
        assert_eq!(recovery.state().is_some(), count >= 29, "{count}");
    }
    assert_eq!(
        recovery.state().unwrap().clone().next_symmetric(),
        source.next_symmetric()
    );
}

#[test]
fn too_many_missing_points_start_the_collection_over() {
    let mut source = Key::from_seed(KeyKind::Cat64, 9).source().unwrap();
    let mut recovery = CatRecovery::new(CatModulus::Wrapping64);
    let mut claimed_at = None;
    for count in 1..=300 {
        let point = source.next_unit();
        if (51..=60).contains(&count) {
            recovery.gap();
        } else {
            recovery.observe(point);
        }
        if recovery.state().is_some() {
            claimed_at.get_or_insert(count);
        }
    }
    assert_eq!(claimed_at, Some(60 + 94));
}

#[test]
fn an_error_of_the_sensor_before_the_claim_delays_it_only() {
    let mut source = Key::from_seed(KeyKind::CatP, 4).source().unwrap();
    let mut cat = CatRecovery::new(CatModulus::Prime);
    let mut chebyshev_source = Key::from_seed(KeyKind::ChebP(Emission::Arcsine), 4)
        .source()
        .unwrap();
    let mut chebyshev = ChebyshevRecovery::new(Emission::Arcsine);
    for count in 0..150 {
        let ([x, y], [u, v]) = (source.next_unit(), chebyshev_source.next_symmetric());
        let error = if count == 10 { 0.2 } else { 0.0 };
        cat.observe([x + error, y]);
        chebyshev.observe([u, v - error]);
    }
    assert_eq!(cat.state().unwrap().clone().next_unit(), source.next_unit());
    assert!(chebyshev.state().is_some());
}

#[test]
fn too_much_noise_gives_no_claim() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut source = Key::from_seed(KeyKind::CatP, 1).source().unwrap();
    let mut cat = CatRecovery::new(CatModulus::Prime);
    let mut chebyshev_source = Key::from_seed(KeyKind::ChebP(Emission::Arcsine), 1)
        .source()
        .unwrap();
    let mut chebyshev = ChebyshevRecovery::new(Emission::Arcsine);
    for _ in 0..1000 {
        cat.observe(noisy(source.next_unit(), 0.2, &mut rng));
        chebyshev.observe(noisy(chebyshev_source.next_symmetric(), 0.2, &mut rng));
        assert!(cat.state().is_none() && chebyshev.state().is_none());
    }
}
