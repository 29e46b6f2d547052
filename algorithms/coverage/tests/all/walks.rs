//! Plans driven on random maps.

use chaotic_maps::{Key, KeyKind, Source as _};
use coverage::decomposition::Decomposition;
use coverage::plan::{CoveragePlan, PlanError, PlanSpec, frames, map};
use coverage::tour::{Iterations, Route};
use coverage::transit::Transit;
use nalgebra::Point2;

use coverage::workplace::Workplace;
use geometry::shape::{Aabb, Convex};

use crate::random_map::RandomMaps;
use crate::random_map::drive::{Driven, drive, interpolate};

fn spec(transit: Transit) -> PlanSpec {
    PlanSpec {
        route: Route::Walk,
        iterations: Iterations::Each(3),
        transit,
        loops: 2,
    }
}

#[test]
fn every_reachable_rectangle_is_visited_without_collisions() {
    let mut maps = RandomMaps::new(11);
    let mut legs = 0;
    for count in [0, 1, 2, 3, 5, 8, 12].repeat(20) {
        let workplace = maps.next_map(count);
        let Ok(decomposition) = Decomposition::new(&workplace) else {
            continue;
        };
        let driven: Driven = drive(&workplace, &decomposition, &mut maps, 2);
        assert_eq!(driven.collisions, 0);
        assert_eq!(driven.missed, 0);
        legs += driven.legs;
    }
    assert!(legs > 5_000);
}

#[test]
fn direct_transits_take_exactly_two_sub_goals() {
    let workplace = RandomMaps::new(3).next_map(8);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let start = decomposition.rectangles()[0].center();
    let source = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
    let mut plan = CoveragePlan::new(decomposition, start, &spec(Transit::Direct), source).unwrap();
    while plan.step().is_some() {}
    let dwell = plan.dwell();
    assert!(dwell.transits > 0);
    assert_eq!(dwell.leaving, dwell.transits);
    assert_eq!(dwell.crossing, dwell.transits);
    assert_eq!((dwell.longest, dwell.capped), (2, 0));
}

#[test]
fn frames_of_a_loop_are_those_of_its_sub_goals() {
    let mut maps = RandomMaps::new(8);
    for count in [0, 1, 4, 8] {
        let decomposition = loop {
            if let Ok(decomposition) = Decomposition::new(&maps.next_map(count)) {
                break decomposition;
            }
        };
        let start = decomposition.rectangles()[0].center();
        let mut source = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
        let again = source.clone();
        let spec = spec(Transit::Direct);
        let mut plan = CoveragePlan::new(decomposition, start, &spec, again).unwrap();
        let frames = frames(plan.decomposition(), plan.tour());
        for frame in frames.iter().chain(&frames) {
            let expected = map(source.next_symmetric(), frame);
            assert_eq!(plan.step().unwrap().waypoint.point, expected);
        }
        assert_eq!(plan.step(), None, "the plan has two loops");
    }
}

#[test]
fn a_wait_is_ended_by_its_cap() {
    let workplace = RandomMaps::new(5).next_map(12);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let start = decomposition.rectangles()[0].center();
    let source = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
    let spec = spec(Transit::Wait { cap: 2 });
    let mut plan = CoveragePlan::new(decomposition, start, &spec, source).unwrap();
    while plan.step().is_some() {}
    assert!(plan.dwell().capped > 0);
    // Two on either side, and one more on each to end it.
    assert!(plan.dwell().longest <= 6);
    assert_eq!(plan.lap(), 2);
}

#[test]
fn endless_loops_continue() {
    let workplace = RandomMaps::new(9).next_map(3);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let start = decomposition.rectangles()[0].center();
    let source = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
    let spec = PlanSpec {
        loops: 0,
        ..spec(Transit::Direct)
    };
    let mut plan = CoveragePlan::new(decomposition, start, &spec, source).unwrap();
    for number in 0..10_000 {
        assert_eq!(plan.step().unwrap().waypoint.number, number);
    }
    assert!(plan.lap() > 50);
}

#[test]
fn a_start_in_an_obstacle_and_a_wait_of_nothing_are_refused() {
    let workplace = RandomMaps::new(9).next_map(0);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let source = || Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
    let start = Point2::new(5.0, 12.0);
    let plan = CoveragePlan::new(decomposition.clone(), start, &PlanSpec::default(), source());
    let error = plan.unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("start = (5, 12): not in free space")
    );
    let inside = Point2::new(5.0, 5.0);
    let plan = CoveragePlan::new(
        decomposition,
        inside,
        &spec(Transit::Wait { cap: 0 }),
        source(),
    );
    assert_eq!(plan.unwrap_err(), PlanError::NoWait);
}

#[test]
fn obstacles_of_any_shape_are_passed_without_contact() {
    let mut maps = RandomMaps::new(21);
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    };
    for tolerance in [0.05, 0.3].repeat(10) {
        let mut within = |low: f64, high: f64| low + (high - low) * maps.unit();
        let mut parts = Vec::new();
        for _ in 0..3 {
            let center = Point2::new(within(1.0, 9.0), within(1.0, 9.0));
            parts.push(Convex::disc(center, within(0.2, 1.0)));
            let center = Point2::new(within(1.0, 9.0), within(1.0, 9.0));
            let half = [within(0.2, 1.5), within(0.2, 1.5)];
            parts.push(Convex::rectangle(center, half, within(-3.0, 3.0)));
            let corner = Point2::new(within(1.0, 7.0), within(1.0, 7.0));
            let tip = corner + nalgebra::Vector2::new(within(-1.0, 2.0), within(1.0, 3.0));
            parts.push(Convex::polygon(&[
                corner,
                corner + nalgebra::Vector2::new(2.0, 0.3),
                tip,
            ]));
        }
        let workplace = Workplace::from_parts(bounds, 0.1, &parts, tolerance).unwrap();
        let loss = workplace.loss();
        assert!(loss.area > 0.0 && loss.share < tolerance, "{loss:?}");
        let decomposition = Decomposition::new(&workplace).unwrap();
        let start = decomposition.rectangles()[0].center();
        let source = Key::from_seed(KeyKind::Keyed, 1).source().unwrap();
        let mut plan =
            CoveragePlan::new(decomposition, start, &spec(Transit::Direct), source).unwrap();
        let mut last = start;
        while let Some(goal) = plan.step() {
            let p = goal.waypoint.point;
            for p in interpolate(last, p, 0.05) {
                assert!(
                    parts.iter().all(|part| part.distance(p) >= 0.1 - 1e-9),
                    "{p}"
                );
            }
            last = p;
        }
    }
}
