//! Shortest paths: known lengths, properties of every path, and a brute-force search.

use crate::scenes::{RADIUS, any_parts, any_point, any_space, city, space, unit};
use geometry::shape::Convex;
use nalgebra::{Point2, Vector2};
use navigation::tangent_graph::{GraphError, PUSH_OUT, PathLeg, ShortestPath, TangentGraph};
use planner_view::free_space::FreeSpace;
use proptest::prelude::*;

const START: Point2<f64> = Point2::new(-4.5, 7.5);
const EXIT: Point2<f64> = Point2::new(9.0, 0.0);

/// Unit vectors of travel at the beginning and the end of a leg.
fn headings(leg: &PathLeg) -> (Vector2<f64>, Vector2<f64>) {
    match leg {
        PathLeg::Segment { from, to } => ((to - from).normalize(), (to - from).normalize()),
        PathLeg::Arc(arc) => (arc.heading(0.0), arc.heading(1.0)),
    }
}

/// Checks the properties of every path. Ends that were pushed out of a piece may differ by that
/// distance.
fn check(space: &FreeSpace, radius: f64, path: &ShortestPath, ends: [Point2<f64>; 2]) {
    let inside = ends.map(|p| !space.is_free(p, radius));
    let sum: f64 = path.legs.iter().map(PathLeg::length).sum();
    assert!((sum - path.length).abs() < 1e-9, "{sum} {}", path.length);
    let first = path.legs.first().map_or(ends[1], |leg| leg.at(0.0));
    let last = path.legs.last().map_or(ends[0], |leg| leg.at(1.0));
    assert!((first - ends[0]).norm() < 1e-9 && (last - ends[1]).norm() < 1e-9);
    for pair in path.legs.windows(2) {
        assert!(
            (pair[0].at(1.0) - pair[1].at(0.0)).norm() < 1e-7,
            "{pair:?}"
        );
        let first = inside[0] && pair[0] == path.legs[0];
        let pushed = first || (inside[1] && Some(&pair[1]) == path.legs.last());
        if !pushed && pair.iter().all(|leg| leg.length() > 1e-5) {
            let (end, begin) = (headings(&pair[0]).1, headings(&pair[1]).0);
            assert!(
                (end - begin).norm() < 1e-6,
                "a kink at {}: {pair:?}",
                pair[1].at(0.0)
            );
        }
    }
    for (i, leg) in path.legs.iter().enumerate() {
        let pushed = (inside[0] && i == 0) || (inside[1] && i + 1 == path.legs.len());
        if !pushed {
            let free = match leg {
                PathLeg::Segment { from, to } => space.segment_is_free(*from, *to, radius - 1e-7),
                PathLeg::Arc(arc) => space.arc_is_free(arc, radius - 1e-7),
            };
            assert!(free, "{leg:?}");
        }
    }
}

#[test]
fn the_escape_path_of_the_city_has_its_known_length() {
    let space = city();
    for (radius, length) in [(RADIUS, 16.987), (0.0525, 16.780), (1e-6, 16.593)] {
        let graph = TangentGraph::new(&space, radius).unwrap();
        let path = graph.shortest(START, EXIT).unwrap();
        assert!(
            (path.length - length).abs() < 0.002,
            "{radius}: {}",
            path.length
        );
        check(&space, radius, &path, [START, EXIT]);
        assert_eq!(graph.distance(START, EXIT), Some(path.length));
        let towards = graph.towards(EXIT);
        assert!((towards.distance(START).unwrap() - path.length).abs() < 1e-9);
        assert!((graph.distance(EXIT, START).unwrap() - path.length).abs() < 1e-9);
    }
}

