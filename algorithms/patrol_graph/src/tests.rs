//! Teams that walk graphs, in a world without bodies.

use std::sync::Arc;

use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use patrol_chain::KeyedStream;

use crate::{Attacks, GraphParams, PatrolGraph, Seen, Strategy as Patrol, Walker, parts};

const ALL: [Patrol; 9] = [
    Patrol::Random,
    Patrol::ConscientiousReactive,
    Patrol::HeuristicReactive,
    Patrol::HeuristicPathfinder,
    Patrol::Greedy,
    Patrol::StateExchange,
    Patrol::TaskAssignment,
    Patrol::Partition,
    Patrol::Cyclic,
];

/// A connected graph: each node has an edge to one of those before it, and there are some more.
fn graphs() -> impl Strategy<Value = PatrolGraph> {
    let node = (0.0..20.0, 0.0..20.0, any::<prop::sample::Index>());
    let more = (any::<prop::sample::Index>(), any::<prop::sample::Index>());
    let parts = (
        prop::collection::vec(node, 2..20),
        prop::collection::vec(more, 0..10),
    );
    parts.prop_filter_map("two nodes at one place", |(nodes, more)| {
        let mut params = GraphParams::default();
        for (number, (x, y, before)) in nodes.iter().enumerate() {
            params.nodes.push([*x, *y]);
            if number > 0 {
                params.edges.push([before.index(number), number]);
            }
        }
        for (a, b) in more {
            let (a, b) = (a.index(nodes.len()), b.index(nodes.len()));
            let edges = &mut params.edges;
            if a != b && !edges.contains(&[a, b]) && !edges.contains(&[b, a]) {
                edges.push([a, b]);
            }
        }
        PatrolGraph::new(&params).ok()
    })
}

struct Robot {
    walker: Walker<ChaCha8Rng>,
    at: usize,
    next: Option<usize>,
    arrives_s: f64,
    in_play: bool,
}

/// A team at 1 m/s that thinks once a second.
struct World {
    graph: Arc<PatrolGraph>,
    robots: Vec<Robot>,
    visited_s: Vec<f64>,
    time_s: f64,
}

impl World {
    fn new(graph: &PatrolGraph, strategy: Patrol, robots: usize, seed: u64) -> Self {
        let graph = Arc::new(graph.clone());
        let robot = |number: usize| Robot {
            walker: Walker::new(
                graph.clone(),
                strategy,
                1.0,
                ChaCha8Rng::seed_from_u64(seed + number as u64),
            ),
            at: number * 7 % graph.count(),
            next: None,
            arrives_s: 0.0,
            in_play: true,
        };
        Self {
            robots: (0..robots).map(robot).collect(),
            visited_s: vec![0.0; graph.count()],
            graph,
            time_s: 0.0,
        }
    }

    fn step(&mut self) {
        self.time_s += 1.0;
        for number in 0..self.robots.len() {
            let others = |robot: &&Robot| robot.in_play;
            let robots = self.robots.iter().filter(others).count();
            let rank = self.robots[..number].iter().filter(others).count();
            let rest = self.robots.iter().enumerate();
            let rest = rest.filter(|(other, robot)| *other != number && robot.in_play);
            let (intentions, ready): (Vec<_>, Vec<_>) = rest
                .map(|(_, other)| {
                    (
                        other.walker.target().or(other.next),
                        other.walker.is_ready(),
                    )
                })
                .unzip();
            let intentions: Vec<usize> = intentions.into_iter().flatten().collect();
            let idle: Vec<f64> = self.visited_s.iter().map(|s| self.time_s - s).collect();
            let seen = Seen {
                idleness_s: &idle,
                intentions: &intentions,
                rank,
                robots,
                others_ready: !ready.contains(&false),
                time_s: self.time_s,
            };
            let robot = &mut self.robots[number];
            if !robot.in_play || robot.arrives_s > self.time_s {
                continue;
            }
            robot.at = robot.next.take().unwrap_or(robot.at);
            self.visited_s[robot.at] = self.time_s;
            robot.next = robot.walker.next(robot.at, &seen);
            if let Some(next) = robot.next {
                let edges = self.graph.edges(robot.at);
                let edge = edges.iter().find(|edge| edge.to == next);
                robot.arrives_s = self.time_s + edge.expect("a neighbour").length_m;
            }
        }
    }

