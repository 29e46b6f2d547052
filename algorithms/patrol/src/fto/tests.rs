use planner_view::view::ScanView;
use proptest::prelude::*;

use super::*;

fn carrier(x: f64) -> Carrier {
    Carrier {
        pose: Pose2::new(x, 0.0, 0.0),
        radius: 0.1,
        reach: 0.5,
        goal: None,
    }
}

fn fto(params: &FtoParams) -> Fto {
    Fto::new(params).unwrap()
}

/// Times at which obstacles appear and disappear, for a moving robot.
fn times(params: &FtoParams, end_s: f64) -> Vec<(f64, bool)> {
    let mut fto = fto(params);
    let mut shown = false;
    let mut changes = Vec::new();
    for tick in 0..(end_s * 1000.0) as u32 {
        let t = f64::from(tick) * 1e-3;
        // Slow enough never to drive into one.
        let now = fto.at(t, &carrier(0.01 * t)).is_some();
        if now != shown {
            changes.push((t, now));
            shown = now;
        }
    }
    changes
}

#[test]
fn obstacles_come_and_go_at_the_times_of_the_logistic_map() {
    let changes = times(&FtoParams::default(), 60.0);
    let z = |k: usize| (0..k).fold(0.18, |z: f64, _| 3.99 * z * (1.0 - z));
    // Gap, duration, side and distance; then the next gap.
    let first = 2.0 + 18.0 * z(1);
    let gone = first + 0.3 + 2.2 * z(2);
    let second = gone + 2.0 + 18.0 * z(5);
    for (found, expected) in changes.iter().zip([first, gone, second]) {
        assert!((found.0 - expected).abs() < 2e-3, "{found:?}, {expected}");
    }
    assert!(changes[0].1 && !changes[1].1 && changes[2].1);
}

#[test]
fn the_times_stay_in_the_papers_ranges_whatever_the_key() {
    let keyed = FtoParams {
        key: Some("keyed:".to_owned() + &"5a".repeat(32)).map(|k| k.parse().unwrap()),
        ..FtoParams::default()
    };
    for params in [FtoParams::default(), keyed] {
        let changes = times(&params, 400.0);
        assert!(changes.len() > 30);
        for pair in changes.windows(2) {
            let lasted = pair[1].0 - pair[0].0;
            let (low, high) = if pair[0].1 { (0.3, 2.5) } else { (2.0, 20.0) };
            assert!(lasted > low - 2e-3 && lasted < high + 2e-3, "{lasted}");
        }
    }
}

#[test]
fn an_obstacle_appears_ahead_within_reach_on_the_side_of_its_number() {
    let mut fto = fto(&FtoParams::default());
    let (mut left, mut right) = (0, 0);
    let mut before = None;
    for tick in 0..20_000 {
        let t = f64::from(tick) * 0.05;
        let carrier = carrier(0.001 * t);
        let now = fto.at(t, &carrier);
        if let (Some(disc), None) = (now, before) {
            let from = disc.center - carrier.pose.position();
            let near = from.norm() - disc.radius;
            assert!(near > 0.1 && from.x - disc.radius < 0.5, "{disc:?}");
            assert!((from.y.abs() - 0.075).abs() < 1e-12);
            if from.y > 0.0 { left += 1 } else { right += 1 }
        }
        before = now;
    }
    assert!(left > 10 && right > 10, "{left}, {right}");
}

#[test]
fn an_obstacle_that_the_robot_touches_or_that_hides_its_goal_is_withdrawn() {
    let mut fto = fto(&FtoParams::default());
    let appears = 2.0 + 18.0 * (3.99 * 0.18 * 0.82) + 1e-6;
    fto.at(0.0, &carrier(0.0));
    let disc = fto.at(appears, &carrier(0.0)).unwrap();
    let mut again = fto.clone();
    let hidden = Carrier {
        goal: Some(disc.center),
        ..carrier(0.0)
    };
    assert_eq!(again.at(appears + 0.01, &hidden), None);
    // Not even after the goal has changed.
    assert_eq!(again.at(appears + 0.02, &carrier(0.0)), None);
    assert_eq!(fto.at(appears + 0.01, &carrier(disc.center.x)), None);
    assert!(fto.at(f64::NAN, &carrier(0.0)).is_none());
}

#[test]
fn bad_parameters_are_named() {
    let cases: [(FtoParams, &str); 3] = [
        (
            FtoParams {
                active_s: [3.0, 2.0],
                ..FtoParams::default()
            },
            "`active_s` is [3, 2]",
        ),
        (
            FtoParams {
                radius: 0.0,
                ..FtoParams::default()
            },
            "`radius` is 0",
        ),
        (
            FtoParams {
                nearest: 2.0,
                ..FtoParams::default()
            },
            "`nearest` is 2",
        ),
    ];
    for (params, start) in cases {
        let error = Fto::new(&params).unwrap_err().to_string();
        assert!(error.starts_with(start), "{error}");
    }
    let params = FtoParams {
        key: Some("catp:0,0".parse().unwrap()),
        ..FtoParams::default()
    };
    assert!(
        Fto::new(&params)
            .unwrap_err()
            .to_string()
            .starts_with("`key`")
    );
}

proptest! {
    #[test]
    fn a_merged_scan_is_the_nearer_of_disc_and_world(
        (x, y, theta) in (-2.0..2.0, -2.0..2.0, -3.0..3.0),
        (cx, cy, radius) in (-2.0..2.0, -2.0..2.0, 0.01..1.0),
        real in prop::collection::vec(prop_oneof![0.05f32..3.0, Just(f32::INFINITY)], 72),
    ) {
        let pose = Pose2::new(x, y, theta);
        let scan = ScanView {
            angle_min: -3.0,
            angle_increment: 0.0872,
            range_min: 0.02,
            range_max: 3.0,
            ranges: &real,
        };
        let disc = Disc { center: Point2::new(cx, cy), radius };
        let mut buffer = vec![1.0; 3];
        let inside = (disc.center - pose.position()).norm() <= radius;
        let shown = merged(&scan, &pose, Some(&disc), &mut buffer);
        prop_assert_eq!(shown.ranges.len(), real.len());
        for (i, (&shown, &real)) in shown.ranges.iter().zip(&real).enumerate() {
            prop_assert!(shown <= real);
            if shown < real {
                prop_assert!(!inside);
                let angle = theta - 3.0 + 0.0872 * i as f64;
                let (sin, cos) = geometry::math::sincos(angle);
                let range = f64::from(shown);
                let hit = Point2::new(x + cos * range, y + sin * range);
                prop_assert!(((hit - disc.center).norm() - radius).abs() < 1e-5);
            }
        }
        let none = merged(&scan, &pose, None, &mut buffer);
        prop_assert_eq!(none.ranges, &real[..]);
    }
}

#[test]
fn a_disc_straight_ahead_is_seen_where_it_is() {
    let scan = ScanView {
        angle_min: 0.0,
        angle_increment: core::f64::consts::FRAC_PI_2,
        range_min: 0.05,
        range_max: 0.5,
        ranges: &[f32::INFINITY, 0.3, f32::INFINITY, f32::INFINITY],
    };
    let disc = Disc {
        center: Point2::new(1.0, 2.4),
        radius: 0.15,
    };
    let pose = Pose2::new(1.0, 2.0, core::f64::consts::FRAC_PI_2);
    let mut buffer = Vec::new();
    let shown = merged(&scan, &pose, Some(&disc), &mut buffer);
    assert_eq!(shown.ranges, [0.25, 0.3, f32::INFINITY, f32::INFINITY]);
}