#[test]
fn around_a_disc_the_length_is_that_of_the_formula() {
    let space = space(vec![Convex::disc(Point2::origin(), 0.8)]);
    let graph = TangentGraph::new(&space, 0.2).unwrap();
    assert_eq!((graph.sites(), graph.tangents()), (1, 0));
    for angle in [0.0, 0.7, 2.0, 3.0, -1.0, -3.1] {
        let (a, b) = (
            Point2::origin() + unit(angle) * 2.0,
            Point2::origin() - unit(angle) * 2.0,
        );
        let path = graph.shortest(a, b).unwrap();
        let expected = 2.0 * 3.0_f64.sqrt() + core::f64::consts::FRAC_PI_3;
        assert!((path.length - expected).abs() < 1e-9, "{}", path.length);
        check(&space, 0.2, &path, [a, b]);
        assert!((graph.towards(b).distance(a).unwrap() - expected).abs() < 1e-9);
    }
}

#[test]
fn around_a_corner_the_length_is_that_of_the_formula() {
    let block = Convex::rectangle(Point2::new(-2.0, -2.0), [2.0, 2.0], 0.0);
    let space = space(vec![block]);
    let graph = TangentGraph::new(&space, 0.5).unwrap();
    let (a, b) = (Point2::new(0.5, -2.0), Point2::new(-2.0, 0.5));
    let path = graph.shortest(a, b).unwrap();
    assert!((path.length - (4.0 + 0.25 * core::f64::consts::PI)).abs() < 1e-9);
    assert_eq!(path.legs.len(), 3, "{:?}", path.legs);
    check(&space, 0.5, &path, [a, b]);
}

#[test]
fn lines_of_sight_and_ends_that_are_one_need_no_graph() {
    let graph = TangentGraph::new(&city(), RADIUS).unwrap();
    let there = Point2::new(4.5, 7.5);
    let path = graph.shortest(START, there).unwrap();
    assert_eq!(
        path.legs,
        [PathLeg::Segment {
            from: START,
            to: there
        }]
    );
    assert_eq!(path.length, 9.0);
    assert_eq!(
        graph.shortest(START, START).unwrap(),
        ShortestPath::default()
    );
    assert_eq!(graph.towards(START).distance(START), Some(0.0));
    assert_eq!(graph.towards(START).lower_bound(START), 0.0);
}

#[test]
fn unreachable_points_have_no_path() {
    let wall = |x: f64, y: f64, a: f64, b: f64| Convex::rectangle(Point2::new(x, y), [a, b], 0.0);
    // A closed court whose walls only touch, and one with a gap slightly too narrow.
    let gap = 2.0 * RADIUS - 1e-6;
    let court = |x: f64, gap: f64| {
        vec![
            wall(x - 1.0, 0.0, 0.1, 0.9),
            wall(x + 1.0, -gap, 0.1, 0.9),
            wall(x, 1.0, 1.1, 0.1),
            wall(x, -1.0 - gap, 1.1, 0.1),
        ]
    };
    for gap in [0.0, gap] {
        let space = space(court(0.0, gap));
        let graph = TangentGraph::new(&space, RADIUS).unwrap();
        let (inside, outside) = (Point2::new(0.1, 0.2), Point2::new(3.0, 0.0));
        assert_eq!(graph.shortest(inside, outside), None);
        assert_eq!(graph.distance(outside, inside), None);
        let towards = graph.towards(inside);
        assert_eq!(towards.distance(outside), None);
        assert_eq!(towards.lower_bound(outside), f64::INFINITY);
        assert!(towards.distance(Point2::new(-0.5, -0.4)).is_some());
    }
    let open = space(court(0.0, gap + 2e-6));
    let graph = TangentGraph::new(&open, RADIUS).unwrap();
    assert!(
        graph
            .distance(Point2::new(0.1, 0.2), Point2::new(3.0, 0.0))
            .is_some()
    );
}

