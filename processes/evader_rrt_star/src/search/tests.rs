use geometry::shape::Convex;
use navigation::tangent_graph::TangentGraph;
use proptest::prelude::*;

use super::*;
use crate::collision_map::CollisionMap;
use crate::motion::{Arcs, Straight};
use crate::params::{Algorithm, CostParams};

const RADIUS: f64 = 0.105;

/// Pillars in a room of 8 m × 8 m.
fn room(pillars: &[(f64, f64, f64)]) -> CollisionMap {
    let bounds = Aabb {
        min: Point2::new(-4.0, -4.0),
        max: Point2::new(4.0, 4.0),
    };
    let parts = pillars
        .iter()
        .map(|&(x, y, half)| Convex::rectangle(Point2::new(x, y), [half, half], 0.0))
        .collect();
    let space = FreeSpace::new(parts, bounds, 0.05).unwrap();
    CollisionMap::new(&space, RADIUS, 1)
}

fn four_pillars() -> CollisionMap {
    room(&[
        (-1.5, -1.5, 1.0),
        (1.5, -1.5, 1.0),
        (-1.5, 1.5, 1.0),
        (1.5, 1.5, 1.0),
    ])
}

fn scene<'a>(collision_map: &'a CollisionMap, cost: &'a CostModel) -> Scene<'a> {
    Scene {
        space: &collision_map.space,
        sampler: &collision_map.sampler,
        radius: RADIUS,
        cost,
        bodies: &[],
    }
}

fn by_length() -> CostModel {
    CostModel::new(CostParams::length(), Algorithm::Improved, 0.5)
}

const FROM: Pose2 = Pose2 {
    x: -3.0,
    y: -3.0,
    theta: 0.0,
};
const TO: Point2<f64> = Point2::new(3.0, 3.0);

fn searched<M: Motion>(
    scene: &Scene<'_>,
    motion: M,
    params: SearchParams,
    seed: u64,
    iterations: u32,
) -> Search<M> {
    let mut search = Search::new(params, motion, seed);
    let bound = Bound::straight(FROM.position(), &[TO]);
    search.plant(scene, FROM, &[TO], bound);
    search.run(scene, iterations);
    search
}

/// Checks that costs and lengths of all nodes are those of the paths to them, and that all paths
/// are free.
fn is_consistent<M: Motion>(search: &Search<M>, scene: &Scene<'_>) {
    let tree = search.tree();
    for number in 1..tree.len() as u32 {
        let node = tree.node(number);
        if node.parent == NONE {
            assert!(number <= search.goals && node.cost.is_infinite());
            continue;
        }
        let parent = tree.node(node.parent);
        let link = search
            .link(node.parent, node.position())
            .expect("a way to every node");
        assert!(
            scene.is_free(&link, parent.position(), node.position()),
            "{number}"
        );
        let edge = scene
            .cost
            .edge(parent.position(), node.position(), &link, parent.length);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
        assert!(close(node.edge, edge), "{number}: {} for {edge}", node.edge);
        assert!(close(node.cost, parent.cost + edge), "{number}");
        assert!(close(node.length, parent.length + link.length), "{number}");
        if M::HAS_HEADING {
            assert!(close(node.pose.theta, link.heading), "{number}");
        }
        assert!(tree.children(node.parent).any(|child| child == number));
    }
}

#[test]
fn rewired_costs_reach_every_node_behind() {
    let collision_map = four_pillars();
    let length = by_length();
    let mut danger = CostModel::new(CostParams::default(), Algorithm::Improved, 0.5);
    danger.set_pursuers(
        [(0.0, 3.0), (3.0, 0.0)]
            .into_iter()
            .map(|(x, y)| crate::cost::Pursuer {
                at: Point2::new(x, y),
                v_max: 0.3,
            }),
    );
    for cost in [&length, &danger] {
        let scene = scene(&collision_map, cost);
        for seed in 0..3 {
            let search = searched(&scene, Straight, SearchParams::default(), seed, 1500);
            assert!(search.best.0.is_finite());
            is_consistent(&search, &scene);
        }
    }
}

