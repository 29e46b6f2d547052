//! Robots that pass each other: convoys in lanes with bays, as graphs and as maps.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;

use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Vector2};
use passing::{Move, Places, Schedule, Spacing, Traveller, moves};
use planner_view::free_space::FreeSpace;
use proptest::prelude::*;

const SPACING: Spacing = Spacing {
    clearance: 0.125,
    apart: 0.24,
    places: 0.279,
};
/// Width of a lane (m).
const WIDTH: f64 = 0.4;

/// Two convoys at the ends of a lane.
#[derive(Debug, Clone)]
struct Convoys {
    /// Number of robots of each.
    sizes: [usize; 2],
    /// Place along the lane at which each bay is; a bay holds one robot in a graph and two in a map.
    bays: Vec<usize>,
    length: usize,
    /// Order in which the robots are listed.
    order: Vec<usize>,
}

impl Convoys {
    /// Start and goal of each robot, as numbers of places from the west.
    fn robots(&self) -> Vec<(usize, usize)> {
        let [east, west] = self.sizes;
        let last = self.length - 1;
        let east = (0..east).map(|i| (east - 1 - i, last - i));
        let west = (0..west).map(|i| (last + 1 - west + i, i));
        let all: Vec<_> = east.chain(west).collect();
        self.order.iter().map(|&i| all[i]).collect()
    }
}

/// Convoys with a place in bays for each robot of the smaller one.
fn convoys(most: usize, per_bay: usize) -> impl Strategy<Value = Convoys> {
    (1..=most, 1..=most, 0..3usize)
        .prop_flat_map(move |(east, west, more)| {
            let bays = east.min(west).div_ceil(per_bay) + more;
            let order = Just((0..east + west).collect::<Vec<_>>()).prop_shuffle();
            let gaps = proptest::collection::vec(0..3usize, bays);
            (Just([east, west]), gaps, order)
        })
        .prop_map(|(sizes, gaps, order)| {
            // Between the convoys' ends: a bay beside a robot that has arrived is of no use.
            let end = sizes[0].max(sizes[1]);
            let mut next = end;
            let bays = gaps.iter().map(|gap| {
                let bay = next + gap;
                next = bay + 3;
                bay
            });
            Convoys {
                sizes,
                bays: bays.collect(),
                length: next + end,
                order,
            }
        })
}

/// A lane of places along x with a place beside it for each bay: the places next to each.
fn graph(convoys: &Convoys) -> Vec<Vec<usize>> {
    let at = |i: usize| Point2::new(0.3 * i as f64, 0.0);
    let beside = |&i: &usize| at(i) + Vector2::new(0.0, 0.3);
    let points: Vec<_> = (0..convoys.length)
        .map(at)
        .chain(convoys.bays.iter().map(beside))
        .collect();
    let is_next = |a: &Point2<f64>, b: &Point2<f64>| a != b && (a - b).norm() < 0.31;
    let next = |a: &Point2<f64>| {
        (0..points.len())
            .filter(|&b| is_next(a, &points[b]))
            .collect()
    };
    points.iter().map(next).collect()
}

/// Checks each move, and returns the robots' last places.
fn replay(next: &[Vec<usize>], starts: &[usize], goals: &[usize], all: &[Move]) -> Vec<usize> {
    let mut at = starts.to_vec();
    for &Move { robot, to } in all {
        assert!(next[at[robot]].contains(&to), "no way");
        assert!(!at.contains(&to), "not empty");
        assert_ne!(at[robot], goals[robot], "it has arrived before");
        at[robot] = to;
    }
    at
}

/// Lets the robots of a schedule drive, each for as long as `delays` say, and returns how far they are from their goals
/// (m) in the end.
fn drive(
    mut schedule: Schedule,
    space: &FreeSpace,
    starts: &[Point2<f64>],
    goals: &[Point2<f64>],
    delays: &[u8],
) -> Vec<f64> {
    let mut at: Vec<_> = starts.to_vec();
    let far = |at: &[Point2<f64>]| {
        let pairs = at.iter().zip(goals);
        pairs.map(|(a, goal)| (a - goal).norm()).collect::<Vec<_>>()
    };
    for round in 0..20_000 {
        let arrived = far(&at);
        if arrived.iter().all(|far| *far < 0.01) {
            break;
        }
        let active = |i: usize| (arrived[i] >= 0.01).then_some(at[i]);
        schedule.update(&(0..at.len()).map(active).collect::<Vec<_>>());
        for i in 0..at.len() {
            let rests = round % 7 < usize::from(delays[(round / 40 + i) % delays.len()]);
            let to = schedule.destination(i, at[i], space).unwrap_or(goals[i]);
            let way = to - at[i];
            if rests || arrived[i] < 0.01 || way.norm() < 1e-9 {
                continue;
            }
            let next = at[i] + way * (0.02 / way.norm()).min(1.0);
            let nearer = |j: usize| {
                let (before, now) = ((at[j] - at[i]).norm(), (at[j] - next).norm());
                // Past another at the least distance, a step may come nearer by its rounding.
                now < before - 1e-3 && now < SPACING.apart - 0.02
            };
            if !(0..at.len()).any(|j| j != i && nearer(j)) {
                at[i] = next;
            }
        }
    }
    far(&at)
}

fn travellers(starts: &[Point2<f64>], goals: &[Point2<f64>]) -> Vec<Traveller> {
    let pairs = starts.iter().zip(goals);
    let robot = |(&at, &goal)| Traveller {
        at,
        forward: Vector2::x(),
        goal: Some(goal),
    };
    pairs.map(robot).collect()
}

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Convex {
    let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
    Convex::polygon(&corners.map(|(x, y)| Point2::new(x, y)))
}

