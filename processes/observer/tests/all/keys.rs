//! Recovery of keys from poses: of the maps, and never of a keyed stream.

use chaotic_maps::{AnySource, Cat64, CatF64, CatP, ChebP, Emission, Key, Source};
use geometry::shape::Aabb;
use nalgebra::Point2;
use observer::knowledge::{CatKind, CatKnowledge, ChebyshevForm, ChebyshevKnowledge};
use observer::layout::{Layout, Slot};
use observer::predictors::Predictor;
use observer::predictors::key::{Finder, KeyHunter};
use testing::rectangle;

use crate::support::{ARRIVAL, NoisyObserver, Robot};

const GOAL_ERROR: f64 = 0.03;

/// The octagon of the cat-map patrol paper, case 1.
fn octagon(generator: CatKind) -> CatKnowledge {
    let contour = [
        [4.0, 0.0],
        [0.0, 4.0],
        [0.0, 9.0],
        [4.0, 13.0],
        [9.0, 13.0],
        [13.0, 9.0],
        [13.0, 4.0],
        [9.0, 0.0],
    ];
    CatKnowledge {
        contour: contour.to_vec(),
        t_max: 120.0,
        alpha: 1.7,
        generator,
        ..CatKnowledge::default()
    }
}

/// Returns the goals of a layout with a generator.
fn goals(layout: Layout, mut source: AnySource) -> impl Iterator<Item = Point2<f64>> {
    (0..).map(move |number| match layout.slot(number) {
        Slot::Fixed(point) => point,
        Slot::Drawn(frame) => frame.goal(source.next_unit()),
    })
}

struct Hunt {
    /// Number of goals that the robot had reached when the key was known.
    recovered_after: Option<usize>,
    /// Errors of the predictions 5 s ahead from then on (m).
    errors: Vec<f64>,
    made_out: u32,
}

/// Watches a robot from one number of reached goals to another.
fn hunt<F: Finder>(
    layout: &Layout,
    finder: F,
    source: AnySource,
    start: Point2<f64>,
    (sigma, heading_sigma): (f64, f64),
    (unseen, most): (usize, usize),
) -> Hunt {
    let mut robot = Robot::new(start, goals(layout.clone(), source));
    let mut noisy = NoisyObserver::new(sigma, heading_sigma, 7);
    let mut hunter = KeyHunter::new(layout.clone(), finder, ARRIVAL, GOAL_ERROR);
    let (mut recovered_after, mut errors) = (None, Vec::new());
    let mut pending: Vec<(u64, Point2<f64>)> = Vec::new();
    for tick in 0_u64.. {
        robot.tick();
        noisy.look(robot.pose, robot.reached.len() >= unseen, &mut hunter);
        if hunter.key_recovered() && recovered_after.is_none() {
            recovered_after = Some(robot.reached.len());
        }
        if let Some(at) = noisy.predict(&hunter, 5.0) {
            assert!(hunter.key_recovered());
            pending.push((tick + 100, at));
        }
        if let Some(k) = pending.iter().position(|(due, _)| *due == tick) {
            errors.push((pending.swap_remove(k).1 - robot.pose.position()).norm());
        }
        if robot.reached.len() >= most {
            break;
        }
    }
    Hunt {
        recovered_after,
        errors,
        made_out: hunter.goals_observed(),
    }
}

fn median(errors: &[f64]) -> f64 {
    metrics::prediction::ErrorStatistics::from_errors(errors).map_or(f64::NAN, |s| s.median)
}

#[test]
fn the_key_of_a_cat_map_is_recovered_within_a_lap_and_predicts_the_way() {
    for (kind, source) in [
        (
            CatKind::CatP,
            AnySource::CatP(
                CatP::new(3_689_348_814_741_910_313, 5_939_851_591_734_475_604).unwrap(),
            ),
        ),
        (
            CatKind::Cat64,
            AnySource::Cat64(Cat64::new(0x9e37_79b9_7f4a_7c15, 0xbf58_476d_1ce4_e5b9).unwrap()),
        ),
        (
            CatKind::CatF64,
            AnySource::CatF64(CatF64::new(0.4, 0.644).unwrap()),
        ),
    ] {
        for (noise, within) in [((0.0, 0.0), 120), ((0.01, 0.01), 120)] {
            let knowledge = octagon(kind);
            let layout = knowledge.layout().unwrap();
            assert_eq!(layout.round(), 120);
            let start = Point2::from(knowledge.contour[0]);
            let found = hunt(
                &layout,
                knowledge.finder(),
                source.clone(),
                start,
                noise,
                (0, 130),
            );
            let after = found.recovered_after;
            assert!(
                after.is_some_and(|after| after < within),
                "{kind:?} {noise:?} {after:?}"
            );
            assert!(median(&found.errors) < 0.6);
        }
    }
}

