use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use core::slice::from_ref;

use proptest::prelude::*;

use super::*;

fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
    list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// A lap with a point every second.
fn lap(list: &[(f64, f64)]) -> Track {
    track(points(list))
}

fn track(path: Vec<Point2<f64>>) -> Track {
    let mut track = Track::default();
    for (second, point) in path.into_iter().enumerate() {
        track.push(second as f64, point);
    }
    track
}

#[test]
fn points_of_a_polyline_divide_its_length() {
    let path = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)]);
    let line = Polyline::new(&path);
    assert_eq!(line.length(), 4.0);
    assert_eq!(line.at(0.5).unwrap(), Point2::new(1.0, 1.0));
    assert_eq!(line.at(0.25).unwrap(), Point2::new(1.0, 0.0));
    assert_eq!(line.at(-1.0).unwrap(), path[0]);
    assert_eq!(line.at(2.0).unwrap(), path[2]);
}

#[test]
fn a_path_on_its_reference_strays_by_time_but_not_by_length() {
    let reference = points(&[(0.0, 0.0), (4.0, 0.0)]);
    // The same line, its legs of 1 m and 3 m taking the same time.
    let laps = [lap(&[(0.0, 0.0), (1.0, 0.0), (4.0, 0.0)])];
    assert_eq!(mae_lap(&reference, &laps, 4), Some(0.0));
    assert_eq!(mae_joint(&reference, &laps, 4), Some(0.0));
    // At 1, 2, 3, 4 m the robot is at 0.5, 1, 2.5, 4 m.
    assert_eq!(mae_time(&reference, &laps, 4), Some(0.5));
}

#[test]
fn a_detour_beside_the_reference_is_measured_by_hand() {
    let reference = points(&[(0.0, 0.0), (2.0, 0.0)]);
    let laps = [lap(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])];
    // At half the path 1 m off, at its end 0.
    assert_eq!(mae_lap(&reference, &laps, 2), Some(0.5));
    assert_eq!(mae_time(&reference, &laps, 2), Some(0.5));
    assert_eq!(speed(&laps[0], 2.0), Some(2f64.sqrt()));
    assert_eq!(andc(2, 4.0), Some(0.5));
}

#[test]
fn joint_laps_are_compared_with_as_many_laps_of_the_reference() {
    let there_and_back = [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0)];
    let reference = points(&there_and_back);
    let laps = [
        lap(&there_and_back),
        lap(&there_and_back),
        lap(&there_and_back),
    ];
    assert_eq!(joined(&laps).len(), 7);
    assert!(mae_joint(&reference, &laps, 10).unwrap() < 1e-15);
}

#[test]
fn turns_wrap_and_fold() {
    // Left by a right angle, then straight back, then left by 45 degrees.
    let path = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 0.0), (2.0, -1.0)]);
    let turns = Turns::from_path(&path);
    assert_eq!(turns.count, 3);
    assert!((turns.maa - (FRAC_PI_2 + PI + FRAC_PI_4) / 3.0).abs() < 1e-15);
    assert!((turns.maa_fold - (FRAC_PI_2 + FRAC_PI_4) / 3.0).abs() < 1e-15);
    assert_eq!(turns.range, [-PI, FRAC_PI_2]);
    assert_eq!(headings(&path), [0.0, FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_4]);
}

#[test]
fn legs_without_length_have_no_heading() {
    let path = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
    assert_eq!(headings(&path), [0.0, FRAC_PI_2]);
    assert_eq!(Turns::from_path(&path).count, 1);
}

#[test]
fn nothing_to_measure_is_none_and_never_a_panic() {
    let (one, alone) = (points(&[(1.0, 2.0)]), lap(&[(1.0, 2.0)]));
    assert_eq!(mae_lap(&one, &[], 120), None);
    assert_eq!(mae_time(&[], from_ref(&alone), 120), None);
    assert_eq!(mae_time(&one, &[Track::default()], 120), None);
    assert_eq!(mae_joint(&one, &[Track::default()], 120), None);
    assert_eq!(mae_time(&one, from_ref(&alone), 0), None);
    assert_eq!(mae_time(&one, from_ref(&alone), 3), Some(0.0));
    assert_eq!(speed(&Track::default(), 1.0), None);
    assert_eq!(speed(&alone, 0.0), None);
    assert_eq!(andc(3, f64::NAN), None);
    assert_eq!(Turns::from_path(&[]).count, 0);
    assert_eq!(Polyline::new(&[]).at(0.5), None);
    assert_eq!(Polyline::new(&one).at(0.5), Some(one[0]));
    assert_eq!(Polyline::new(&one).at(f64::NAN), None);
    assert!(PathMetrics::from_laps(&one, &[], 1.0).is_none());
}

#[test]
fn a_track_along_its_reference_has_no_error_and_one_beside_it_the_offset() {
    let reference = points(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)]);
    let reference = Polyline::new(&reference);
    let error = |offset: f64| {
        let mut track = Track::default();
        for step in 0..=80_i32 {
            let s = 0.1 * f64::from(step);
            let at = Point2::new(s.min(4.0), (s - 4.0).max(0.0) + offset);
            track.push(s, at);
        }
        mae_between(&reference, &track, 0.0, 8.0, 120).unwrap()
    };
    assert!(error(0.0) < 1e-12);
    assert!((error(0.25) - 0.25).abs() < 1e-12);
}

#[test]
fn a_lap_there_measures_as_the_lap_back() {
    let there = lap(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (5.0, 1.0)]);
    let reference = points(&[(0.0, 0.0), (5.0, 1.0)]);
    let mut back = reference.clone();
    back.reverse();
    let both = [
        mae_time(&reference, from_ref(&there), 30),
        mae_time(&back, &[there.reversed()], 30),
    ];
    assert!(
        (both[0].unwrap() - both[1].unwrap()).abs() < 1e-9,
        "{both:?}"
    );
}

proptest! {
    #[test]
    fn measures_do_not_depend_on_where_the_paths_lie(
        list in prop::collection::vec((-9.0..9.0, -9.0..9.0), 2..20),
        (dx, dy, angle) in (-5.0..5.0, -5.0..5.0, -3.0..3.0),
    ) {
        let way = points(&list);
        let reference = vec![way[0], way[way.len() - 1]];
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let moved = |path: &[Point2<f64>]| -> Vec<Point2<f64>> {
            path.iter()
                .map(|p| Point2::new(cos * p.x - sin * p.y + dx, sin * p.x + cos * p.y + dy))
                .collect()
        };
        let there = [track(moved(&way))];
        let there = PathMetrics::from_laps(&moved(&reference), &there, 60.0).unwrap();
        let here = PathMetrics::from_laps(&reference, &[track(way)], 60.0).unwrap();
        prop_assert!((here.mae_lap - there.mae_lap).abs() < 1e-9);
        prop_assert!((here.mae_time - there.mae_time).abs() < 1e-9);
        prop_assert!((here.turns.maa - there.turns.maa).abs() < 1e-6);
        prop_assert!(here.turns.maa <= PI && here.turns.maa_fold <= FRAC_PI_2);
    }
}
