//! Routes through the paper's city.

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;
use navigation::bearing::Bearings;
use navigation::routes::{Lengths, LengthsFrom, NavGrid, RouteFinder, RouteTree, Threat};
use planner_view::map::PlannerMap;
use proptest::prelude::*;
use testing::{Arena, EXIT, RADIUS};

fn route_finder(map: &PlannerMap) -> RouteFinder {
    let mut finder = RouteFinder::default();
    finder.prepare(map, RADIUS);
    finder
}

#[test]
fn the_path_to_the_exit_has_the_length_of_the_street_grid() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    let start = Point2::new(-4.5, 7.5);
    let routes = finder.routes(&map, 0, start, [EXIT]).unwrap();
    let length = routes.distance_to(EXIT).unwrap();
    // The shortest path for a disc of this radius is 16.99 m; along the middles of the streets it is
    // at most 13.5 + 7.5 m.
    assert!((17.0..21.0).contains(&length), "{length}");
}

#[test]
fn kept_lengths_are_those_of_routes() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    let lengths = Lengths::of_map(&map, RADIUS);
    let mut from = LengthsFrom::default();
    let (far, near) = (Point2::new(-4.5, 7.5), Point2::new(7.5, 0.3));
    assert_eq!(from.to(lengths.end(EXIT)), f64::INFINITY);
    for start in [far, near, far] {
        assert!(lengths.start(start, &mut from));
        for to in [far, near, EXIT] {
            let routes = finder.lengths(&map, 0, start, [to]).unwrap();
            let expected = routes.distance_to(to).unwrap();
            // They are kept in whole centimetres.
            assert!((from.to(lengths.end(to)) - expected).abs() < 0.0051);
        }
    }
    assert!(!lengths.start(Point2::new(f64::NAN, 0.0), &mut from));
    assert_eq!(from.to(lengths.end(EXIT)), f64::INFINITY);
}

#[test]
fn every_point_of_a_path_has_room_for_the_robot() {
    let arena = Arena::city();
    let map = arena.map();
    let mut finder = route_finder(&map);
    let routes = finder
        .routes(&map, 0, Point2::new(-4.5, 7.5), [EXIT])
        .unwrap();
    let mut path = Vec::new();
    routes.way_to(EXIT, &mut path);
    assert!(path.len() > 40);
    for pair in path.windows(2) {
        let ((a, before), (b, after)) = (pair[0], pair[1]);
        assert!(after > before);
        for step in 0..=4 {
            let at = a + (b - a) * (f64::from(step) / 4.0);
            assert!(arena.clearance(at) > RADIUS, "{at}");
        }
    }
}

#[test]
fn the_first_leg_can_be_driven_straight_and_the_legs_end_at_the_goal() {
    let arena = Arena::city();
    let map = arena.map();
    let mut finder = route_finder(&map);
    let mut at = Point2::new(-7.5, -7.5);
    let mut legs = 0;
    while (at - EXIT).norm() > 0.01 {
        let routes = finder.routes(&map, 0, at, [EXIT]).unwrap();
        let bearing = Bearings::Along(routes).bearing(at, EXIT).unwrap();
        for step in 0..=100 {
            let on = at + (bearing.waypoint - at) * (f64::from(step) / 100.0);
            assert!(
                arena.clearance(on) > 0.5 * RADIUS,
                "leg {legs} from {at} at {on}"
            );
        }
        at = bearing.waypoint;
        legs += 1;
        assert!(legs < 30, "does not get there");
    }
    assert!(legs >= 3);
}

#[test]
fn a_threat_on_the_shortest_path_causes_a_detour() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    let start = Point2::new(-7.5, 1.5);
    let goal = Point2::new(7.5, 1.5);
    let mut path = Vec::new();
    let routes = finder.routes(&map, 0, start, [goal]).unwrap();
    routes.way_to(goal, &mut path);
    let direct = path.last().unwrap().1;
    let police = Point2::new(0.0, 1.5);
    let threats = [Threat {
        at: police,
        gain: 3.0,
        reach: 1.5,
    }];
    let mut at = start;
    let mut driven = 0.0;
    while (at - goal).norm() > 0.01 {
        let out = finder
            .way_out(&map, 1, at, [goal], &threats, driven == 0.0)
            .unwrap();
        assert_eq!(out.exit, goal);
        for step in 0..=100 {
            let on = at + (out.waypoint - at) * (f64::from(step) / 100.0);
            assert!((on - police).norm() > 1.3, "{on}");
        }
        driven += (out.waypoint - at).norm();
        at = out.waypoint;
        assert!(driven < 30.0, "does not get there");
    }
    assert!(driven > direct + 0.5, "{driven} against {direct}");
}

