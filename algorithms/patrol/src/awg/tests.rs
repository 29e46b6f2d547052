//! The formulas by hand, and the published values of cases 1 and 2.

mod paper;
mod properties;

use chaotic_maps::{AnySource, Key};

use super::*;

pub(crate) fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
    list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// The contour of case 1.
pub(crate) fn octagon() -> Contour {
    Contour::closed(&points(&[
        (5.0, 0.0),
        (0.0, 5.0),
        (0.0, 10.0),
        (5.0, 15.0),
        (10.0, 15.0),
        (15.0, 10.0),
        (15.0, 5.0),
        (10.0, 0.0),
        (5.0, 0.0),
    ]))
    .unwrap()
}

/// The contour of case 2.
pub(crate) fn square() -> Contour {
    Contour::closed(&points(&[
        (1.0, 1.0),
        (1.0, 11.0),
        (11.0, 11.0),
        (11.0, 1.0),
    ]))
    .unwrap()
}

pub(crate) fn source(key: &str) -> AnySource {
    key.parse::<Key>().unwrap().source().unwrap()
}

/// The key of the published values.
pub(crate) fn catp() -> AnySource {
    source("catp:0.4,0.644")
}

/// Explicit points.
struct PointList(Vec<[f64; 2]>);

impl Source for PointList {
    fn next_unit(&mut self) -> [f64; 2] {
        self.0.remove(0)
    }
}

pub(crate) fn awg(contour: &Contour, t_max: f64, alpha: f64, mode: Mode) -> Awg {
    let params = AwgParams { t_max, alpha, mode };
    Awg::new(contour, &DangerZones::default(), params).unwrap()
}

/// The first laps.
pub(crate) fn tracks(awg: &Awg, laps: u32, source: &mut impl Source) -> Vec<Track> {
    (0..laps).map(|lap| awg.lap_track(lap, source)).collect()
}

#[test]
fn a_waypoint_follows_the_formula() {
    // North, 4 m in 4 s: three waypoints; the square's first axis is north, its second west.
    let contour = Contour::open(&points(&[(2.0, 1.0), (2.0, 5.0)])).unwrap();
    let awg = awg(&contour, 4.0, 0.5, Mode::default());
    assert_eq!(awg.v(), 1.0);
    assert_eq!((awg.steps_per_lap(), awg.waypoints_per_lap()), (3, 4));
    let mut lap = Vec::new();
    let mut generator = PointList(vec![[0.5625, 0.875], [0.4375, 0.3125], [0.75, 0.0625]]);
    awg.lap_into(0, &mut generator, &mut lap);
    let expected = [
        (2.0 - 0.5 * 0.375, 2.0 + 0.5 * 0.5625),
        (2.0 + 0.5 * 0.1875, 3.0 + 0.5 * 0.4375),
        (2.0 + 0.5 * 0.4375, 4.0 + 0.5 * 0.75),
        (2.0, 5.0),
    ];
    for (waypoint, (x, y)) in lap.iter().zip(expected) {
        assert!((waypoint.point - Point2::new(x, y)).norm() < 1e-15);
    }
    let numbers: Vec<u64> = lap.iter().map(|w| w.number).collect();
    assert_eq!(numbers, [1, 2, 3, 4]);
    assert_eq!(lap[2].kind, WaypointKind::Inserted);
    assert_eq!(lap[3].kind, WaypointKind::Route);
}

#[test]
fn laps_continue_forever_without_repetition() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let stream: Vec<Waypoint> = awg.clone().laps(catp()).take(1 + 3 * 120).collect();
    assert_eq!(stream[0].point, Point2::new(5.0, 0.0));
    assert!(stream.iter().enumerate().all(|(i, w)| w.number == i as u64));
    // The same as lap by lap.
    let mut generator = catp();
    let mut laps = vec![stream[0]];
    for lap in 0..3 {
        awg.lap_into(lap, &mut generator, &mut laps);
    }
    assert_eq!(stream, laps);
    let inserted = |lap: u32| {
        let of_lap = stream.iter().filter(move |w| w.lap == lap);
        of_lap.filter(|w| w.kind == WaypointKind::Inserted)
    };
    assert!(
        inserted(0)
            .zip(inserted(1))
            .all(|(a, b)| a.point != b.point)
    );
}

#[test]
fn an_open_contour_is_walked_back_with_new_waypoints() {
    let contour = Contour::open(&points(&[(0.0, 0.0), (10.0, 0.0), (10.0, 6.0)])).unwrap();
    let awg = awg(&contour, 16.0, 0.8, Mode::default());
    let stream: Vec<Waypoint> = awg.clone().laps(catp()).take(1 + 3 * 16).collect();
    let route = |lap: u32| -> Vec<Point2<f64>> {
        let of_lap = stream.iter().filter(|w| w.lap == lap);
        of_lap
            .filter(|w| w.kind == WaypointKind::Route)
            .map(|w| w.point)
            .collect()
    };
    let p = contour.points();
    assert_eq!(route(0), [p[0], p[1], p[2]]);
    assert_eq!(route(1), [p[1], p[0]]);
    assert_eq!(route(2), [p[1], p[2]]);
    // On the return, too, every waypoint is ahead of its nominal position by 0 … α.
    for (w, leg_end) in stream[17..22].iter().zip(1..) {
        let lead = (6.0 - f64::from(leg_end)) - w.point.y;
        assert!((0.0..0.8).contains(&lead), "{lead}");
        assert!((w.point.x - 10.0).abs() <= 0.4);
    }
}