    /// Walks until every node has been visited after the present time; `false` if that takes more than this many seconds.
    fn visits_all_within(&mut self, seconds: f64) -> bool {
        let began_s = self.time_s;
        while self.time_s < began_s + seconds {
            self.step();
            if self.visited_s.iter().all(|&last_s| last_s > began_s) {
                return true;
            }
        }
        false
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_strategy_visits_all_nodes_also_when_a_robot_fails(
        graph in graphs(), robots in 1..5_usize, seed in 0..1000_u64,
    ) {
        for strategy in ALL {
            let mut world = World::new(&graph, strategy, robots, seed);
            prop_assert!(world.visits_all_within(1e5), "{strategy:?}");
            if robots > 1 {
                world.robots[0].in_play = false;
                prop_assert!(world.visits_all_within(1e5), "{strategy:?} after a failure");
            }
        }
    }

    #[test]
    fn parts_hold_every_node_once_and_are_connected(graph in graphs(), count in 1..6_usize) {
        let parts = parts(&graph, count);
        prop_assert_eq!(parts.len(), count.min(graph.count()));
        let mut all: Vec<usize> = parts.concat();
        all.sort_unstable();
        prop_assert_eq!(all, (0..graph.count()).collect::<Vec<_>>());
        for part in parts {
            // Each node after the first is a neighbour of one before it.
            for (place, &node) in part.iter().enumerate().skip(1) {
                let before = &part[..place];
                prop_assert!(graph.edges(node).iter().any(|edge| before.contains(&edge.to)));
            }
        }
    }
}

/// The `grid` of `patrolling_sim`: 5 × 5 nodes at distances of 5.7 m.
fn grid() -> PatrolGraph {
    let mut params = GraphParams::default();
    for node in 0..25 {
        let (column, row) = (node % 5, node / 5);
        params.nodes.push([5.7 * column as f64, 5.7 * row as f64]);
        if column > 0 {
            params.edges.push([node - 1, node]);
        }
        if row > 0 {
            params.edges.push([node - 5, node]);
        }
    }
    PatrolGraph::new(&params).unwrap()
}

#[test]
fn robots_on_a_tour_keep_their_distances() {
    let graph = grid();
    let mut world = World::new(&graph, Patrol::Cyclic, 5, 1);
    assert!(world.visits_all_within(1000.0));
    let mut worst_s: f64 = 0.0;
    for _ in 0..1000 {
        world.step();
        let idle = world.visited_s.iter().map(|last_s| world.time_s - last_s);
        worst_s = idle.fold(worst_s, f64::max);
    }
    // A tour has 26 edges (25 nodes of a bipartite graph), each of which takes 6 whole seconds.
    let share_s = 26.0 * 6.0 / 5.0;
    assert!((share_s..1.25 * share_s).contains(&worst_s), "{worst_s}");
}

/// Mean idleness of a team on the grid (s).
fn mean_s(strategy: Patrol, robots: usize) -> f64 {
    let mut world = World::new(&grid(), strategy, robots, 7);
    let mut sum = 0.0;
    for _ in 0..5000 {
        world.step();
        let idle = world.visited_s.iter().map(|last_s| world.time_s - last_s);
        sum += idle.sum::<f64>();
    }
    sum / (5000.0 * 25.0)
}

#[test]
fn every_strategy_of_a_single_robot_beats_the_random_walk() {
    let random_s = mean_s(Patrol::Random, 1);
    for strategy in &ALL[1..] {
        let mean_s = mean_s(*strategy, 1);
        assert!(
            mean_s < 0.8 * random_s,
            "{strategy:?}: {mean_s} against {random_s}"
        );
    }
}

#[test]
fn a_team_beats_the_random_walk_unless_all_choose_the_same_node() {
    let random_s = mean_s(Patrol::Random, 4);
    // Robots that choose among all nodes and know no intentions drive to the same one.
    for strategy in ALL[1..]
        .iter()
        .filter(|&&s| s != Patrol::HeuristicPathfinder)
    {
        let mean_s = mean_s(*strategy, 4);
        assert!(
            mean_s < 0.8 * random_s,
            "{strategy:?}: {mean_s} against {random_s}"
        );
    }
    let (alone_s, exchange_s) = (mean_s(Patrol::Greedy, 4), mean_s(Patrol::StateExchange, 4));
    assert!(exchange_s < alone_s, "{exchange_s} against {alone_s}");
}

#[test]
fn a_walk_on_a_chain_is_the_one_that_its_key_draws() {
    let graph = Arc::new(grid());
    let attacks = Attacks::new(&graph, 120.0, 1.0, 0.6).unwrap();
    let chain = Arc::new(attacks.chain().unwrap());
    let floor = |chain| attacks.best(chain).unwrap().probability;
    let (optimised, random) = (floor(&chain), floor(&attacks.random_walk()));
    assert!(optimised > 2.0 * random, "{optimised} {random}");

    let rng = ChaCha8Rng::seed_from_u64(1);
    let walker = Walker::new(graph, Patrol::Markov, 1.0, rng);
    let mut walker = walker.on_chain(chain.clone(), [7; 32]);
    let seen = Seen {
        idleness_s: &[0.0; 25],
        intentions: &[],
        rank: 0,
        robots: 1,
        others_ready: true,
        time_s: 0.0,
    };
    let (mut at, mut ally) = (0, KeyedStream::new([7; 32]));
    for _ in 0..1000 {
        let next = walker.next(at, &seen);
        assert_eq!(next, Some(chain.draw(at, &mut ally)));
        at = next.unwrap();
    }
}

#[test]
fn whole_steps_never_favour_the_robot() {
    let floor = |graph: &PatrolGraph, attack_s| {
        let attacks = Attacks::new(graph, attack_s, 1.0, 0.0).unwrap();
        attacks.best(&attacks.random_walk()).unwrap().probability
    };
    // From end to end of a line, and back to an end: 4 s, which half of the shorter edge divides.
    let line = |second_m| {
        PatrolGraph::new(&GraphParams {
            nodes: vec![[0.0, 0.0], [1.0, 0.0], [1.0 + second_m, 0.0]],
            edges: vec![[0, 1], [1, 2]],
            lengths: Vec::new(),
        })
    };
    let even = line(1.0).unwrap();
    assert_eq!((floor(&even, 1.9), floor(&even, 2.0)), (0.0, 0.5));
    // 2.6 steps of half a metre count as 3, so that the second edge takes 6 there and back.
    let uneven = line(1.3).unwrap();
    assert_eq!((floor(&uneven, 2.9), floor(&uneven, 3.0)), (0.0, 0.5));
    assert!(Attacks::new(&even, 0.4, 1.0, 0.0).is_err());
}
