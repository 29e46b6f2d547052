use chaotic_maps::{Key, KeyKind};
use proptest::prelude::*;
use testing::rectangle;

use super::*;
use crate::awg::tests::{awg, catp, octagon, points, source};
use crate::awg::{AwgParams, Mode};
use crate::contour::Contour;
use crate::danger::DangerZones;

fn open() -> Contour {
    Contour::open(&points(&[(0.0, 0.0), (9.0, 0.0), (9.0, 5.0)])).unwrap()
}

proptest! {
    #[test]
    fn an_ally_with_the_key_computes_every_waypoint(
        seed in any::<u64>(),
        kind in prop::sample::select(vec![KeyKind::CatP, KeyKind::Cat64, KeyKind::CatF64, KeyKind::Keyed]),
        closed in any::<bool>(),
    ) {
        let key = Key::from_seed(kind, seed);
        let contour = if closed { octagon() } else { open() };
        let awg = awg(&contour, 60.0, 1.3, Mode::default());
        // The ally has only the text of the key.
        let ally: Key = key.to_string().parse().unwrap();
        let forecast = Forecast::new(awg.clone(), ally.source().unwrap());
        let driven: Vec<_> = awg.laps(key.source().unwrap()).take(400).collect();
        for waypoint in &driven {
            prop_assert_eq!(forecast.waypoint(waypoint.number).unwrap(), *waypoint);
        }
        let lap: Vec<_> = driven.iter().filter(|w| w.lap == 3).copied().collect();
        prop_assert_eq!(forecast.lap(3).unwrap(), lap);
    }
}

#[test]
fn a_waypoint_far_ahead_is_found_at_once() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let forecast = Forecast::new(awg.clone(), catp());
    let lap = forecast.lap(1_000_000_000).unwrap();
    let first = 1 + 1_000_000_000 * 120;
    assert_eq!(lap[0].number, first);
    assert_eq!(forecast.waypoint(first + 40).unwrap(), lap[40]);
    // An observer with another key, one unit away, cannot predict anything.
    let outsider = Forecast::new(awg, source("catp:3689348814741910314,5939851591734475604"));
    let gap = outsider.waypoint(first + 40).unwrap().point - lap[40].point;
    assert!(gap.norm() > 1e-3, "{gap}");
}

#[test]
fn by_the_papers_clock_a_waypoint_is_reached_every_second() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let forecast = Forecast::new(awg, catp());
    assert_eq!(forecast.lap_time(), 120.0);
    for (t, number, share) in [
        (0.0, 0, 0.0),
        (0.25, 0, 0.25),
        (119.5, 119, 0.5),
        (241.75, 241, 0.75),
    ] {
        let found = forecast.at_time(t).unwrap();
        let (from, to) = (
            forecast.waypoint(number).unwrap(),
            forecast.waypoint(number + 1).unwrap(),
        );
        assert_eq!((found.from, found.to), (from, to));
        let expected = from.point + (to.point - from.point) * share;
        assert!((found.point - expected).norm() < 1e-9);
    }
    let far = forecast.at_time(120.0 * 1e6 + 3.5).unwrap();
    assert_eq!(far.from.number, 120_000_003);
}

#[test]
fn without_a_threat_the_clock_is_that_of_the_unprotected_patrol() {
    let zone = rectangle([0.0, 7.5], [1.0, 1.0]);
    let (t_max, alpha, mode) = (120.0, 1.0, Mode::default());
    let params = AwgParams { t_max, alpha, mode };
    let awg = Awg::new(&octagon(), &DangerZones(vec![zone]), params).unwrap();
    assert_eq!(awg.waypoints_per_lap(), 14);
    let forecast = Forecast::new(awg.clone(), catp());
    // 2 m at 0.4024 m/s are 4 waypoints and the exit: 5 s instead of 4.97.
    assert!((forecast.lap_time() - 120.0).abs() < 0.05);
    let half = forecast.at_time(0.5 * 50f64.sqrt() / awg.v()).unwrap();
    assert!((half.point - Point2::new(2.5, 2.5)).norm() < 1e-9);
}

#[test]
fn invalid_and_distant_times_have_no_forecast() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let forecast = Forecast::new(awg.clone(), catp());
    for t in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            forecast.at_time(t),
            Err(ForecastError::Value { .. })
        ));
    }
    assert!(matches!(
        forecast.at_time(1e15),
        Err(ForecastError::TooFar { .. })
    ));
    assert!(matches!(
        forecast.waypoint(u64::MAX),
        Err(ForecastError::TooFar { .. })
    ));
    let slow = Forecast::new(awg, source("standard:0.3,0.4"));
    assert!(matches!(
        slow.lap(u32::MAX),
        Err(ForecastError::TooFar { .. })
    ));
    slow.lap(1000).unwrap();
}

#[test]
fn a_waypoint_is_where_the_forecast_is_when_it_is_due() {
    for (contour, tempo) in [(octagon(), 1.0), (open(), 1.0), (open(), 0.9)] {
        let awg = awg(&contour, 60.0, 1.3, Mode::default())
            .with_tempo(tempo)
            .unwrap();
        let forecast = Forecast::new(awg.clone(), catp());
        assert_eq!(awg.due_s(0), 0.0);
        let mut before = 0.0;
        for number in 1..300 {
            let due = awg.due_s(number);
            assert!(due > before);
            before = due;
            let found = forecast.at_time(due).unwrap();
            let waypoint = forecast.waypoint(number).unwrap();
            assert!((found.point - waypoint.point).norm() < 1e-9);
        }
        let lap = awg.waypoints_per_lap();
        assert!((awg.due_s(3 * lap) - 3.0 * forecast.lap_time()).abs() < 1e-9);
    }
    for tempo in [0.0, 1.1, f64::NAN] {
        let made = awg(&open(), 60.0, 1.3, Mode::default()).with_tempo(tempo);
        assert!(made.is_err());
    }
}
