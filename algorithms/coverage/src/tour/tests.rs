use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;

use super::*;
use crate::workplace::Workplace;

/// Case 1 of the paper: left 0, right 1, bottom 2, top 3.
fn case_1() -> Decomposition {
    let hole = Convex::Box(Aabb {
        min: Point2::new(2.5, 2.5),
        max: Point2::new(7.5, 7.5),
    });
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    };
    let workplace = Workplace::from_parts(bounds, 0.0, &[hole], 0.1).unwrap();
    Decomposition::new(&workplace).unwrap()
}

fn order(tour: &Tour) -> Vec<(usize, u32)> {
    let stops = tour.stops().iter();
    stops.map(|s| (s.rectangle, s.iterations)).collect()
}

#[test]
fn a_walk_passes_through_to_where_it_has_not_been() {
    let each = Iterations::Each(5);
    let tour = Tour::new(&case_1(), 0, &Route::Walk, &each).unwrap();
    // 0 → 2 → 1 → 3, and back through 1 and 2 although 3 touches 0.
    let expected = [(0, 5), (2, 5), (1, 5), (3, 5), (1, 0), (2, 0)];
    assert_eq!(order(&tour), expected);
    assert_eq!(tour.iterations(), 20);
}

#[test]
fn a_cycle_begins_where_the_robot_is() {
    let route = Route::Cycle(vec![0, 3, 1, 2]);
    let by = Iterations::By(vec![50, 50, 25, 25]);
    let tour = Tour::new(&case_1(), 1, &route, &by).unwrap();
    assert_eq!(order(&tour), [(1, 50), (2, 25), (0, 50), (3, 25)]);
}

#[test]
fn iterations_follow_the_areas() {
    let all = Iterations::InAll(150);
    let tour = Tour::new(&case_1(), 0, &Route::Walk, &all).unwrap();
    assert_eq!(order(&tour)[..4], [(0, 50), (2, 25), (1, 50), (3, 25)]);
    let few = Tour::new(&case_1(), 0, &Route::Walk, &Iterations::InAll(2)).unwrap();
    assert_eq!(few.iterations(), 4);
}

#[test]
fn routes_that_cannot_be_driven_are_refused_with_what_to_change() {
    let refusal = |route: &[usize], iterations: &Iterations| {
        Tour::new(&case_1(), 0, &Route::Cycle(route.to_vec()), iterations).unwrap_err()
    };
    let each = Iterations::Each(1);
    let error = refusal(&[0, 1, 2], &each);
    assert_eq!(error, TourError::NotJoined { from: 0, to: 1 });
    assert!(error.to_string().contains("add one to `bridges`"));
    // A loop ends at its start.
    let error = refusal(&[0, 2, 1], &each);
    assert_eq!(error, TourError::NotJoined { from: 1, to: 0 });
    let error = refusal(&[1, 2], &each);
    assert_eq!(error, TourError::StartNotOnRoute { start: 0 });
    let (rectangle, last) = (4, 3);
    let error = refusal(&[0, 4], &each);
    assert_eq!(error, TourError::NoSuchRectangle { rectangle, last });
    let error = refusal(&[0, 2], &Iterations::By(vec![1, 2]));
    assert!(error.to_string().contains("2 numbers for 4 rectangles"));
    let error = refusal(&[0, 2], &Iterations::InAll(0));
    assert_eq!(error, TourError::NothingToDo);
}