#[test]
fn a_start_in_contact_is_pushed_out_and_one_deeper_inside_is_refused() {
    let space = city();
    let graph = TangentGraph::new(&space, RADIUS).unwrap();
    // At a wall, and at a corner.
    let wall = Point2::new(-4.5, 8.0 - RADIUS);
    let corner = Point2::new(-4.0, 5.0) + unit(-2.4) * RADIUS;
    for (touching, outward) in [(wall, -Vector2::y()), (corner, unit(-2.4))] {
        let exact = graph.shortest(touching, EXIT).unwrap();
        check(&space, RADIUS, &exact, [touching, EXIT]);
        for depth in [1e-10, 1e-7, 0.9 * PUSH_OUT] {
            let inside = touching - outward * depth;
            let path = graph.shortest(inside, EXIT).unwrap();
            check(&space, RADIUS, &path, [inside, EXIT]);
            assert!((path.length - exact.length).abs() < 3.0 * depth + 1e-9);
            let towards = graph.towards(EXIT).distance(inside).unwrap();
            assert!((towards - path.length).abs() < 1e-9);
        }
        let deep = touching - outward * (1.1 * PUSH_OUT);
        assert_eq!(graph.shortest(deep, EXIT), None);
        assert_eq!(graph.distance(EXIT, deep), None);
        assert_eq!(graph.towards(deep).distance(EXIT), None);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(graph.distance(Point2::new(bad, 0.0), EXIT), None);
        assert_eq!(graph.towards(Point2::new(0.0, bad)).distance(EXIT), None);
        assert_eq!(graph.towards(EXIT).lower_bound(Point2::new(bad, 0.0)), 0.0);
    }
}

#[test]
fn impossible_radii_are_named() {
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = TangentGraph::new(&city(), radius).unwrap_err();
        assert!(matches!(error, GraphError::Radius(_)));
        assert!(error.to_string().starts_with("radius ="), "{error}");
    }
    // Larger than the streets: no place is free, and there is no panic.
    let graph = TangentGraph::new(&city(), 2.0).unwrap();
    assert_eq!(graph.distance(START, EXIT), None);
}

#[test]
fn a_wall_of_many_pieces_is_one_wall() {
    let whole = vec![Convex::rectangle(Point2::new(0.0, 0.5), [0.5, 2.5], 0.0)];
    let cut = |count: usize| -> Vec<Convex> {
        let height = 5.0 / count as f64;
        (0..count)
            .map(|i| {
                let y = -2.0 + height * (i as f64 + 0.5);
                Convex::rectangle(Point2::new(0.0, y), [0.5, 0.5 * height], 0.0)
            })
            .collect()
    };
    // Pieces side by side, overlapping, and one piece twice.
    let mut doubled = cut(3);
    doubled.extend(whole.clone());
    doubled.extend(whole.clone());
    let expected = TangentGraph::new(&space(whole), 0.2).unwrap();
    for count in [2, 7, 40] {
        assert_eq!(
            TangentGraph::new(&space(cut(count)), 0.2).unwrap().sites(),
            4
        );
    }
    for parts in [cut(2), cut(7), cut(40), doubled] {
        let graph = TangentGraph::new(&space(parts), 0.2).unwrap();
        for i in 0..40 {
            let a = Point2::new(-3.0 + 0.05 * f64::from(i), -3.0 + 0.15 * f64::from(i));
            let b = Point2::new(2.0, 1.0 - 0.1 * f64::from(i));
            let (ours, theirs) = (graph.distance(a, b), expected.distance(a, b));
            match (ours, theirs) {
                (Some(ours), Some(theirs)) => assert!((ours - theirs).abs() < 1e-9),
                other => assert_eq!(other, (None, None)),
            }
        }
    }
}

