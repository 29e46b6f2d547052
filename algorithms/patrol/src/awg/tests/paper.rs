//! Values that can be recomputed from the formulas: cases 1 and 2 with the key (0.4, 0.644), exact
//! and in `f64`.

use metrics::path::{PathMetrics, Turns, mae_joint, mae_lap, mae_time, speed};

use super::*;

const ATAN2_FLOOR: Mode = Mode {
    rounding: Rounding::Floor,
    frame: Frame::Atan2,
};

#[track_caller]
fn close(value: f64, expected: f64, relative: f64) {
    assert!(
        (value - expected).abs() <= relative * expected.abs(),
        "{value} is not {expected}"
    );
}

/// To the last digit of a table.
#[track_caller]
fn rounds_to(value: f64, expected: f64, digit: f64) {
    assert!(
        (value - expected).abs() <= 0.5 * digit + 1e-12,
        "{value} does not round to {expected}"
    );
}

#[test]
fn twelve_laps_of_the_octagon_in_all_four_readings() {
    use {Frame::*, Rounding::*};
    let reading = |rounding, frame| Mode { rounding, frame };
    // First waypoint; length of lap 1, speed, MAE by lap and time, turns and folded turns.
    let rows = [
        (
            reading(Nearest, Atan2),
            (4.436_599_289, 0.111_418_057),
            [
                121.922_384,
                0.992_718,
                0.790_618,
                0.896_488,
                1.946_739,
                0.753_080,
            ],
        ),
        (
            reading(Nearest, Atan),
            (4.994_365_118, 0.457_617_537),
            [
                121.897_200,
                0.990_508,
                0.833_907,
                0.920_696,
                1.919_534,
                0.762_840,
            ],
        ),
        (
            reading(Floor, Atan2),
            (4.436_599_289, 0.111_418_057),
            [
                111.294_513,
                0.941_419,
                0.733_227,
                0.802_511,
                1.905_772,
                0.750_230,
            ],
        ),
        (
            reading(Floor, Atan),
            (4.994_365_118, 0.457_617_537),
            [
                110.056_646,
                0.949_213,
                0.759_942,
                0.872_945,
                1.906_382,
                0.745_024,
            ],
        ),
    ];
    for (mode, (x, y), expected) in rows {
        let awg = awg(&octagon(), 120.0, 1.7, mode);
        let laps = tracks(&awg, 12, &mut catp());
        let first = laps[0].points()[1];
        assert!(
            (first - Point2::new(x, y)).norm() < 1e-9,
            "{mode:?}: {first}"
        );
        let found = PathMetrics::from_laps(octagon().points(), &laps, 120.0).unwrap();
        let values = [
            found.length_first,
            found.speed_mean,
            found.mae_lap,
            found.mae_time,
            found.turns.maa,
            found.turns.maa_fold,
        ];
        for (value, expected) in values.into_iter().zip(expected) {
            close(value, expected, 1e-6);
        }
    }
}

#[test]
fn presets_are_the_readings_they_name() {
    assert_eq!(
        Preset::Printed.mode(),
        Mode {
            rounding: Rounding::Floor,
            frame: Frame::Atan
        }
    );
    assert_eq!(
        Preset::PaperFit.mode(),
        Mode {
            rounding: Rounding::Nearest,
            frame: Frame::Atan
        }
    );
    assert_eq!(Preset::Default.mode(), Mode::default());
}

#[test]
fn numbers_of_waypoints_are_exact() {
    let counts = |mode| -> Vec<u32> {
        let awg = awg(&octagon(), 120.0, 1.7, mode);
        awg.legs(0).iter().map(|leg| leg.inserted).collect()
    };
    assert_eq!(counts(ATAN2_FLOOR), [16, 11, 16, 11, 16, 11, 16, 11]);
    assert_eq!(counts(Mode::default()), [17, 11, 17, 11, 17, 11, 17, 11]);
    let floor = awg(&octagon(), 120.0, 1.7, ATAN2_FLOOR);
    assert_eq!(
        (floor.steps_per_lap(), floor.waypoints_per_lap()),
        (108, 116)
    );
    let nearest = awg(&octagon(), 120.0, 1.7, Mode::default());
    assert_eq!(nearest.waypoints_per_lap(), 120);
    close(floor.v(), 0.402_369, 1e-6);
    // Changes of direction per second: not the paper's 0.4024, which is v.
    let laps = tracks(&floor, 1, &mut catp());
    let found = PathMetrics::from_laps(octagon().points(), &laps, 120.0).unwrap();
    close(found.andc, 116.0 / 120.0, 1e-12);
}

/// The time of a lap of the square at the speed of case 1, 0.4024 m/s.
fn square_time() -> f64 {
    square().length() / (octagon().length() / 120.0)
}

#[test]
fn the_square_of_case_2() {
    let t_max = square_time();
    for (frame, length, mae) in [
        (Frame::Atan2, 74.869_333, 0.562_429),
        (Frame::Atan, 75.053_642, 0.628_128),
    ] {
        let rounding = Rounding::Floor;
        let awg = awg(&square(), t_max, 1.3, Mode { rounding, frame });
        assert_eq!(awg.waypoints_per_lap(), 96);
        let laps = tracks(&awg, 12, &mut catp());
        let found = PathMetrics::from_laps(square().points(), &laps, t_max).unwrap();
        close(found.length_first, length, 1e-6);
        close(found.mae_time, mae, 1e-6);
    }
}