#[test]
fn waypoints_inside_known_obstacles_are_left_out_but_take_their_step() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let inside = |p: Point2<f64>| (p - Point2::new(0.0, 7.5)).norm() < 1.2;
    let all: Vec<Waypoint> = awg.clone().laps(catp()).take(361).collect();
    let mut laps = awg.laps(catp());
    let (mut kept, mut dropped) = (Vec::new(), Vec::new());
    while kept.len() + dropped.len() < all.len() {
        kept.push(laps.next_outside(inside, &mut dropped));
    }
    assert!(dropped.len() > 10, "{}", dropped.len());
    assert!(dropped.iter().all(|w| inside(w.point)));
    assert!(kept.iter().all(|w| !inside(w.point)));
    let mut both = [kept, dropped].concat();
    both.sort_by_key(|w| w.number);
    assert_eq!(both[..all.len()], all[..]);
}

#[test]
fn waypoints_of_the_route_are_never_left_out() {
    let contour = Contour::closed(&points(&[(0.0, 0.0), (9.0, 0.0), (9.0, 12.0)])).unwrap();
    let mut laps = awg(&contour, 36.0, 1.0, Mode::default()).laps(catp());
    let mut dropped = Vec::new();
    for number in [0, 9, 21, 36] {
        let waypoint = laps.next_outside(|_| true, &mut dropped);
        assert_eq!(
            (waypoint.number, waypoint.kind),
            (number, WaypointKind::Route)
        );
    }
    assert_eq!(dropped.len(), 33);
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    let made = |t_max, alpha| {
        let mode = Mode::default();
        let params = AwgParams { t_max, alpha, mode };
        Awg::new(&octagon(), &DangerZones::default(), params).unwrap_err()
    };
    for alpha in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(made(120.0, alpha).to_string().starts_with("`alpha` is"));
    }
    for t_max in [0.0, -1.0, f64::NAN, f64::INFINITY, 2e6] {
        assert!(made(t_max, 1.0).to_string().starts_with("`t_max` is"));
    }
    let good = awg(&octagon(), 120.0, 1.0, Mode::default());
    assert!(good.clone().with_alpha(0.0).is_err());
    assert_eq!(good.with_alpha(0.5).unwrap().params().alpha, 0.5);
}

#[test]
fn the_error_for_a_short_time_contains_the_minimum() {
    let awg = awg(&octagon(), 40.0, 1.0, Mode::default());
    let error = awg.check_speed(1.0).unwrap_err().to_string();
    assert!(error.contains("48.284 s"), "{error}");
    assert!(awg.check_speed(f64::NAN).is_err());
    awg.check_speed(1.3).unwrap();
}

#[test]
fn a_segment_shorter_than_a_second_gets_no_waypoint() {
    let contour = Contour::closed(&points(&[(0.0, 0.0), (0.2, 0.0), (10.0, 0.0)])).unwrap();
    let awg = awg(&contour, 20.0, 0.5, Mode::default());
    let inserted: Vec<u32> = awg.legs(0).iter().map(|leg| leg.inserted).collect();
    assert_eq!(inserted, [0, 9, 9]);
}

#[test]
fn a_lap_that_is_the_contour_has_no_error_over_time() {
    // Sides of 1 to 9 m, cut by zones into stretches without a waypoint.
    let corners = points(&[(0.0, 0.0), (9.0, 0.0), (9.0, 1.0), (3.0, 1.0), (0.0, 4.0)]);
    for contour in [Contour::closed(&corners), Contour::open(&corners)] {
        let contour = contour.unwrap();
        let zones: DangerZones = toml::from_str::<std::collections::BTreeMap<String, _>>(
            "zones = [{ circle = { center = [2, 2], radius = 0.1 } }, \
             { circle = { center = [9, 0.5], radius = 0.01 } }]",
        )
        .unwrap()
        .remove("zones")
        .unwrap();
        let (t_max, mode) = (30.0, Mode::default());
        let params = AwgParams {
            t_max,
            alpha: 1.0,
            mode,
        };
        let awg = Awg::new(&contour, &zones, params).unwrap();
        assert_eq!(awg.steps_per_lap(), 0);
        assert!((awg.lap_time() - t_max).abs() < 1e-9);
        let laps = [awg.lap_track(0, &mut catp())];
        let error = metrics::path::mae_time(contour.points(), &laps, 120).unwrap();
        assert!(error < 1e-9, "{error}");
    }
}
