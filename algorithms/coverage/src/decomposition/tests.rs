use geometry::shape::Shape;
use testing::rectangle;

use super::*;

fn corners(r: &Aabb) -> [f64; 4] {
    [r.min.x, r.min.y, r.max.x, r.max.y]
}

fn workplace(radius: f64, obstacles: &[[f64; 4]]) -> Workplace {
    let shapes: Vec<Shape> = obstacles
        .iter()
        .map(|&[x0, y0, x1, y1]| {
            rectangle(
                [0.5 * (x0 + x1), 0.5 * (y0 + y1)],
                [0.5 * (x1 - x0), 0.5 * (y1 - y0)],
            )
        })
        .collect();
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(10.0, 10.0),
    };
    Workplace::new(bounds, radius, &shapes, 0.1).unwrap()
}

const CASE_1: [[f64; 4]; 1] = [[2.5, 2.5, 7.5, 7.5]];
const CASE_2: [[f64; 4]; 2] = [[0.0, 3.5, 3.0, 6.5], [7.0, 3.5, 10.0, 6.5]];

fn near(a: [f64; 4], b: [f64; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn case_1_of_the_paper_gives_two_large_and_two_half_as_large_rectangles() {
    let decomposition = Decomposition::new(&workplace(0.0, &CASE_1)).unwrap();
    let areas: Vec<f64> = (0..4).map(|r| decomposition.area_of(r)).collect();
    assert_eq!(areas, [25.0, 25.0, 12.5, 12.5]);
    let expected = [
        [0.0, 0.0, 2.5, 10.0],
        [7.5, 0.0, 10.0, 10.0],
        [2.5, 0.0, 7.5, 2.5],
        [2.5, 7.5, 7.5, 10.0],
    ];
    for (r, expected) in decomposition.rectangles().iter().zip(expected) {
        assert_eq!(corners(r), expected);
    }
    let joined: Vec<[usize; 2]> = decomposition.bridges().iter().map(|b| b.between).collect();
    assert_eq!(joined, [[0, 2], [0, 3], [1, 2], [1, 3]]);
    // The paper's T_CD: the upper part of the left side and of the middle together.
    let bridge = decomposition.bridge(3, 0).unwrap();
    assert_eq!(corners(&bridge.rectangle), [0.0, 7.5, 7.5, 10.0]);
    assert_eq!(decomposition.components(), 1);
}

#[test]
fn case_2_of_the_paper_gives_three_rectangles_one_above_the_other() {
    let decomposition = Decomposition::new(&workplace(0.1, &CASE_2)).unwrap();
    let expected = [
        [0.1, 0.1, 9.9, 3.4],
        [0.1, 6.6, 9.9, 9.9],
        [3.1, 3.4, 6.9, 6.6],
    ];
    assert_eq!(decomposition.rectangles().len(), 3);
    for (r, expected) in decomposition.rectangles().iter().zip(expected) {
        assert!(near(corners(r), expected), "{r:?}");
    }
    let bridge = decomposition.bridge(0, 2).unwrap();
    assert!(near(corners(&bridge.rectangle), [3.1, 0.1, 6.9, 6.6]));
    assert!(decomposition.bridge(0, 1).is_none());
}

#[test]
fn an_open_workplace_is_one_rectangle_without_bridges() {
    let decomposition = Decomposition::new(&workplace(0.1, &[])).unwrap();
    assert_eq!(decomposition.rectangles().len(), 1);
    assert!(decomposition.bridges().is_empty());
    assert_eq!(decomposition.rectangle_at(Point2::new(0.05, 5.0)), None);
    let (nearest, distance) = decomposition
        .nearest_rectangle(Point2::new(0.05, 5.0))
        .unwrap();
    assert!(nearest == 0 && (distance - 0.05).abs() < 1e-12);
    let nowhere = Point2::new(f64::NAN, 0.0);
    assert_eq!(decomposition.nearest_rectangle(nowhere), None);
}

#[test]
fn obstacles_that_touch_at_a_corner_split_the_free_space() {
    let touching = [[0.0, 0.0, 5.0, 5.0], [5.0, 5.0, 10.0, 10.0]];
    let decomposition = Decomposition::new(&workplace(0.1, &touching)).unwrap();
    assert_eq!(decomposition.components(), 2);
    let unreachable = decomposition.unreachable_from(0);
    assert_eq!(
        (unreachable.components, unreachable.rectangles.len()),
        (1, 1)
    );
    assert!((unreachable.area - 4.8 * 4.8).abs() < 1e-9);
}

#[test]
fn an_enclosed_pocket_is_reported_as_unreachable() {
    let ring = [
        [3.0, 3.0, 7.0, 4.0],
        [3.0, 6.0, 7.0, 7.0],
        [3.0, 3.0, 4.0, 7.0],
        [6.0, 3.0, 7.0, 7.0],
    ];
    let decomposition = Decomposition::new(&workplace(0.1, &ring)).unwrap();
    let outside = decomposition.rectangle_at(Point2::new(1.0, 1.0)).unwrap();
    let unreachable = decomposition.unreachable_from(outside);
    assert!((unreachable.area - 1.8 * 1.8).abs() < 1e-9);
    let inside = decomposition.rectangle_at(Point2::new(5.0, 5.0)).unwrap();
    assert_eq!(unreachable.rectangles, [inside]);
    let seen_from_inside = decomposition.unreachable_from(inside);
    assert!((seen_from_inside.area + 3.24 - decomposition.area()).abs() < 1e-9);
}

#[test]
fn a_workplace_without_free_space_is_refused() {
    let halves = [[0.0, 0.0, 5.0, 10.0], [5.0, 0.0, 10.0, 10.0]];
    let error = Decomposition::new(&workplace(0.1, &halves)).unwrap_err();
    assert_eq!(error, DecompositionError::NoFreeSpace { radius: 0.1 });
    assert!(error.to_string().contains("take fewer"));
}

#[test]
fn a_bridge_may_be_added_only_through_free_space() {
    let workplace = workplace(0.1, &CASE_2);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let add = |between: [usize; 2], [x0, y0, x1, y1]: [f64; 4]| {
        let rectangle = Aabb {
            min: Point2::new(x0, y0),
            max: Point2::new(x1, y1),
        };
        decomposition
            .clone()
            .with_bridge(&workplace, between, rectangle)
    };
    let back = add([1, 0], [3.1, 0.1, 6.9, 9.9]).unwrap();
    assert!(back.bridge(0, 1).is_some() && back.bridge(1, 0).is_some());
    assert_eq!(
        back.neighbours(0).map(|(to, _)| to).collect::<Vec<_>>(),
        [1, 2]
    );
    let refusal = |between, corners| add(between, corners).unwrap_err();
    for wrong in [
        [3.0, 0.1, 6.9, 9.9],
        [3.1, 0.0, 6.9, 9.9],
        [6.9, 0.1, 3.1, 9.9],
        [f64::NAN, 0.1, 6.9, 9.9],
    ] {
        let error = refusal([0, 1], wrong);
        assert!(matches!(error, BridgeError::NotFree { .. }), "{error}");
    }
    let error = refusal([0, 1], [3.1, 0.1, 6.9, 6.6]);
    assert!(
        error
            .to_string()
            .ends_with("does not overlap rectangle 1; make it longer")
    );
    let error = refusal([0, 2], [3.1, 0.1, 6.9, 9.9]);
    assert_eq!(error, BridgeError::Joined { between: [0, 2] });
    let error = refusal([0, 3], [3.1, 0.1, 6.9, 9.9]);
    assert_eq!(
        error,
        BridgeError::NoSuchRectangle {
            rectangle: 3,
            last: 2
        }
    );
}
