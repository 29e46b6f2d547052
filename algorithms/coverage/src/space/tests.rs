use testing::rectangle;

use super::*;

/// A workplace of 10 m with a square in its middle, for a robot of 0.1 m.
fn around_a_square() -> Space {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let square = rectangle([5.0, 5.0], [2.5, 2.5]);
    let workplace = Workplace::new(bounds, 0.1, &[square], 0.01).unwrap();
    let parts = Decomposition::new(&workplace).unwrap();
    Space::new(&workplace, &parts, Point2::new(1.0, 8.0))
}

#[test]
fn a_leg_ends_before_what_it_would_hit() {
    let space = around_a_square();
    let (from, to) = (Point2::new(1.0, 5.0), Point2::new(9.0, 5.0));
    let end = space.clear_to(from, to);
    assert!(end.x < 2.4 && end.x > 2.4 - 1e-5 && end.y == 5.0, "{end}");
    assert!(!space.is_clear(from, to));
    let past = Point2::new(1.0, 9.0);
    assert_eq!(space.clear_to(from, past), past);
    assert!(space.is_clear(from, past));
}

#[test]
fn a_leg_along_the_side_of_an_obstacle_is_clear() {
    let space = around_a_square();
    let (from, to) = (Point2::new(2.4, 1.0), Point2::new(2.4, 9.0));
    assert!(space.is_clear(from, to));
    assert_eq!(space.clear_to(from, to), to);
}

#[test]
fn a_ray_ends_at_the_border_of_the_free_space() {
    let space = around_a_square();
    let end = space.ray_end(Point2::new(1.0, 9.0), Vector2::new(-2.0, 0.5));
    assert!((end - Point2::new(0.1, 9.225)).norm() < 1e-12, "{end}");
    let still = Point2::new(1.0, 9.0);
    assert_eq!(space.ray_end(still, Vector2::zeros()), still);
}

#[test]
fn the_legs_between_rectangles_each_stay_in_one_that_is_free() {
    let space = around_a_square();
    let (mut from, goal) = (Point2::new(1.0, 5.0), Point2::new(9.0, 5.0));
    let (first, last) = (space.member_at(from), space.member_at(goal));
    let mut turn = 0.0;
    let legs = space.legs(first, last, goal, || {
        turn = (turn + 0.618) % 1.0;
        turn
    });
    assert_eq!(legs.len(), 5, "two borders, two points each, and the goal");
    for (to, within) in legs {
        assert!(within.contains(from) && within.contains(to));
        assert!(space.is_clear(from, to));
        from = to;
    }
    assert_eq!(from, goal);
}

#[test]
fn other_components_are_unreachable() {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(10.0, 10.0),
    };
    let wall = rectangle([7.0, 5.0], [0.5, 5.0]);
    let workplace = Workplace::new(bounds, 0.1, &[wall], 0.01).unwrap();
    let parts = Decomposition::new(&workplace).unwrap();
    let space = Space::new(&workplace, &parts, Point2::new(1.0, 1.0));
    assert!(space.contains(Point2::new(6.0, 5.0)));
    assert!(!space.contains(Point2::new(9.0, 5.0)));
    assert_eq!(space.nearest(Point2::new(9.0, 5.0)), Point2::new(6.4, 5.0));
    let far = space.clear_to(Point2::new(1.0, 5.0), Point2::new(9.0, 5.0));
    assert!(far.x <= 6.4);
}