#[test]
fn the_escape_path_leads_to_the_nearest_exit() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    let (west, east) = (Point2::new(-7.5, -1.5), Point2::new(7.5, 1.5));
    let mut out = |from, exits: &[Point2<f64>]| {
        finder.way_out(&map, 0, from, exits.iter().copied(), &[], false)
    };
    let near_east = out(Point2::new(6.0, 1.5), &[west, east]).unwrap();
    assert_eq!((near_east.exit, near_east.waypoint), (east, east));
    assert!((near_east.length - 1.5).abs() < 0.3);
    assert_eq!(
        out(Point2::new(-6.0, -1.5), &[west, east]).unwrap().exit,
        west
    );
    assert_eq!(out(Point2::new(-6.0, -1.5), &[east]).unwrap().exit, east);
    assert!(out(Point2::new(-6.0, -1.5), &[]).is_none());
    assert!(out(Point2::new(f64::NAN, -1.5), &[east]).is_none());
}

#[test]
fn a_place_that_is_walled_off_is_measured_straight() {
    let mut arena = Arena::city();
    arena.rectangles.push((8.0, 9.0, -1.25, 1.25));
    let map = arena.map();
    let mut finder = route_finder(&map);
    let start = Point2::new(7.5, 0.0);
    assert!(
        finder
            .way_out(&map, 1, start, [Point2::new(9.3, 0.0)], &[], false)
            .is_none()
    );
    let outside = Point2::new(9.3, 0.0);
    let routes = finder.routes(&map, 0, start, [outside]).unwrap();
    assert!(routes.leg_to(outside).is_none());
    assert!(
        (Bearings::Along(routes)
            .bearing(start, outside)
            .unwrap()
            .distance
            - 1.8)
            .abs()
            < 1e-9
    );
}

#[test]
fn invalid_points_and_maps_have_no_paths_and_do_not_panic() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    assert!(
        finder
            .routes(&map, 0, Point2::new(f64::NAN, 0.0), [EXIT])
            .is_none()
    );
    assert!(
        finder
            .routes(&map, usize::MAX, Point2::new(1e300, -1e300), [EXIT])
            .is_some()
    );
    let nowhere = Point2::new(f64::INFINITY, 0.0);
    let routes = finder
        .routes(&map, 0, Point2::new(1.5, 1.5), [nowhere])
        .unwrap();
    assert!(routes.leg_to(nowhere).is_none());
    // A map without any free space.
    let frame = GridFrame {
        width: 3,
        height: 2,
        resolution: 0.1,
        origin: Point2::origin(),
    };
    let blurred = BlurredMap::new(&Grid::filled(frame, false), 0.2).unwrap();
    let solid = PlannerMap::new(blurred, Grid::filled(frame, f32::NAN), 2).unwrap();
    let mut finder = route_finder(&solid);
    assert!(
        finder
            .routes(&solid, 0, Point2::new(0.1, 0.1), [])
            .is_none()
    );
}

#[test]
fn a_new_revision_of_the_map_changes_the_path() {
    let mut arena = Arena::city();
    let map = arena.map();
    let mut finder = route_finder(&map);
    let (start, goal) = (Point2::new(1.5, -1.5), Point2::new(1.5, 1.5));
    let before = finder
        .routes(&map, 0, start, [goal])
        .unwrap()
        .distance_to(goal)
        .unwrap();
    arena.rectangles.push((1.0, 2.0, -0.3, 0.3));
    let blocked = arena.map();
    let blocked = PlannerMap::new(
        blocked.blurred().clone(),
        blocked.clearance_grid().clone(),
        map.revision() + 1,
    )
    .unwrap();
    finder.prepare(&blocked, RADIUS);
    let after = finder
        .routes(&blocked, 0, start, [goal])
        .unwrap()
        .distance_to(goal)
        .unwrap();
    assert!(after > before + 3.0, "{before} then {after}");
}

#[test]
fn a_line_of_sight_ends_at_the_first_block() {
    let map = Arena::city().map();
    let (from, to) = (Point2::new(-7.5, 1.5), Point2::new(7.5, 1.5));
    assert!(map.line_is_clear(from, to, 0.4));
    assert!(!map.line_is_clear(from, to, 0.6));
    let run = map.free_run(
        Point2::new(1.5, 1.5),
        Point2::new(1.5 + 5.0, 1.5 + 5.0),
        RADIUS,
    );
    assert!((0.3..0.8).contains(&run), "{run}");
    assert_eq!(map.free_run(from, Point2::new(f64::NAN, 0.0), 0.1), 0.0);
}