/// A lane from x = 0 m with bays of 0.7 m × 0.6 m beside it.
fn map(convoys: &Convoys, pitch: f64) -> FreeSpace {
    let end = pitch * convoys.length as f64;
    let mut walls = Vec::new();
    let mut x = 0.0;
    for &bay in &convoys.bays {
        let left = pitch * bay as f64;
        walls.push(rectangle(x, WIDTH, left, 1.0));
        x = left + 0.7;
    }
    walls.push(rectangle(x, WIDTH, end.max(x + 0.1), 1.0));
    let bounds = Aabb {
        min: Point2::new(0.0, 0.0),
        max: Point2::new(end.max(x + 0.1), 1.0),
    };
    FreeSpace::new(walls, bounds, 0.05).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn convoys_in_a_lane_with_enough_bays_arrive(convoys in convoys(4, 1)) {
        let places = graph(&convoys);
        let (starts, goals): (Vec<_>, Vec<_>) = convoys.robots().into_iter().unzip();
        let some: Vec<_> = goals.iter().copied().map(Some).collect();
        let all = moves(&places, &starts, &some);
        prop_assert_eq!(&replay(&places, &starts, &goals, &all), &goals);
        prop_assert_eq!(moves(&places, &starts, &some), all);
    }

    #[test]
    fn robots_arrive_whatever_delays_them(
        convoys in convoys(4, 2),
        delays in proptest::collection::vec(0..7u8, 1..9),
    ) {
        let far = far_in_the_end(&convoys, &delays);
        prop_assert!(far.iter().all(|far| *far < 0.01), "{:?}", far);
    }
}

/// Distances of the robots of convoys in a lane with bays from their goals in the end (m).
fn far_in_the_end(convoys: &Convoys, delays: &[u8]) -> Vec<f64> {
    let pitch = 0.35;
    let space = map(convoys, pitch);
    // Along the wall opposite the bays: here, robots drive straight to their goals in the end.
    let at = |i: usize| Point2::new(pitch * (i as f64 + 0.5), 0.14);
    let (starts, goals): (Vec<_>, Vec<_>) = (convoys.robots().into_iter())
        .map(|(a, b)| (at(a), at(b)))
        .unzip();
    let schedule = Schedule::new(&space, SPACING, &travellers(&starts, &goals), &[]);
    drive(schedule.unwrap(), &space, &starts, &goals, delays)
}

#[test]
fn two_that_pass_each_other_at_the_least_distance_do_not_wait_for_each_other() {
    let convoys = Convoys {
        sizes: [2, 4],
        bays: vec![4, 7],
        length: 14,
        order: vec![4, 3, 1, 2, 5, 0],
    };
    let far = far_in_the_end(&convoys, &[2, 2, 4, 3, 1, 6, 4]);
    assert!(far.iter().all(|far| *far < 0.01), "{far:?}");
}

#[test]
fn places_are_apart_and_ways_leave_the_other_places_alone() {
    let convoys = Convoys {
        sizes: [2, 2],
        bays: vec![5],
        length: 14,
        order: vec![0, 1, 2, 3],
    };
    let space = map(&convoys, 0.35);
    let starts = [Point2::new(0.3, 0.2), Point2::new(0.6, 0.2)];
    let goals = [Point2::new(4.5, 0.2), Point2::new(0.32, 0.2)];
    let places = Places::new(&space, &SPACING, &starts, &goals, &[]).unwrap();
    // The first robot stands at the goal of the second, and the graph is one.
    let known = [&goals[..], &starts[1..]].concat();
    assert_eq!(places.points[..3], known);
    let mut reached = BTreeSet::new();
    let mut open = vec![0];
    while let Some(place) = open.pop() {
        if reached.insert(place) {
            open.extend(&places.next[place]);
        }
    }
    assert_eq!(reached.len(), places.points.len());
    for (a, p) in places.points.iter().enumerate() {
        assert!(space.is_free(*p, SPACING.clearance));
        let far = |q: &Point2<f64>| p == q || (p - q).norm() >= SPACING.places;
        assert!(places.points.iter().all(far), "{p}");
        for &b in &places.next[a] {
            assert!(places.next[b].contains(&a));
        }
    }
    // Two robots fit into the bay, and it is beside the lane for a third.
    let beside: BTreeSet<_> = (0..places.points.len())
        .filter(|&i| places.points[i].y > WIDTH)
        .collect();
    assert!(beside.len() >= 2, "{:?}", places.points);
}

#[test]
fn without_a_place_beside_the_lane_none_arrives() {
    let convoys = Convoys {
        sizes: [1, 1],
        bays: Vec::new(),
        length: 6,
        order: vec![0, 1],
    };
    assert_eq!(moves(&graph(&convoys), &[0, 5], &[Some(5), Some(0)]), []);
}

#[test]
fn others_pass_back_where_one_waits_if_only_one_place_is_beside_the_lane() {
    let convoys = Convoys {
        sizes: [3, 3],
        bays: vec![8],
        length: 18,
        order: (0..6).collect(),
    };
    let places = graph(&convoys);
    let (starts, goals): (Vec<_>, Vec<_>) = convoys.robots().into_iter().unzip();
    let some: Vec<_> = goals.iter().copied().map(Some).collect();
    let all = moves(&places, &starts, &some);
    assert_eq!(replay(&places, &starts, &goals, &all), goals);
}