#[test]
fn the_segment_of_figure_5() {
    // 5 m at 0.5 m/s, alone.
    let contour = Contour::open(&points(&[(1.0, 4.0), (5.0, 1.0)])).unwrap();
    let awg = awg(&contour, 10.0, 2.0, ATAN2_FLOOR);
    let lap = awg.lap_track(0, &mut source("catf64:0.4,0.644"));
    let expected = [
        (1.696, 3.948),
        (2.8752, 2.3936),
        (2.5296, 3.0328),
        (3.5136, 1.6048),
    ];
    for (found, (x, y)) in lap.points()[1..].iter().zip(expected) {
        assert!((found - Point2::new(x, y)).norm() < 1e-9, "{found}");
    }
}

#[test]
fn speeds_and_errors_of_figures_6_and_10() {
    // α; speed of lap 1 and of 12 laps, of lap 1 with atan; MAE by lap, joint, joint with atan.
    let rows = [
        (0.25, [0.4138, 0.4140, 0.4141, 0.0726, 0.195, 0.186]),
        (0.50, [0.4493, 0.4505, 0.4513, 0.1899, 0.548, 0.504]),
        (0.75, [0.5239, 0.5253, 0.5252, 0.3025, 0.610, 0.680]),
        (1.00, [0.6226, 0.6252, 0.6224, 0.4483, 0.690, 0.746]),
        (1.25, [0.7330, 0.7377, 0.7321, 0.5992, 0.778, 0.851]),
        (1.50, [0.8506, 0.8565, 0.8491, 0.7476, 0.847, 0.967]),
        (1.70, [0.9482, 0.9545, 0.9464, 0.8656, 0.897, 1.060]),
        (2.00, [1.0978, 1.1046, 1.0958, 1.0366, 0.972, 1.200]),
        (2.50, [1.3529, 1.3600, 1.3505, 1.3067, 1.113, 1.435]),
    ];
    let reference = octagon();
    let reference = reference.points();
    for (alpha, expected) in rows {
        let laps = |mode| {
            let awg = awg(&octagon(), 120.0, alpha, mode);
            tracks(&awg, 12, &mut source("catf64:0.4,0.644"))
        };
        let (turned, printed) = (laps(ATAN2_FLOOR), laps(Preset::Printed.mode()));
        let of_turned = PathMetrics::from_laps(reference, &turned, 120.0).unwrap();
        rounds_to(of_turned.speed_first, expected[0], 1e-4);
        rounds_to(of_turned.speed_mean, expected[1], 1e-4);
        rounds_to(speed(&printed[0], 120.0).unwrap(), expected[2], 1e-4);
        rounds_to(mae_lap(reference, &turned, 120).unwrap(), expected[3], 1e-4);
        rounds_to(
            mae_joint(reference, &turned, 120).unwrap(),
            expected[4],
            1e-3,
        );
        rounds_to(
            mae_joint(reference, &printed, 120).unwrap(),
            expected[5],
            1e-3,
        );
    }
}

#[test]
fn the_papers_key_in_the_best_fitting_reading() {
    let mode = Preset::PaperFit.mode();
    let laps = tracks(
        &awg(&octagon(), 120.0, 1.7, mode),
        12,
        &mut source("catf64:0.4,0.644"),
    );
    let found = PathMetrics::from_laps(octagon().points(), &laps, 120.0).unwrap();
    rounds_to(found.mae_time, 0.9315, 1e-4);
    rounds_to(found.speed_first, 0.9845, 1e-4);
    rounds_to(found.turns_first.maa_fold, 0.7831, 1e-4);
    let case_2 = awg(&square(), square_time(), 1.3, mode);
    let laps = tracks(&case_2, 12, &mut source("catf64:0.4,0.644"));
    rounds_to(
        mae_time(square().points(), &laps, 120).unwrap(),
        0.7160,
        1e-4,
    );
    rounds_to(Turns::from_path(laps[0].points()).maa_fold, 0.7956, 1e-4);
}

#[test]
fn two_hundred_random_keys_stay_in_the_published_bands() {
    use chaotic_maps::KeyKind;
    // 2.5 % and 97.5 % quantiles of the population.
    let bands = [
        (0.911, 0.988),
        (0.940, 0.962),
        (0.678, 0.893),
        (0.786, 0.827),
        (1.893, 1.994),
        (0.718, 0.766),
    ];
    let awg = awg(&octagon(), 120.0, 1.7, ATAN2_FLOOR);
    let mut outside = [(0, 0); 6];
    for seed in 0..200 {
        let mut generator = Key::from_seed(KeyKind::CatP, seed).source().unwrap();
        let laps = tracks(&awg, 12, &mut generator);
        let found = PathMetrics::from_laps(octagon().points(), &laps, 120.0).unwrap();
        let values = [
            found.speed_first,
            found.speed_mean,
            found.mae_lap,
            found.mae_time,
            found.turns.maa,
            found.turns.maa_fold,
        ];
        for ((value, (low, high)), count) in values.into_iter().zip(bands).zip(&mut outside) {
            count.0 += usize::from(value < low);
            count.1 += usize::from(value > high);
        }
    }
    // Five of 200 are expected on either side of each band; the bands are estimates themselves.
    for (below, above) in outside {
        assert!(below <= 14 && above <= 14, "{outside:?}");
        assert!(below + above >= 1, "{outside:?}");
    }
}