#[test]
fn arcs_keep_their_headings_through_rewiring() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let arcs = Arcs {
        min_radius: 0.3,
        max_bearing: core::f64::consts::FRAC_PI_4,
        free_start: false,
    };
    for seed in 0..3 {
        let search = searched(&scene, arcs, SearchParams::default(), seed, 4000);
        is_consistent(&search, &scene);
        let way = search.way();
        assert!(way.len() > 1, "seed {seed}");
        assert_eq!(way[0].pose, FROM);
        assert_eq!(way.last().unwrap().pose.position(), TO);
    }
}

#[test]
fn the_length_comes_down_to_the_shortest_ways() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let graph = TangentGraph::new(&collision_map.space, RADIUS).unwrap();
    let optimum = graph.distance(FROM.position(), TO).unwrap();
    for seed in 0..5 {
        let search = searched(&scene, Straight, SearchParams::default(), seed, 4000);
        let best = search.best.0;
        // Never shorter than the shortest, up to the contact tolerance.
        assert!(best > optimum - 1e-6, "seed {seed}: {best} for {optimum}");
        assert!(best < optimum * 1.002, "seed {seed}: {best} for {optimum}");
    }
}

#[test]
fn more_iterations_never_make_the_way_dearer() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let mut search = searched(&scene, Straight, SearchParams::default(), 5, 0);
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        search.run(&scene, 50);
        let best = search.best.0;
        assert!(best <= last, "{best} after {last}");
        last = best;
    }
    assert!(last.is_finite());
}

#[test]
fn the_same_seed_grows_the_same_tree() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let nodes = |seed| {
        let search = searched(&scene, Straight, SearchParams::default(), seed, 800);
        search.tree().nodes().to_vec()
    };
    assert_eq!(nodes(7), nodes(7));
    assert_ne!(nodes(7), nodes(8));
}

#[test]
fn the_papers_search_never_rewires() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let search = searched(&scene, Straight, SearchParams::paper(), 1, 1500);
    // Without rewiring a child is always younger than its parent; goals exist from the start.
    for (number, node) in search.tree().nodes().iter().enumerate().skip(2) {
        assert!((node.parent as usize) < number);
    }
    is_consistent(&search, &scene);
}

#[test]
fn the_papers_search_reaches_a_goal_by_samples_at_the_goal_alone() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let params = |goal_bias| SearchParams {
        goal_bias,
        ..SearchParams::paper()
    };
    // Nodes in sight of the goal are no path to it.
    let search = searched(&scene, Straight, params(0.0), 1, 200);
    let in_sight = search.tree().nodes().iter().skip(2).any(|node| {
        let (at, distance) = (node.position(), (node.position() - TO).norm());
        distance < params(0.0).max_edge && collision_map.is_free_line(at, TO, RADIUS, &[])
    });
    assert!(in_sight && search.way().is_empty());
    assert!(
        !searched(&scene, Straight, params(0.05), 1, 200)
            .way()
            .is_empty()
    );
}

#[test]
fn a_goal_behind_walls_is_not_reached_but_come_near_to() {
    // A wall across the room.
    let bounds = Aabb {
        min: Point2::new(-4.0, -4.0),
        max: Point2::new(4.0, 4.0),
    };
    let wall = Convex::rectangle(Point2::new(0.0, 0.0), [4.0, 0.2], 0.0);
    let space = FreeSpace::new(vec![wall], bounds, 0.05).unwrap();
    let collision_map = CollisionMap::new(&space, RADIUS, 1);
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let search = searched(&scene, Straight, SearchParams::default(), 1, 500);
    assert!(search.way().is_empty());
    assert!(search.best.0.is_infinite());
    let end = search.partial_way().last().unwrap().pose.position();
    assert!(
        (end - TO).norm() < (FROM.position() - TO).norm() - 2.0,
        "{end}"
    );
}

