//! Homotopy classes: known numbers, their order, and that all are different.

use crate::scenes::{any_point, any_space, space};
use geometry::shape::Convex;
use nalgebra::Point2;
use navigation::tangent_graph::{
    PathLeg, ShortestPath, TangentGraph, k_shortest_classes, shortest_once,
};
use proptest::prelude::*;

const RADIUS: f64 = 0.2;

fn disc(x: f64, y: f64, radius: f64) -> Convex {
    Convex::disc(Point2::new(x, y), radius)
}

fn point(x: f64, y: f64) -> Point2<f64> {
    Point2::new(x, y)
}

/// Crossings of the path with the rays that lead up from the centres of discs, in order: the disc's
/// index, and whether the path goes to the right. Crossings back and forth cancel: two paths are of
/// one class if and only if the words are the same.
fn word(path: &ShortestPath, discs: &[Convex]) -> Vec<(usize, bool)> {
    let mut points = Vec::new();
    for leg in &path.legs {
        points.extend((0..=200).map(|i| leg.at(f64::from(i) / 200.0)));
    }
    let mut word: Vec<(usize, bool)> = Vec::new();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let mut crossed: Vec<(usize, bool)> = Vec::new();
        for (i, disc) in discs.iter().enumerate() {
            let Convex::Disc { center, .. } = disc else {
                panic!("discs only")
            };
            let right = a.x <= center.x && b.x > center.x;
            if (right || (b.x <= center.x && a.x > center.x)) && a.y.max(b.y) > center.y {
                crossed.push((i, right));
            }
        }
        for (i, right) in crossed {
            if word.last() == Some(&(i, !right)) {
                word.pop();
            } else {
                word.push((i, right));
            }
        }
    }
    word
}

fn check(paths: &[ShortestPath], discs: &[Convex]) {
    assert!(
        paths
            .windows(2)
            .all(|pair| pair[0].length <= pair[1].length + 1e-12)
    );
    let words: Vec<_> = paths.iter().map(|path| word(path, discs)).collect();
    for (i, a) in words.iter().enumerate() {
        assert!(words.iter().skip(i + 1).all(|b| a != b), "{words:?}");
    }
}

fn classes(discs: &[Convex], from: Point2<f64>, to: Point2<f64>, k: usize) -> Vec<ShortestPath> {
    let space = space(discs.to_vec());
    let paths = k_shortest_classes(&space, RADIUS, from, to, k, f64::INFINITY).unwrap();
    check(&paths, discs);
    paths
}

#[test]
fn in_open_space_there_is_one_class_and_around_a_disc_there_are_two() {
    let (from, to) = (point(-3.0, 0.1), point(3.0, 0.1));
    let open = classes(&[], from, to, 9);
    assert_eq!((open.len(), open[0].length), (1, 6.0));
    // Whether the disc is in the way or not.
    for y in [0.0, 2.0, -1.4] {
        let paths = classes(&[disc(0.0, y, 0.8)], from, to, 9);
        assert_eq!(paths.len(), 2, "{y}");
    }
}

#[test]
fn around_two_discs_in_a_row_the_first_four_classes_pass_each_on_either_side() {
    let discs = [disc(-1.5, 0.0, 0.6), disc(1.5, 0.1, 0.6)];
    let paths = classes(&discs, point(-4.0, 0.0), point(4.0, 0.0), 4);
    let mut words: Vec<_> = paths.iter().map(|path| word(path, &discs)).collect();
    words.sort();
    let [a, b] = [(0, true), (1, true)];
    assert_eq!(words, [vec![], vec![a], vec![a, b], vec![b]]);
    assert!(paths[0].length < paths[3].length);
}

#[test]
fn between_two_discs_side_by_side_there_are_three_direct_classes() {
    let discs = [disc(0.0, 1.0, 0.6), disc(0.0, -1.0, 0.6)];
    let paths = classes(&discs, point(-4.0, 0.0), point(4.0, 0.0), 3);
    assert_eq!(paths[0].length, 8.0);
    assert!((paths[1].length - paths[2].length).abs() < 1e-9);
    assert!(paths[1].length > 8.2);
}

#[test]
fn overlapping_discs_are_one_obstacle() {
    let discs = [disc(0.0, 0.3, 0.5), disc(0.0, -0.3, 0.5)];
    let space = space(discs.to_vec());
    let (from, to) = (point(-4.0, 0.0), point(4.0, 0.0));
    let paths = k_shortest_classes(&space, RADIUS, from, to, 9, f64::INFINITY).unwrap();
    assert_eq!(paths.len(), 2);
}

#[test]
fn no_class_is_longer_than_allowed() {
    let discs = [disc(0.0, 1.0, 0.6), disc(0.0, -1.0, 0.6)];
    let space = space(discs.to_vec());
    let (from, to) = (point(-4.0, 0.0), point(4.0, 0.0));
    let count = |most: f64| {
        k_shortest_classes(&space, RADIUS, from, to, 9, most)
            .unwrap()
            .len()
    };
    assert_eq!([count(7.9), count(8.1)], [0, 1]);
    assert!(count(9.5) >= 3);
}

#[test]
fn a_blocked_goal_has_no_class() {
    let discs = [disc(3.0, 0.0, 0.5)];
    assert!(classes(&discs, point(-3.0, 0.0), point(3.0, 0.0), 4).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn classes_among_discs_are_different_and_begin_with_the_shortest(
        discs in proptest::collection::vec((-3.0..3.0f64, -3.0..3.0f64, 0.1..0.5f64), 0..6),
        from in -3.5..3.5f64,
    ) {
        // Apart, so that each is an obstacle of its own.
        let mut apart: Vec<Convex> = Vec::new();
        for (x, y, r) in discs {
            let free = |other: &Convex| other.distance(point(x, y)) > r + 2.0 * RADIUS + 0.05;
            if apart.iter().all(free) {
                apart.push(disc(x, y, r));
            }
        }
        let (from, to) = (point(-4.5, from), point(4.5, 0.0));
        let paths = classes(&apart, from, to, 8);
        let space = space(apart.clone());
        let shortest = shortest_once(&space, RADIUS, from, to).unwrap().unwrap();
        prop_assert!((paths[0].length - shortest.length).abs() < 1e-9);
        prop_assert!(paths.len() >= 8.min(1 + apart.len()), "{} of {}", paths.len(), apart.len());
        // A query in a graph of all sites finds the same.
        let all = TangentGraph::new(&space, RADIUS).unwrap().classes(from, to, 8, f64::INFINITY);
        prop_assert_eq!(all.len(), paths.len());
        for (a, b) in all.iter().zip(&paths) {
            prop_assert!((a.length - b.length).abs() < 1e-9);
        }
    }

    #[test]
    fn the_first_class_is_the_shortest_path(space in any_space(0..5), a in any_point(), b in any_point()) {
        let classes = k_shortest_classes(&space, RADIUS, a, b, 3, f64::INFINITY).unwrap();
        let shortest = shortest_once(&space, RADIUS, a, b).unwrap();
        prop_assert_eq!(classes.is_empty(), shortest.is_none());
        if let (Some(first), Some(shortest)) = (classes.first(), shortest) {
            prop_assert!((first.length - shortest.length).abs() < 1e-9);
        }
        for path in &classes {
            let sum: f64 = path.legs.iter().map(PathLeg::length).sum();
            prop_assert!((sum - path.length).abs() < 1e-7, "{} {}", sum, path.length);
        }
    }
}
