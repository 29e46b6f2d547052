use super::*;
use crate::awg::Mode;
use crate::awg::tests::{awg, catp, octagon, points};
use crate::contour::Contour;

fn laps() -> MixedLaps<chaotic_maps::AnySource> {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    MixedLaps::new(MixedParams::default(), awg.laps(catp())).unwrap()
}

/// Waypoints of the leg with this index, and the methods they had, lap by lap.
fn counts(
    mixed: &mut MixedLaps<chaotic_maps::AnySource>,
    laps: u32,
    leg: usize,
    inside: impl Fn(Point2<f64>) -> bool + Copy,
    outcome: impl Fn(&Waypoint) -> WaypointOutcome,
) -> Vec<(usize, bool)> {
    let mut found = vec![(0, false); laps as usize];
    loop {
        let (waypoint, method) = mixed.next_waypoint(inside);
        if waypoint.lap >= laps {
            return found;
        }
        mixed.report(&waypoint, outcome(&waypoint));
        if mixed
            .awg()
            .place(waypoint.number)
            .is_some_and(|p| p.1 == leg)
        {
            let of_lap = &mut found[waypoint.lap as usize];
            of_lap.0 += 1;
            of_lap.1 |= method == Method::FictiveObstacles;
        }
    }
}

#[test]
fn a_large_obstacle_gets_fictive_obstacles_and_a_small_one_waypoints() {
    // Both at the left side of the octagon: one covers its inner half and more, one is a post.
    let wall = |p: Point2<f64>| p.x > -0.2 && p.x < 4.0 && p.y > 5.0 && p.y < 10.0;
    let post = |p: Point2<f64>| (p - Point2::new(0.0, 7.5)).norm() < 0.3;
    let reached = |_: &Waypoint| WaypointOutcome::Reached;
    assert_eq!(counts(&mut laps(), 2, 1, wall, reached), [(1, true); 2]);
    assert_eq!(counts(&mut laps(), 2, 1, post, reached), [(12, false); 2]);
    // The legs beside it keep theirs.
    assert_eq!(counts(&mut laps(), 2, 2, wall, reached), [(18, false); 2]);
}

#[test]
fn the_share_inside_is_that_of_the_area() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    let left = &awg.legs(0)[1];
    assert_eq!(share_inside(&awg, left, |p| p.x > 0.0), 0.5);
    assert_eq!(share_inside(&awg, left, |_| false), 0.0);
    assert_eq!(share_inside(&awg, left, |_| true), 1.0);
}

#[test]
fn unreachable_waypoints_change_the_method_for_some_laps() {
    let mut mixed = laps();
    let on_the_left = |w: &Waypoint| {
        if w.point.x < 1.0 && w.point.y > 5.0 && w.point.y < 10.0 {
            WaypointOutcome::TimedOut
        } else {
            WaypointOutcome::Reached
        }
    };
    let found = counts(&mut mixed, 7, 1, |_| false, on_the_left);
    let fictive: Vec<bool> = found.iter().map(|f| f.1).collect();
    // Tried on lap 0, given up for four laps, tried again.
    assert_eq!(fictive, [false, true, true, true, true, false, true]);
}

#[test]
fn the_waypoints_left_are_those_of_the_whole_zig_zag() {
    let wall = |p: Point2<f64>| p.x < 4.0 && p.y > 5.0 && p.y < 10.0;
    let mut mixed = laps();
    let all: Vec<Waypoint> = mixed.awg().clone().laps(catp()).take(400).collect();
    let mut seen = 0;
    while let (waypoint, _) = mixed.next_waypoint(wall)
        && waypoint.number < 400
    {
        assert_eq!(waypoint, all[waypoint.number as usize]);
        seen += 1;
    }
    assert!(seen < 370 && seen > 330, "{seen}");
}

#[test]
fn on_the_return_of_an_open_contour_a_leg_is_the_same_leg() {
    let contour = Contour::open(&points(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)])).unwrap();
    let awg = awg(&contour, 30.0, 1.0, Mode::default());
    let mut mixed = MixedLaps::new(MixedParams::default(), awg.laps(catp())).unwrap();
    let on_the_first = |w: &Waypoint| {
        if w.point.y < 0.6 {
            WaypointOutcome::Unreachable
        } else {
            WaypointOutcome::Reached
        }
    };
    // The first leg there is the second leg back.
    let found = counts(&mut mixed, 3, 1, |_| false, on_the_first);
    assert_eq!(found, [(20, false), (1, true), (20, false)]);
}

#[test]
fn bad_parameters_are_named() {
    let awg = awg(&octagon(), 120.0, 1.7, Mode::default());
    for (dropped_share, retry_laps, named) in
        [(1.5, 1, "`dropped_share`"), (0.5, 0, "`retry_laps`")]
    {
        let params = MixedParams {
            dropped_share,
            retry_laps,
        };
        let error = MixedLaps::new(params, awg.clone().laps(catp())).unwrap_err();
        assert!(error.to_string().starts_with(named), "{error}");
    }
}
