//! Arrival times in the open, in the city, and under limits.

use std::sync::LazyLock;

use geometry::grid::Grid;
use nalgebra::Point2;
use navigation::wavefront::{Lattice, MAX_ERROR, Medium, SIGHT, Source, Wave};
use planner_view::map::PlannerMap;
use proptest::prelude::*;
use testing::{Arena, EXIT, RADIUS, open_ground};

const PITCH: f64 = 0.2;

static CITY: LazyLock<(PlannerMap, Medium)> = LazyLock::new(|| {
    let map = Arena::city().map();
    let medium = medium(&map, PITCH, SIGHT);
    (map, medium)
});

/// A square without obstacles, 20 m wide.
static OPEN: LazyLock<(PlannerMap, Medium)> = LazyLock::new(|| {
    let map = open_ground();
    let medium = medium(&map, PITCH, SIGHT);
    (map, medium)
});

fn medium(map: &PlannerMap, pitch: f64, sight: f64) -> Medium {
    Medium::new(map, Lattice::new(map, pitch, RADIUS), sight)
}

fn spread(place: &(PlannerMap, Medium), sources: &[Source]) -> Wave {
    let mut wave = Wave::default();
    wave.spread(&place.1, &place.0, sources, None);
    wave
}

fn point(place: &(PlannerMap, Medium), node: usize) -> Point2<f64> {
    place.1.lattice().point(node).unwrap()
}

/// Largest and mean error relative to straight lines, over the nodes at least 1 m from the source.
fn errors_in_the_open() -> (f64, f64) {
    let (map, medium) = &*OPEN;
    let at = Point2::new(-3.21, 1.03);
    let mut wave = Wave::default();
    wave.spread(medium, map, &[Source::new(at, 0.5, 0)], None);
    let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for node in 0..medium.lattice().len() {
        let truth = (point(&OPEN, node) - at).norm() / 0.5;
        if truth >= 2.0 {
            let error = (f64::from(wave.time(node)) - truth).abs() / truth;
            worst = worst.max(error);
            sum += error;
            count += 1.0;
        }
    }
    (worst, sum / count)
}

#[test]
fn in_the_open_times_are_those_of_straight_lines() {
    let (worst, mean) = errors_in_the_open();
    println!("worst {worst:.5}, mean {mean:.5}");
    assert!(worst < 0.01 && mean < 0.003, "{worst} {mean}");
}

/// Lengths of shortest paths from (−4.5, 7.5) for a radius of 0.105 m, by Dijkstra on the visibility
/// graph of the corners, their arcs drawn with 48 corners each.
const EXACT_LENGTHS: [(f64, f64, f64); 14] = [
    (9.0, 0.0, 16.986),
    (1.6852, -1.5805, 12.281),
    (4.5245, -1.3748, 14.361),
    (7.7998, 3.1346, 14.318),
    (0.7186, -7.5069, 17.961),
    (3.0776, 4.5854, 9.099),
    (-4.3787, 1.3981, 6.103),
    (-7.2177, -3.648, 12.639),
    (-0.3916, 1.8001, 7.939),
    (-0.7459, -7.7682, 16.881),
    (6.78, 1.8005, 14.332),
    (-1.8046, -6.4989, 15.487),
    (7.5219, 0.2123, 15.753),
    (-5.2725, -7.6816, 15.287),
];

#[test]
fn in_the_city_times_are_those_of_the_shortest_paths() {
    let wave = spread(&CITY, &[Source::new(Point2::new(-4.5, 7.5), 1.0, 0)]);
    let mut sum = 0.0;
    for (x, y, truth) in EXACT_LENGTHS {
        let error = wave.time_at(CITY.1.lattice(), Point2::new(x, y)) / truth - 1.0;
        println!("({x}, {y}): {error:.4}");
        assert!(error.abs() < MAX_ERROR, "({x}, {y}): {error}");
        sum += error.abs();
    }
    let mean = sum / EXACT_LENGTHS.len() as f64;
    assert!(mean < 0.005, "{mean}");
}

#[test]
fn the_earliest_of_several_sources_counts_and_lends_its_label() {
    let (a, b) = (Point2::new(-6.0, 0.0), Point2::new(6.0, 0.0));
    let late = Source {
        delay: 4.0,
        ..Source::new(b, 1.0, 9)
    };
    let wave = spread(&OPEN, &[Source::new(a, 1.0, 7), late]);
    for node in 0..OPEN.1.lattice().len() {
        let p = point(&OPEN, node);
        let (first, second) = ((p - a).norm(), (p - b).norm() + 4.0);
        assert!((f64::from(wave.time(node)) - first.min(second)).abs() < 0.06);
        if (first - second).abs() > 0.2 {
            let expected = if first < second { 7 } else { 9 };
            assert_eq!(wave.label(node), Some(expected), "{p}");
        }
    }
}

