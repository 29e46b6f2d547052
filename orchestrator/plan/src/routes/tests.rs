//! Routes of the built-in scenarios.

use planner_view::waypoint::WaypointKind;

use super::coverage::{Extent, plan};
use super::patrol::Patrol;
use super::*;
use kinds::load;

fn scenario(name: &str, set: &[&str]) -> ResolvedScenario {
    let set: Vec<String> = set.iter().map(|&s| s.to_owned()).collect();
    load(name, &set, None).unwrap()
}

#[test]
fn laps_of_the_octagon_are_those_of_the_papers_formulas() {
    // Published reference values of the preset `default`, with the key of the paper in exact arithmetic.
    let octagon = scenario(
        "patrol_octagon",
        &[
            "processes.patrol.params.mission.key=catp:0.4,0.644",
            "processes.patrol.params.mission.alpha=1.7",
        ],
    );
    let patrol = Patrol::from_scenario(&octagon, None, None).unwrap();
    let laps = patrol.laps(12).unwrap();
    let first = laps.waypoints[1];
    assert_eq!((first.number, first.kind), (1, WaypointKind::Inserted));
    assert!((first.point.x - 4.436_599_289).abs() < 1e-9);
    assert!((first.point.y - 0.111_418_057).abs() < 1e-9);
    let metrics = laps.metrics.as_ref().unwrap();
    for (found, expected) in [
        (metrics.length_first, 121.922_384),
        (metrics.speed_mean, 0.992_718),
        (metrics.mae_time, 0.896_488),
        (metrics.turns.maa, 1.946_739),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    assert_eq!(patrol.plan_json(12).unwrap()["metrics"]["laps"], 12);
}

const MISSION: &str = "processes.patrol.params.mission";

/// The octagon, threatened within this distance of a point.
fn threatened(center: [f64; 2], radius: f64) -> Patrol {
    let zone = format!(
        "{MISSION}.danger_zones=[{{ circle = {{ center = {center:?}, radius = {radius} }} }}]"
    );
    Patrol::from_scenario(&scenario("patrol_octagon", &[&zone]), None, None).unwrap()
}

#[test]
fn a_patrol_with_a_danger_zone_is_planned_within_the_map() {
    let patrol = threatened([5.0, 0.0], 2.0);
    assert_eq!(patrol.alpha_choice().name(), "room");
    assert_eq!(patrol.warnings, [""; 0]);
    let laps = patrol.laps(12).unwrap();
    for waypoint in &laps.waypoints {
        let inside = |x: f64| (-1.78 - 1e-6..=16.78 + 1e-6).contains(&x);
        let at = waypoint.point;
        assert!(inside(at.x) && inside(at.y), "{waypoint:?}");
    }
}

#[test]
fn waypoints_outside_the_map_are_reported() {
    let octagon = scenario("patrol_octagon", &[&format!("{MISSION}.alpha=6.0")]);
    let patrol = Patrol::from_scenario(&octagon, None, None).unwrap();
    assert_eq!(patrol.alpha_choice().name(), "given");
    let [warning] = &patrol.warnings[..] else {
        panic!("{:?}", patrol.warnings);
    };
    assert!(warning.contains("the robot does not fit"), "{warning}");
}

#[test]
fn a_zone_without_a_contour_is_reported_and_the_lap_is_the_contour() {
    let patrol = threatened([7.5, 7.5], 2.0);
    assert_eq!(patrol.alpha_choice().name(), "unused");
    assert!(patrol.warnings[0].contains("`danger_zones[0]`"));
    let metrics = patrol.laps(2).unwrap().metrics.unwrap();
    assert!(metrics.mae_time < 1e-9, "{}", metrics.mae_time);
}

#[test]
fn the_error_of_a_partly_threatened_lap_is_that_of_its_zig_zag() {
    // Two metres of 48: with equal times for all legs the error was metres.
    let octagon =
        format!("{MISSION}.danger_zones=[{{ circle = {{ center = [0.0, 7.5], radius = 1.0 }} }}]");
    let octagon = scenario(
        "patrol_octagon",
        &[&octagon, &format!("{MISSION}.alpha=1.0")],
    );
    let patrol = Patrol::from_scenario(&octagon, None, None).unwrap();
    let metrics = patrol.laps(12).unwrap().metrics.unwrap();
    assert!(metrics.mae_time < 0.1, "{}", metrics.mae_time);
}

#[test]
fn only_an_ally_with_the_key_predicts_the_path() {
    let octagon = scenario(
        "patrol_octagon",
        &["processes.patrol.params.mission.alpha=1.0"],
    );
    let patrol = Patrol::from_scenario(&octagon, None, None).unwrap();
    let ally = Patrol::from_scenario(&octagon, None, Some(*patrol.key())).unwrap();
    let other = "catp:0.1,0.2".parse().unwrap();
    let other_key = Patrol::from_scenario(&octagon, None, Some(other)).unwrap();
    let far = patrol.waypoint(1_000_001).unwrap();
    assert_eq!(ally.waypoint(1_000_001).unwrap(), far);
    assert_ne!(other_key.waypoint(1_000_001).unwrap().point, far.point);
    let place = ally.at(1234.5).unwrap();
    assert_eq!(place.point, patrol.at(1234.5).unwrap().point);
    for (time, words) in [
        (-1.0, "`t` is -1"),
        (f64::NAN, "`t` is NaN"),
        (f64::INFINITY, "`t` is inf"),
    ] {
        let error = patrol.prediction_json(&[time], &[]).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let error = patrol
        .prediction_json(&[], &[99_999_999_999_999_999])
        .unwrap_err();
    assert!(error.to_string().contains("too far ahead"), "{error}");
}

#[test]
fn the_first_case_of_coverage_has_its_four_rectangles_and_covers_what_the_reference_does() {
    let case = scenario(
        "coverage_case1",
        &[
            "processes.cover.params.follow.margin=0",
            "processes.cover.params.key=chebp:123456789012345678,987654321098765432",
            "processes.cover.params.route={ cycle = [0, 3, 1, 2] }",
            "processes.cover.params.iterations={ each = 50 }",
            "processes.cover.params.transit={ wait = { cap = 100000 } }",
        ],
    );
    let planned = plan(&case, None, Extent::Loops(1)).unwrap();
    let areas: Vec<f64> = (0..4)
        .map(|r| planned.site.decomposition.area_of(r))
        .collect();
    assert_eq!(areas.len(), 4);
    assert_eq!(planned.tour.as_ref().unwrap().stops().len(), 4);
    let figures = planned.figures.unwrap();
    assert!((figures.length - 623.8).abs() < 0.06, "{}", figures.length);
    assert_eq!(figures.disc.coverable, 6900);
    let expected = 0.7020 * 6900.0;
    assert!(
        (figures.disc.covered as f64 - expected).abs() <= 2.5,
        "{:?}",
        figures.disc
    );
}

#[test]
fn a_coverage_is_planned_up_to_the_requested_extent() {
    let open = scenario("coverage_open", &[]);
    let goals = plan(&open, Some("cover"), Extent::Goals(17)).unwrap().goals;
    assert_eq!(goals.len(), 17);
    let way = plan(&open, None, Extent::Length(100.0)).unwrap();
    let length = way.figures.unwrap().length;
    assert!(length <= 100.0 && length > 85.0, "{length}");
}

#[test]
fn refusals_list_the_processes() {
    let chase = scenario("chase", &[]);
    let error = Patrol::from_scenario(&chase, None, None)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("patrol_awg") && error.contains("pursuer"),
        "{error}"
    );
    let octagon = scenario("patrol_octagon", &[]);
    let error = Patrol::from_scenario(&octagon, Some("observer"), None).unwrap_err();
    assert!(error.to_string().contains("patrol"), "{error}");
    let error = plan(&octagon, None, Extent::Loops(1))
        .unwrap_err()
        .to_string();
    assert!(error.contains("coverage_chebyshev"), "{error}");
}
