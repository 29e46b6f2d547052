//! Recovery of keys from robots that their real planners drive in the simulated world. They cut
//! corners, arrive within a tolerance, and pass goals straight ahead without a turn.

use chaotic_maps::{Emission, Key, KeyKind};
use observer::knowledge::{CatKind, CatKnowledge, ChebyshevKnowledge};

use crate::drive::{Found, OCTAGON, coverage, patrol, watch, workplace};
use geometry::shape::Shape;
use testing::rectangle;

const NOISE: f64 = 0.01;

fn patrol_watched(kind: KeyKind, seed: u64, unseen: impl Fn(f64) -> bool) -> Found {
    let knowledge = CatKnowledge {
        contour: OCTAGON.to_vec(),
        generator: CatKind::Cat64,
        ..CatKnowledge::default()
    };
    let layout = knowledge.layout().unwrap();
    let drive = patrol(1.0, (1.0, 5.2), &Key::from_seed(kind, seed).to_string());
    watch(
        drive,
        &layout,
        knowledge.finder(),
        (NOISE, seed),
        unseen,
        130,
    )
}

#[test]
fn the_key_of_a_patrol_is_recovered_within_its_first_lap() {
    for seed in [1, 2] {
        let found = patrol_watched(KeyKind::Cat64, seed, |_| false);
        let after = found.after;
        assert!(after.is_some_and(|after| after < 120), "{after:?}");
        assert!(!found.wrong && found.made_out > 0.5);
    }
}

#[test]
fn short_times_out_of_sight_do_not_hide_a_key() {
    let found = patrol_watched(KeyKind::Cat64, 3, |time| {
        (30.0..32.0).contains(&time) || (50.0..51.0).contains(&time)
    });
    let after = found.after;
    assert!(after.is_some_and(|after| after < 120), "{after:?}");
    assert!(!found.wrong);
}

fn coverage_watched(obstacles: &[Shape], start: [f64; 2], seed: u64) -> Found {
    let knowledge = ChebyshevKnowledge::default();
    let key = Key::from_seed(KeyKind::ChebP(Emission::Arcsine), seed);
    let drive = coverage(&workplace(obstacles, start), &key.to_string());
    let (layout, finder) = (drive.layout(&knowledge), knowledge.finder());
    watch(drive, &layout, finder, (NOISE, seed), |_| false, 60)
}

#[test]
fn the_key_of_a_coverage_is_recovered_within_thirty_sub_goals() {
    for seed in [1, 2, 3] {
        let found = coverage_watched(&[], [5.0, 5.0], seed);
        let after = found.after;
        assert!(after.is_some_and(|after| after < 30), "{after:?}");
        assert!(!found.wrong);
    }
}

#[test]
fn several_rectangles_do_not_hide_a_key_from_an_observer_that_knows_the_workplace() {
    let block = rectangle([5.0, 5.0], [2.5, 2.5]);
    for seed in [1, 2] {
        let found = coverage_watched(core::slice::from_ref(&block), [1.0, 8.0], seed);
        let after = found.after;
        assert!(after.is_some_and(|after| after < 40), "{after:?}");
        assert!(!found.wrong);
    }
}

#[test]
fn no_key_is_recovered_from_a_keyed_patrol() {
    let found = patrol_watched(KeyKind::Keyed, 1, |_| false);
    assert_eq!(found.after, None);
    assert!(found.made_out > 0.5, "{}", found.made_out);
}