#[test]
fn a_slow_source_does_not_hold_up_a_fast_one_that_comes_through() {
    // The slow source stands in the street between the fast one and the rest of the street.
    let slow = Source::new(Point2::new(0.0, 1.5), 0.05, 0);
    let fast = Source::new(Point2::new(-3.0, 1.5), 1.0, 1);
    let both = spread(&CITY, &[slow, fast]);
    let alone = spread(&CITY, &[fast]);
    let beyond = CITY.1.lattice().node_at(Point2::new(3.0, 1.5)).unwrap();
    assert_eq!(both.time(beyond), alone.time(beyond));
    assert_eq!(both.label(beyond), Some(1));
    let beside = CITY.1.lattice().node_at(slow.at).unwrap();
    assert_eq!(both.label(beside), Some(0));
}

#[test]
fn places_within_reach_are_reached_at_once() {
    let at = Point2::new(1.0, 2.0);
    let reaching = Source {
        reach: 0.5,
        ..Source::new(at, 0.5, 0)
    };
    let stuck = Source {
        reach: 0.5,
        ..Source::new(at, 0.0, 0)
    };
    let (reaching, stuck) = (spread(&OPEN, &[reaching]), spread(&OPEN, &[stuck]));
    for node in 0..OPEN.1.lattice().len() {
        let distance = (point(&OPEN, node) - at).norm();
        let truth = (distance - 0.5).max(0.0) / 0.5;
        let time = f64::from(reaching.time(node));
        assert!((time - truth).abs() < 0.01 * truth + 1e-6, "{time} {truth}");
        assert_eq!(stuck.time(node) == 0.0, distance <= 0.5);
        assert_eq!(stuck.time(node).is_finite(), distance <= 0.5);
    }
}

#[test]
fn a_limited_wave_is_strictly_earlier_everywhere_and_never_earlier_than_a_free_one() {
    let police = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)]
        .map(|(x, y)| Source::new(Point2::new(x, y), 0.3, 0));
    let limit = spread(&CITY, &police);
    let evader = [Source::new(Point2::new(-4.5, 7.5), 0.9, 0)];
    let free = spread(&CITY, &evader);
    let mut limited = Wave::default();
    limited.spread(&CITY.1, &CITY.0, &evader, Some(&limit));
    let mut cut_off = 0;
    for node in 0..CITY.1.lattice().len() {
        let time = limited.time(node);
        if time.is_finite() {
            assert!(time < limit.time(node));
            // The choice of differences depends on the path; the true time does not.
            assert!(time > 0.98 * free.time(node) - 0.05);
        } else if free.time(node) < limit.time(node) {
            cut_off += 1;
        }
    }
    assert!(cut_off > 0, "faster evaders can be cut off");
}

#[test]
fn a_path_leads_from_the_source_around_obstacles_and_is_as_long_as_its_time() {
    let (map, medium) = &*CITY;
    let start = Point2::new(-4.5, 7.5);
    let wave = spread(&CITY, &[Source::new(start, 1.0, 0)]);
    let mut path = Vec::new();
    for goal in [EXIT, Point2::new(7.5, -7.5), Point2::new(-4.5, 6.9)] {
        let goal = medium.lattice().node_at(goal).unwrap();
        wave.path_to(medium, goal, &mut path);
        assert_eq!(path.last(), medium.lattice().point(goal).as_ref());
        path.insert(0, start);
        assert!(
            path.windows(2)
                .all(|pair| map.line_is_clear(pair[0], pair[1], 0.7 * RADIUS))
        );
        // Eight directions make a straight path up to 8 % longer, alternating steepest descent slightly
        // more.
        let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let truth = f64::from(wave.time(goal));
        assert!((0.98..1.12).contains(&(length / truth)), "{length} {truth}");
    }
    wave.path_to(medium, usize::MAX, &mut path);
    assert!(path.is_empty());
}

