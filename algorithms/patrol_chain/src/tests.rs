use geometry::math::{exp, ln};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::optimise::soft_weights;

/// A ring of nodes with edges both ways that take this long, and a wait of one step at each node.
fn ring(nodes: usize, time: u32) -> TravelTimes {
    let edges = (0..nodes).flat_map(|node| {
        let next = (node + 1) % nodes;
        [(node, next, time), (next, node, time), (node, node, 1)]
    });
    TravelTimes::new(nodes, edges).unwrap()
}

/// A graph of five nodes with other travel times one way than the other.
fn uneven() -> TravelTimes {
    let edges = [
        (0, 1, 1),
        (1, 0, 2),
        (1, 2, 3),
        (2, 1, 1),
        (2, 3, 2),
        (3, 0, 1),
        (3, 4, 2),
        (4, 2, 1),
        (4, 4, 1),
    ];
    TravelTimes::new(5, edges).unwrap()
}

/// A chain of the graph with these weights of its edges, in their order.
fn chain(times: TravelTimes, weights: &[f64]) -> Chain {
    let mut weights = weights.iter().copied();
    let rows: Vec<Vec<f64>> = (0..times.nodes())
        .map(|node| weights.by_ref().take(times.from(node).len()).collect())
        .collect();
    Chain::from_weights(times, &rows)
}

/// The nodes after a start, drawn with a key of this byte.
fn walk(chain: &Chain, start: usize, key: u8) -> impl Iterator<Item = usize> {
    let mut stream = KeyedStream::new([key; 32]);
    let next = move |&node: &usize| Some(chain.draw(node, &mut stream));
    std::iter::successors(Some(start), next).skip(1)
}

/// The probability that a robot which leaves a node is at another one within some steps, by all its walks.
fn by_all_walks(chain: &Chain, from: usize, at: usize, steps: u32) -> f64 {
    let edges = chain.times().from(from).iter().zip(chain.row(from));
    let each = edges.filter_map(|(edge, probability)| {
        let left = steps.checked_sub(edge.time)?;
        let is_there = edge.to == at;
        let then = if is_there {
            1.0
        } else {
            by_all_walks(chain, edge.to, at, left)
        };
        Some(probability * then)
    });
    each.sum()
}

/// The soft minimum of the probabilities of capture.
fn soft_minimum(chain: &Chain, durations: &[u32], beta: f64) -> f64 {
    let capture = Capture::new(chain, durations).unwrap();
    let sum: f64 = capture.probabilities().iter().map(|c| exp(-beta * c)).sum();
    -ln(sum) / beta
}

proptest! {
    #[test]
    fn probabilities_are_those_of_all_walks(
        weights in prop::collection::vec(0.1..1.0_f64, 9),
        durations in prop::collection::vec(1..9_u32, 5),
    ) {
        let chain = chain(uneven(), &weights);
        let capture = Capture::new(&chain, &durations).unwrap();
        let mut least = f64::INFINITY;
        for from in 0..5 {
            for (at, &duration) in durations.iter().enumerate() {
                let expected = by_all_walks(&chain, from, at, duration);
                prop_assert!((capture.probabilities()[at * 5 + from] - expected).abs() < 1e-12);
                least = least.min(expected);
            }
        }
        let best = capture.best_response();
        prop_assert!((best.probability - least).abs() < 1e-12);
        prop_assert_eq!(capture.probabilities()[best.at * 5 + best.from], best.probability);
    }

    #[test]
    fn derivatives_are_those_of_finite_differences(
        weights in prop::collection::vec(0.1..1.0_f64, 9),
        durations in prop::collection::vec(1..12_u32, 5),
    ) {
        const STEP: f64 = 1e-6;
        const BETA: f64 = 20.0;
        let base = chain(uneven(), &weights);
        let capture = Capture::new(&base, &durations).unwrap();
        let least = capture.best_response().probability;
        let gradient = capture.gradient(&soft_weights(capture.probabilities(), BETA, least));
        let rows = (0..5).flat_map(|node| {
            base.row(node).iter().enumerate().map(move |(edge, _)| (node, edge))
        });
        for (index, (node, edge)) in rows.enumerate() {
            // The weight of an edge changes the probabilities of its row: the chain rule of the division by the sum.
            let values = [-STEP, STEP].map(|step| {
                let mut moved = weights.clone();
                moved[index] += step;
                soft_minimum(&chain(uneven(), &moved), &durations, BETA)
            });
            let numeric = (values[1] - values[0]) / (2.0 * STEP);
            let mean: f64 = gradient[node].iter().zip(base.row(node)).map(|(d, p)| d * p).sum();
            let sum = weights[index] / base.row(node)[edge];
            let exact = (gradient[node][edge] - mean) / sum;
            prop_assert!((numeric - exact).abs() < 1e-7, "{numeric} {exact}");
        }
    }
}

#[test]
fn on_a_complete_graph_the_floor_reaches_what_is_known() {
    let edges = (0..4).flat_map(|i| (0..4).map(move |j| (i, j, 1)));
    let times = TravelTimes::new(4, edges).unwrap();
    let floor = |duration| {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let chain = optimise(&times, &[duration; 4], 2, &mut random).unwrap();
        let capture = Capture::new(&chain, &[duration; 4]).unwrap();
        capture.best_response().probability
    };
    // One step: some node has at most a quarter of each row.
    assert!((floor(1) - 0.25).abs() < 1e-12);
    // More steps: independent draws of all nodes are one chain of many.
    for duration in 2..=3 {
        let drawn = 1.0 - 0.75_f64.powi(duration);
        let found = floor(duration.unsigned_abs());
        assert!(found >= drawn - 1e-9, "{found} {drawn}");
    }
    // As many as nodes: a round trip captures with certainty.
    assert!(floor(4) > 0.99, "{}", floor(4));
}