/// The shortest path by brute force: over the corners of polygons around the grown pieces, with
/// every pair of them tested. Never shorter than the true length; infinite if it finds none.
fn brute_force(space: &FreeSpace, radius: f64, from: Point2<f64>, to: Point2<f64>) -> f64 {
    const AROUND: usize = 16;
    let turn = core::f64::consts::TAU / AROUND as f64;
    let outer = 1.0 / geometry::math::cos(0.5 * turn);
    let mut points = vec![from, to];
    for part in space.shapes().parts() {
        let core = match part {
            Convex::Disc { radius, .. } => *radius,
            _ => 0.0,
        };
        for corner in part.corners() {
            points.extend(
                (0..AROUND)
                    .map(|i| corner + unit(turn * i as f64) * ((core + radius) * outer + 1e-9)),
            );
        }
    }
    points.retain(|&p| p == from || p == to || space.is_free(p, radius));
    let mut costs = vec![f64::INFINITY; points.len()];
    let mut open: Vec<usize> = (0..points.len()).collect();
    costs[0] = 0.0;
    while let Some(k) = (0..open.len()).min_by(|&a, &b| costs[open[a]].total_cmp(&costs[open[b]])) {
        let i = open.swap_remove(k);
        if i == 1 || !costs[i].is_finite() {
            break;
        }
        for &j in &open {
            let cost = costs[i] + (points[j] - points[i]).norm();
            if cost < costs[j] && space.segment_is_free(points[i], points[j], radius) {
                costs[j] = cost;
            }
        }
    }
    costs[1]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn no_path_is_shorter(
        space in any_space(1..4), a in any_point(), b in any_point(), radius in 0.03..0.4f64,
    ) {
        let graph = TangentGraph::new(&space, radius).unwrap();
        prop_assume!(space.is_free(a, radius) && space.is_free(b, radius));
        let theirs = brute_force(&space, radius, a, b);
        match graph.shortest(a, b) {
            Some(path) => {
                check(&space, radius, &path, [a, b]);
                prop_assert!(path.length >= (b - a).norm() - 1e-9);
                prop_assert!(path.length <= theirs + 1e-9, "{} {theirs}", path.length);
            }
            None => prop_assert!(theirs.is_infinite(), "there is one of {theirs} m"),
        }
    }

    #[test]
    fn distances_are_a_metric_and_prepared_goals_agree(
        space in any_space(1..8),
        points in proptest::collection::vec(any_point(), 4),
        radius in 0.03..0.4f64,
    ) {
        let graph = TangentGraph::new(&space, radius).unwrap();
        let points: Vec<_> = points.into_iter().filter(|&p| space.is_free(p, radius)).collect();
        for &goal in &points {
            let towards = graph.towards(goal);
            for &a in &points {
                let d = graph.distance(a, goal);
                let (back, prepared) = (graph.distance(goal, a), towards.distance(a));
                prop_assert_eq!(d.is_some(), back.is_some());
                prop_assert_eq!(d.is_some(), prepared.is_some());
                let d = d.unwrap_or(f64::INFINITY);
                if d.is_finite() {
                    prop_assert!((back.unwrap() - d).abs() < 1e-9);
                    prop_assert!((prepared.unwrap() - d).abs() < 1e-9);
                }
                for bound in [towards.lower_bound(a), towards.lower_bound(a)] {
                    prop_assert!(bound <= d + 1e-9, "{bound} {d}");
                    prop_assert!(bound >= (goal - a).norm() - 1e-9);
                }
                for &via in &points {
                    if let (Some(one), Some(two)) =
                        (graph.distance(a, via), graph.distance(via, goal))
                    {
                        prop_assert!(d <= one + two + 1e-9);
                    }
                }
            }
        }
    }

    #[test]
    fn cutting_pieces_changes_nothing(
        parts in proptest::collection::vec(any_parts(), 1..5),
        a in any_point(), b in any_point(), radius in 0.03..0.3f64,
    ) {
        // Every polygon as the fan of its triangles from its first corner.
        let whole = parts.concat();
        let cut: Vec<Convex> = whole.iter().flat_map(|part| {
            if matches!(part, Convex::Disc { .. }) {
                return vec![part.clone()];
            }
            let corners = part.corners();
            corners[1..].windows(2).map(|pair| {
                Convex::polygon(&[corners[0], pair[0], pair[1]])
            }).collect()
        }).collect();
        let (whole, cut) = (space(whole), space(cut));
        prop_assume!(whole.is_free(a, radius) && whole.is_free(b, radius));
        let [whole, cut] = [&whole, &cut].map(|space| TangentGraph::new(space, radius).unwrap());
        match (whole.distance(a, b), cut.distance(a, b)) {
            (Some(one), Some(other)) => prop_assert!((one - other).abs() < 1e-7, "{one} {other}"),
            (one, other) => prop_assert_eq!(one, other),
        }
    }
}