/// Behind a thin wall the nodes next to the corner have no earlier neighbour: the wave comes to them
/// straight from the bend.
#[test]
fn a_path_around_the_end_of_a_wall_begins_at_its_source() {
    let mut arena = Arena {
        rectangles: vec![(-0.05, 0.05, -10.0, 2.03)],
        ..Arena::city()
    };
    arena
        .rectangles
        .extend([(-10.0, 10.0, -10.0, -3.0), (-10.0, 10.0, 3.0, 10.0)]);
    let map = arena.map();
    let medium = medium(&map, PITCH, SIGHT);
    let start = Point2::new(-1.5, -1.0);
    let wave = spread(
        &(map.clone(), medium.clone()),
        &[Source::new(start, 1.0, 0)],
    );
    let mut path = Vec::new();
    for node in 0..medium.lattice().len() {
        if wave.time(node).is_finite() {
            wave.path_to(&medium, node, &mut path);
            path.insert(0, start);
            assert!(
                path.windows(2)
                    .all(|pair| map.line_is_clear(pair[0], pair[1], 0.5 * RADIUS)),
                "{path:?}"
            );
        }
    }
}

#[test]
fn invalid_sources_and_maps_reach_nothing_and_do_not_panic() {
    let somewhere = Point2::new(1.5, 1.5);
    let bad = [
        Source::new(Point2::new(f64::NAN, 0.0), 1.0, 0),
        Source::new(somewhere, -1.0, 0),
        Source::new(somewhere, f64::INFINITY, 0),
        Source {
            delay: f64::NAN,
            ..Source::new(somewhere, 1.0, 0)
        },
        Source::new(Point2::new(1e300, -1e300), 1.0, 0),
        // In the middle of a block, farther from any street than the search radius.
        Source::new(Point2::new(0.0, 0.0), 1.0, 0),
    ];
    for source in bad {
        let wave = spread(&CITY, &[source]);
        let reached = wave.times().iter().filter(|time| time.is_finite()).count();
        assert_eq!(reached, 0, "{source:?}");
        assert_eq!(wave.label(0), None);
        assert_eq!(
            wave.time_at(CITY.1.lattice(), Point2::new(f64::NAN, 1.0)),
            f64::INFINITY
        );
    }
    let solid = PlannerMap::new(
        CITY.0.blurred().clone(),
        Grid::filled(CITY.0.clearance_grid().frame, f32::NAN),
        2,
    )
    .unwrap();
    for pitch in [f64::NAN, 0.0, -1.0, 1e300] {
        let medium = medium(&solid, pitch, 3.0);
        assert!(medium.lattice().is_empty());
        let mut wave = Wave::default();
        wave.spread(&medium, &solid, &[Source::new(somewhere, 1.0, 0)], None);
        assert!(wave.times().is_empty());
    }
}

#[test]
fn a_robot_that_touches_a_wall_starts_from_where_it_is() {
    // 0.1 m from the block's side, a little less than the radius.
    let wave = spread(&CITY, &[Source::new(Point2::new(0.0, 1.1), 1.0, 0)]);
    let time = wave.time_at(CITY.1.lattice(), Point2::new(1.5, 1.5));
    assert!((time - 1.552).abs() < 0.05, "{time}");
}

#[test]
fn equal_waves_have_equal_bits_and_leave_nothing_behind() {
    let sources = [
        Source::new(EXIT, 0.7, 0),
        Source::new(Point2::new(-4.5, 7.5), 0.3, 1),
    ];
    let once = spread(&CITY, &sources);
    let mut again = Wave::default();
    again.spread(&OPEN.1, &OPEN.0, &sources, Some(&Wave::default()));
    again.spread(&CITY.1, &CITY.0, &sources, None);
    let bits = |wave: &Wave| wave.times().iter().map(|t| t.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&once), bits(&again));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// Neither time is earlier than a straight line allows, nor, from one cell to the next, later than
    /// by driving there; around a corner beside the source, by a diagonal.
    #[test]
    fn times_obey_the_triangle_inequality(x in -7.9_f64..7.9, y in -7.9_f64..7.9, speed in 0.1_f64..2.0) {
        let at = Point2::new(x, y);
        // From inside an obstacle the wave starts at the nearest free place.
        prop_assume!(CITY.0.line_is_clear(at, at, RADIUS));
        let wave = spread(&CITY, &[Source::new(at, speed, 0)]);
        for node in 0..CITY.1.lattice().len() {
            let time = f64::from(wave.time(node));
            if !time.is_finite() {
                continue;
            }
            // Except for the wave's own error, and for the cell to which a source beside a wall is
            // moved.
            let straight = (point(&CITY, node) - at).norm();
            prop_assert!(time * speed >= 0.98 * straight - CITY.1.lattice().pitch());
            for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
                if let Some(next) = CITY.1.lattice().beside(node, dx, dy) {
                    let later = f64::from(wave.time(next)) - time;
                    prop_assert!(later * speed <= 1.5 * CITY.1.lattice().pitch(), "{}", later * speed);
                }
            }
        }
    }
}
