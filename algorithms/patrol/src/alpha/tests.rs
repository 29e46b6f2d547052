use chaotic_maps::{Key, KeyKind};

use super::*;
use crate::awg::tests::{awg, catp, octagon, points, source};
use crate::awg::{Frame, Mode, Rounding};
use crate::contour::Contour;

const FLOOR: Mode = Mode {
    rounding: Rounding::Floor,
    frame: Frame::Atan2,
};

#[test]
fn the_papers_robot_may_take_the_published_widths() {
    let awg = awg(&octagon(), 120.0, 1.0, FLOOR);
    for (laps, expected) in [(1, 1.805), (12, 1.792)] {
        let found = alpha_max(&awg, 1.0, laps, &mut source("catf64:0.4,0.644")).unwrap();
        assert!((found - expected).abs() <= 0.0005, "{laps} laps: {found}");
    }
}

#[test]
fn at_the_width_found_the_mean_lap_takes_just_the_time() {
    let awg = awg(&octagon(), 120.0, 1.0, Mode::default());
    let alpha = alpha_max(&awg, 0.8, 5, &mut catp()).unwrap();
    let awg = awg.with_alpha(alpha).unwrap();
    let mut generator = catp();
    let length: f64 = (0..5)
        .map(|lap| awg.lap_track(lap, &mut generator))
        .map(|lap| metrics::path::Polyline::new(lap.points()).length())
        .sum();
    assert!((length / 5.0 / 120.0 - 0.8).abs() < 1e-9);
}

#[test]
fn a_robot_that_turns_gets_less_and_keeps_its_time_on_every_lap() {
    let awg = awg(&octagon(), 120.0, 1.0, Mode::default());
    for seed in 0..5 {
        let generator = || Key::from_seed(KeyKind::Keyed, seed).source().unwrap();
        let mut robot = TurnThenDrive { v: 1.0, omega: 3.0 };
        let free = alpha_max(&awg, 1.0, LAPS, &mut generator()).unwrap();
        let alpha = alpha_max_driven(&awg, 1.0, 0.05, LAPS, &mut generator(), &mut robot).unwrap();
        assert!(alpha > 0.1 && alpha < free, "{alpha} of {free}");
        let times = |alpha: f64| {
            let awg = awg.clone().with_alpha(alpha).unwrap();
            let mut generator = generator();
            let laps: Vec<_> = (0..LAPS)
                .map(|lap| awg.lap_track(lap, &mut generator).points().to_vec())
                .collect();
            TurnThenDrive { v: 1.0, omega: 3.0 }
                .lap_times(&laps)
                .unwrap()
        };
        assert!(times(alpha).iter().all(|t| *t <= 114.0));
        assert!(times(1.01 * alpha).iter().any(|t| *t > 114.0));
    }
}

#[test]
fn turning_then_driving_takes_the_time_of_both() {
    let mut robot = TurnThenDrive { v: 2.0, omega: 0.5 };
    let laps = [
        points(&[(0.0, 0.0), (4.0, 0.0), (4.0, 0.0), (4.0, 2.0)]),
        points(&[(4.0, 2.0), (4.0, 0.0)]),
    ];
    let times = robot.lap_times(&laps).unwrap();
    let quarter = core::f64::consts::FRAC_PI_2 / 0.5;
    assert!((times[0] - (3.0 + quarter)).abs() < 1e-12);
    assert!((times[1] - (1.0 + 2.0 * quarter)).abs() < 1e-12);
}

#[test]
fn a_closure_can_compute_lap_times() {
    let awg = awg(&octagon(), 120.0, 1.0, Mode::default());
    let mut robot = |laps: &[Vec<Point2<f64>>]| {
        let length = |lap: &Vec<_>| metrics::path::Polyline::new(lap).length();
        Some(laps.iter().map(length).collect::<Vec<f64>>())
    };
    let one = alpha_max_driven(&awg, 1.0, 0.0, 1, &mut catp(), &mut robot).unwrap();
    let exact = alpha_max(&awg, 1.0, 1, &mut catp()).unwrap();
    assert!((one - exact).abs() < 1e-4);
}

#[test]
fn the_error_for_a_slow_robot_contains_the_minimum_time() {
    let awg = awg(&octagon(), 120.0, 1.0, Mode::default());
    let error = alpha_max(&awg, 0.4, 1, &mut catp()).unwrap_err();
    assert!(error.to_string().contains("at least 120.711 s"), "{error}");
    // Fast enough for the path, but not for its corners.
    let mut robot = TurnThenDrive {
        v: 0.41,
        omega: 0.5,
    };
    let error = alpha_max_driven(&awg, 0.41, 0.0, 1, &mut catp(), &mut robot).unwrap_err();
    assert!(matches!(error, AlphaError::TooSlow { .. }), "{error}");
    let mut stuck = |_: &[Vec<Point2<f64>>]| None;
    let error = alpha_max_driven(&awg, 1.0, 0.0, 1, &mut catp(), &mut stuck).unwrap_err();
    assert_eq!(error, AlphaError::NotFinished);
}

#[test]
fn values_out_of_range_are_named() {
    let awg = awg(&octagon(), 120.0, 1.0, Mode::default());
    for v in [0.0, -1.0, f64::NAN] {
        let error = alpha_max(&awg, v, 1, &mut catp()).unwrap_err().to_string();
        assert!(error.starts_with("`v_max` is"), "{error}");
    }
    assert!(alpha_max(&awg, 1.0, 0, &mut catp()).is_err());
    let mut robot = TurnThenDrive { v: 1.0, omega: 1.0 };
    for margin in [-0.1, 1.0, f64::NAN] {
        assert!(alpha_max_driven(&awg, 1.0, margin, 1, &mut catp(), &mut robot).is_err());
    }
}

#[test]
fn without_additional_waypoints_there_is_no_greatest_width() {
    let contour = Contour::closed(&points(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])).unwrap();
    let awg = awg(&contour, 2.0, 1.0, Mode::default());
    let error = alpha_max(&awg, 5.0, 1, &mut catp()).unwrap_err();
    assert_eq!(error, AlphaError::NothingInserted);
}