#[test]
fn paths_are_unknown_until_they_are_requested() {
    let map = Arena::city().map();
    let mut finder = route_finder(&map);
    let start = Point2::new(-7.5, -7.5);
    let near = Point2::new(-7.5, -6.0);
    let routes = finder.routes(&map, 0, start, [near]).unwrap();
    assert!(routes.distance_to(near).is_some());
    assert!(routes.distance_to(EXIT).is_none());
    let mut path = vec![(EXIT, 0.0)];
    routes.way_to(EXIT, &mut path);
    assert!(path.is_empty());
    let later = finder
        .routes(&map, 0, start, [EXIT])
        .unwrap()
        .distance_to(EXIT)
        .unwrap();
    // Growing in steps gives the same tree as growing at once.
    let at_once = finder
        .routes(&map, 1, start, [EXIT])
        .unwrap()
        .distance_to(EXIT)
        .unwrap();
    assert_eq!(later, at_once);
}

#[test]
fn every_path_past_threats_comes_from_the_cheapest_neighbour() {
    let map = Arena::city().map();
    let grid = NavGrid::new(&map, RADIUS);
    let threat = |x, y, gain| Threat {
        at: Point2::new(x, y),
        gain,
        reach: 1.5,
    };
    let threats = [threat(-1.5, 1.5, 3.0), threat(4.4, 3.1, 0.5)];
    let extra = |node| {
        let point = grid.point(node).unwrap();
        let extra: f64 = threats
            .iter()
            .map(|t| t.gain * t.reach * t.reach / (point - t.at).norm_squared().max(1e-6))
            .sum();
        (extra.min(1000.0) * 256.0) as u64
    };
    let mut tree = RouteTree::default();
    let root = grid.node_at(EXIT).unwrap();
    tree.plant_without_gates(&grid, &[root], &threats);
    tree.settle(&grid, u32::MAX);
    let cost = |node| (tree.cost(node).unwrap() * 1000.0).round() as u64;
    for node in (0..grid.len()).filter(|&node| node != root) {
        let ways = grid.edges(node).iter().map(|edge| {
            let to = edge.to as usize;
            let most = extra(node).max(extra(to));
            let through = cost(to) + u64::from(edge.length) * (256 + most) / 256;
            // Of equal ones, the one that was reached first.
            (through, tree.rank(to).unwrap(), to)
        });
        let (least, _, from) = ways.min().unwrap();
        assert_eq!((cost(node), tree.parent(node)), (least, Some(from)));
    }
}

/// One query of a route finder: the slot, the start, `true` for first legs, the destinations.
type Question = (usize, (f64, f64), bool, Vec<(f64, f64)>);

fn place() -> impl Strategy<Value = (f64, f64)> {
    (-8.5..9.5_f64, -8.5..8.5_f64)
}

fn question() -> impl Strategy<Value = Question> {
    let targets = prop::collection::vec(place(), 0..4);
    (0..3_usize, place(), any::<bool>(), targets)
}

/// All results of a route finder for a query, also for places outside the query.
fn answer(
    map: &PlannerMap,
    finder: &mut RouteFinder,
    question: &Question,
    elsewhere: &[Point2<f64>],
) -> String {
    let point = |&(x, y): &(f64, f64)| Point2::new(x, y);
    let (slot, root, gates, targets) = question;
    let targets = targets.iter().map(point);
    let routes = if *gates {
        finder.routes(map, *slot, point(root), targets.clone())
    } else {
        finder.lengths(map, *slot, point(root), targets.clone())
    };
    let routes = routes.unwrap();
    let mut path = Vec::new();
    let mut text = String::new();
    for to in targets.chain(elsewhere.iter().copied()) {
        routes.way_to(to, &mut path);
        text += &format!(
            "{:?} {:?} {path:?}\n",
            routes.leg_to(to),
            routes.distance_to(to)
        );
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn sharing_trees_does_not_change_results(
        questions in prop::collection::vec((0..3_usize, question()), 1..25),
        elsewhere in prop::collection::vec(place(), 6),
        threat in place(),
    ) {
        let alone = Arena::city().map();
        let shared = Arena::city().map().shared();
        let mut others: Vec<_> = (0..3).map(|_| route_finder(&shared)).collect();
        let mut own: Vec<_> = (0..3).map(|_| route_finder(&alone)).collect();
        let elsewhere: Vec<_> = elsewhere.iter().map(|&(x, y)| Point2::new(x, y)).collect();
        for (who, question) in &questions {
            prop_assert_eq!(
                answer(&alone, &mut own[*who], question, &elsewhere),
                answer(&shared, &mut others[*who], question, &elsewhere)
            );
            let from = Point2::new(question.1.0, question.1.1);
            let threats = [Threat {
                at: Point2::new(threat.0, threat.1),
                gain: 3.0,
                reach: 1.5,
            }];
            let threats = &threats[..usize::from(question.2)];
            let exits = [EXIT, Point2::new(-4.5, 7.5)];
            prop_assert_eq!(
                own[*who].way_out(&alone, 7, from, exits, threats, true),
                others[*who].way_out(&shared, 7, from, exits, threats, true)
            );
        }
    }
}