#[test]
fn the_floor_is_higher_than_that_of_a_random_walk() {
    let durations = [9; 5];
    let floor = |chain: &Chain| {
        let capture = Capture::new(chain, &durations).unwrap();
        capture.best_response().probability
    };
    let walk = floor(&Chain::uniform(uneven()));
    let found = optimise(&uneven(), &durations, 2, &mut ChaCha8Rng::seed_from_u64(1)).unwrap();
    assert!(floor(&found) > walk + 0.05, "{} {walk}", floor(&found));
}

#[test]
fn the_same_stream_gives_the_same_chain() {
    let durations = [9; 5];
    let found = |seed| {
        optimise(
            &uneven(),
            &durations,
            1,
            &mut ChaCha8Rng::seed_from_u64(seed),
        )
        .unwrap()
    };
    assert_eq!(found(1), found(1));
}

#[test]
fn longer_attacks_have_a_higher_floor() {
    let chain = Chain::uniform(ring(6, 2));
    let floors = [6, 8, 12, 20, 40].map(|duration| {
        Capture::new(&chain, &[duration; 6])
            .unwrap()
            .best_response()
            .probability
    });
    assert!(
        floors.windows(2).all(|pair| pair[0] < pair[1]),
        "{floors:?}"
    );
    // The opposite node is three edges of two steps away.
    let capture = Capture::new(&chain, &[5; 6]).unwrap();
    assert_eq!(capture.best_response().probability, 0.0);
}

#[test]
fn the_best_response_is_captured_as_often_as_the_floor_says() {
    const ATTACKS: u32 = 100_000;
    let (times, durations) = (uneven(), [9, 10, 9, 11, 10]);
    let chain = optimise(&times, &durations, 1, &mut ChaCha8Rng::seed_from_u64(3)).unwrap();
    let best = Capture::new(&chain, &durations).unwrap().best_response();
    // One long walk of a robot; the intruder attacks whenever it leaves the node.
    let nodes: Vec<usize> = walk(&chain, 0, 9).take(4_000_000).collect();
    let time = |pair: &[usize]| {
        let edges = chain.times().from(pair[0]);
        edges.iter().find(|edge| edge.to == pair[1]).unwrap().time
    };
    let (mut attacks, mut captures) = (0, 0);
    let mut at = 0;
    while attacks < ATTACKS {
        if nodes[at] != best.from {
            at += 1;
            continue;
        }
        attacks += 1;
        let mut left = durations[best.at];
        loop {
            let rest = left.checked_sub(time(&nodes[at..at + 2]));
            at += 1;
            let Some(rest) = rest else { break };
            if nodes[at] == best.at {
                captures += 1;
                break;
            }
            left = rest;
        }
    }
    let share = f64::from(captures) / f64::from(ATTACKS);
    let deviation = (best.probability * (1.0 - best.probability) / f64::from(ATTACKS)).sqrt();
    assert!(
        (share - best.probability).abs() < 3.9 * deviation,
        "{share} {best:?}"
    );
}

#[test]
fn an_ally_with_the_key_knows_every_node_and_no_other_key_helps() {
    let chain = Chain::uniform(ring(5, 1));
    let nodes = |key| walk(&chain, 2, key).take(1000).collect::<Vec<usize>>();
    assert_eq!(nodes(1), nodes(1));
    let same = nodes(1)
        .iter()
        .zip(nodes(2))
        .filter(|(a, b)| *a == b)
        .count();
    // One in five by chance.
    assert!((120..280).contains(&same), "{same}");
    // Draws follow the chain: each of three edges of a node a third of the time.
    let nodes: Vec<usize> = walk(&chain, 2, 3).take(30_000).collect();
    let stays = nodes.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert!((9_700..10_300).contains(&stays), "{stays}");
}

#[test]
fn invalid_graphs_and_durations_are_named() {
    let error = |nodes, edges: &[(usize, usize, u32)]| {
        TravelTimes::new(nodes, edges.iter().copied())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        error(0, &[]),
        "the number of nodes is 0: expected 1 to 1000"
    );
    assert_eq!(
        error(2, &[(0, 2, 1)]),
        "an edge names node 2: expected 0 to 1"
    );
    assert_eq!(
        error(2, &[(0, 1, 0)]),
        "the travel time from node 0 to 1 is 0: expected 1 to 10000 steps"
    );
    assert_eq!(
        error(2, &[(0, 1, 1), (0, 1, 2)]),
        "the edge from node 0 to 1 is there twice: remove one"
    );
    assert_eq!(
        error(2, &[(0, 1, 1)]),
        "node 0 cannot be reached from node 1: add edges"
    );
    assert_eq!(
        error(2, &[(1, 0, 1)]),
        "node 1 cannot be reached from node 0: add edges"
    );
    assert_eq!(
        error(1, &[]),
        "node 0 cannot be reached from node 0: add edges"
    );
    let chain = Chain::uniform(ring(3, 1));
    let error = |durations: &[u32]| Capture::new(&chain, durations).unwrap_err().to_string();
    assert_eq!(
        error(&[1, 2]),
        "the number of durations of attacks is 2: expected 3, one per node"
    );
    assert_eq!(
        error(&[1, 0, 2]),
        "the duration of an attack at node 1 is 0: expected 1 to 10000 steps"
    );
}