#[test]
fn bodies_in_the_way_are_passed() {
    let collision_map = room(&[]);
    let cost = by_length();
    let body = Body {
        at: Point2::origin(),
        reach: 0.5,
    };
    let scene = Scene {
        bodies: &[body],
        ..scene(&collision_map, &cost)
    };
    let search = searched(&scene, Straight, SearchParams::default(), 1, 1000);
    let way = search.way();
    assert!(way.len() > 2);
    for pair in way.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|waypoint| waypoint.pose.position());
        assert!(crate::motion::segment_distance(a, b, body.at) >= body.reach);
    }
}

#[test]
fn a_warm_start_keeps_the_way_and_makes_its_costs_anew() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let mut search = searched(&scene, Straight, SearchParams::default(), 3, 1500);
    let before = search.way();
    // A little further along the first piece.
    let (a, b) = (before[0].pose.position(), before[1].pose.position());
    let here = a + (b - a) * 0.3;
    let root = Pose2::new(here.x, here.y, 0.0);
    let bound = Bound::straight(here, &[TO]);
    search.replant(&scene, root, &[TO], bound, false);
    let expected = before.last().unwrap().cost - 0.3 * before[1].length;
    let best = search.best.0;
    assert!(best <= expected + 1e-9, "{best} for {expected}");
    assert!(search.tree.len() > before.len());
    is_consistent(&search, &scene);

    // The same with a new obstacle on the path, and all paths checked again.
    let middle = before[before.len() / 2].pose.position();
    let mut pillars = vec![
        (-1.5, -1.5, 1.0),
        (1.5, -1.5, 1.0),
        (-1.5, 1.5, 1.0),
        (1.5, 1.5, 1.0),
    ];
    pillars.push((middle.x, middle.y, 0.1));
    let changed = room(&pillars);
    let scene = super::tests::scene(&changed, &cost);
    search.replant(&scene, root, &[TO], Bound::straight(here, &[TO]), true);
    is_consistent(&search, &scene);
}

#[test]
fn another_goal_keeps_no_nodes() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let mut search = searched(&scene, Straight, SearchParams::default(), 3, 500);
    let goals = [Point2::new(3.0, -3.0)];
    search.replant(
        &scene,
        FROM,
        &goals,
        Bound::straight(FROM.position(), &goals),
        false,
    );
    assert_eq!(search.tree.len(), 2);
}

#[test]
fn a_search_without_goals_or_free_space_finds_nothing() {
    let collision_map = four_pillars();
    let cost = by_length();
    let scene = scene(&collision_map, &cost);
    let mut search = Search::new(SearchParams::default(), Straight, 1);
    search.run(&scene, 10);
    search.plant(&scene, FROM, &[], Bound::straight(FROM.position(), &[]));
    search.run(&scene, 100);
    assert!(search.way().is_empty());

    let full = room(&[(0.0, 0.0, 4.0)]);
    assert!(full.sampler.is_empty());
    let scene = super::tests::scene(&full, &cost);
    let search = searched(&scene, Straight, SearchParams::default(), 1, 100);
    assert!(search.way().is_empty() && search.partial_way().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn ways_are_free_and_no_shorter_than_the_shortest(
        pillars in prop::collection::vec((-2.0..2.0, -2.0..2.0, 0.1..0.6), 0..6),
        seed in any::<u64>(),
    ) {
        let collision_map = room(&pillars);
        let cost = by_length();
        let scene = scene(&collision_map, &cost);
        let search = searched(&scene, Straight, SearchParams::default(), seed, 400);
        is_consistent(&search, &scene);
        let graph = TangentGraph::new(&collision_map.space, RADIUS).unwrap();
        let optimum = graph.distance(FROM.position(), TO).unwrap();
        prop_assert!(search.best.0 > optimum - 1e-6);
    }
}