#[test]
fn the_key_of_chebyshev_maps_is_recovered_within_thirty_sub_goals() {
    let knowledge = ChebyshevKnowledge {
        form: ChebyshevForm::Arcsine,
        ..ChebyshevKnowledge::default()
    };
    let layout = ChebyshevKnowledge::layout_of_rectangle([0.1, 0.1, 9.9, 9.9]).unwrap();
    let state = (123_456_789_012_345_678, 987_654_321_098_765_432);
    let source = ChebP::new(state.0, state.1, Emission::Arcsine).unwrap();
    let start = Point2::new(5.0, 5.0);
    let found = hunt(
        &layout,
        knowledge.finder(),
        AnySource::ChebP(source),
        start,
        (0.01, 0.01),
        (0, 60),
    );
    let after = found.recovered_after;
    assert!(after.is_some_and(|after| after < 30), "{after:?}");
    assert!(median(&found.errors) < 0.6);
}

/// Returns the goals of a coverage around a block of 5 m by 5 m: four rectangles.
fn around_a_block(knowledge: &ChebyshevKnowledge, start: Point2<f64>) -> Layout {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let block = rectangle([5.0, 5.0], [2.5, 2.5]);
    let parts = block.parts().unwrap();
    knowledge.layout_of_map(bounds, &parts, 0.1, start).unwrap()
}

/// Returns the stretches of predictions with errors above `limit` (m); those less than 5 s apart are one.
fn stretches(errors: &[f64], limit: f64) -> Vec<std::ops::Range<usize>> {
    let mut found: Vec<std::ops::Range<usize>> = Vec::new();
    for (index, _) in errors.iter().enumerate().filter(|(_, e)| **e > limit) {
        match found.last_mut().filter(|last| index < last.end + 100) {
            Some(last) => last.end = index + 1,
            None => found.push(index..index + 1),
        }
    }
    found
}

#[test]
fn a_coverage_of_several_rectangles_is_predicted_although_none_is_told() {
    let knowledge = ChebyshevKnowledge::default();
    let start = Point2::new(1.0, 8.0);
    let layout = around_a_block(&knowledge, start);
    assert!(layout.round() > 200);
    // From the start, and by an observer that comes in the middle of a rectangle.
    for (unseen, most) in [(0, 300), (20, 450)] {
        let state = (123_456_789_012_345_678, 987_654_321_098_765_432);
        let source = ChebP::new(state.0, state.1, Emission::Arcsine).unwrap();
        let found = hunt(
            &layout,
            knowledge.finder(),
            AnySource::ChebP(source),
            start,
            (0.01, 0.01),
            (unseen, most),
        );
        let after = found.recovered_after;
        assert!(
            after.is_some_and(|after| after < unseen + 80),
            "unseen {unseen}: {after:?}"
        );
        // Goals of all rectangles and of the transits between them follow.
        assert!(median(&found.errors) < 0.6);
        // After a mistaken goal the observer looks for the robot elsewhere, until later goals set it right.
        let lost = stretches(&found.errors, 1.5);
        let longest = lost.iter().map(|s| s.end - s.start).max();
        assert!(longest.is_none_or(|ticks| ticks < 1600), "80 s: {lost:?}");
        let total: usize = lost.iter().map(|s| s.end - s.start).sum();
        assert!(10 * total < found.errors.len(), "{lost:?}");
        let last = lost.last().map_or(0, |stretch| stretch.end);
        assert!(last + 1600 < found.errors.len(), "{lost:?}");
    }
}

#[test]
fn a_keyed_stream_is_unpredictable() {
    let key: Key = "keyed:000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f"
        .parse()
        .unwrap();
    let cat = octagon(CatKind::CatP);
    let layout = cat.layout().unwrap();
    let start = Point2::from(cat.contour[0]);
    let found = hunt(
        &layout,
        cat.finder(),
        key.source().unwrap(),
        start,
        (0.0, 0.0),
        (0, 130),
    );
    assert_eq!(found.recovered_after, None);
    assert!(found.errors.is_empty() && found.made_out > 100);
    let chebyshev = ChebyshevKnowledge::default();
    let layout = ChebyshevKnowledge::layout_of_rectangle([0.0, 0.0, 10.0, 10.0]).unwrap();
    let found = hunt(
        &layout,
        chebyshev.finder(),
        key.source().unwrap(),
        start,
        (0.0, 0.0),
        (0, 60),
    );
    assert_eq!(found.recovered_after, None);
    assert!(found.made_out > 50);
}
