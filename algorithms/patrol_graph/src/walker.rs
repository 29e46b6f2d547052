//! A robot that walks a graph by a strategy.

use std::collections::VecDeque;
use std::sync::Arc;

use patrol_chain::{Chain, KeyedStream};
use rand::Rng;

use crate::choices;
use crate::graph::PatrolGraph;
use crate::params::{AssignmentParams, BayesParams, Strategy};
use crate::parts::parts;
use crate::tour::{length_m, tour};

/// Knowledge of a robot about its team when it chooses its next node.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// Idleness of each node (s).
    pub idleness_s: &'a [f64],
    /// Nodes that the other robots of its team head for.
    pub intentions: &'a [usize],
    /// Number of robots of its team in play before it.
    pub rank: usize,
    /// Number of robots of its team in play, itself included, at least 1.
    pub robots: usize,
    /// `true` if all others are at the places from which they begin to walk a tour.
    pub others_ready: bool,
    /// Simulated time (s).
    pub time_s: f64,
}

/// A tour on which a robot is.
#[derive(Debug, Clone)]
struct Round {
    /// The robot's number and the number of robots for which it was made.
    team: (usize, usize),
    /// Nodes in the order of their visits.
    order: Vec<usize>,
    /// Place in `order` that the robot heads for.
    place: usize,
    /// Time until which the robot waits for others at its first place (s), once it is there; `None` after that.
    gathers_until_s: Option<f64>,
}

/// A robot that walks a graph.
#[derive(Debug, Clone)]
pub struct Walker<R> {
    graph: Arc<PatrolGraph>,
    strategy: Strategy,
    bayes: BayesParams,
    assignment: AssignmentParams,
    /// Speed of the robot (m/s).
    v: f64,
    rng: R,
    /// Node at which it began.
    origin: Option<usize>,
    /// Nodes that it walks to before it chooses again.
    path: VecDeque<usize>,
    round: Option<Round>,
    /// Chain of the strategy `markov`, and the stream of its draws.
    chain: Option<(Arc<Chain>, KeyedStream)>,
    is_ready: bool,
}

impl<R: Rng> Walker<R> {
    /// A robot with this speed (m/s, > 0), and with the stream from which it draws.
    pub fn new(graph: Arc<PatrolGraph>, strategy: Strategy, v: f64, rng: R) -> Self {
        Self {
            graph,
            strategy,
            bayes: BayesParams::default(),
            assignment: AssignmentParams::default(),
            v,
            rng,
            origin: None,
            path: VecDeque::new(),
            round: None,
            chain: None,
            is_ready: strategy != Strategy::Cyclic,
        }
    }

    /// The same with other parameters of its strategy.
    #[must_use]
    pub fn with(self, bayes: BayesParams, assignment: AssignmentParams) -> Self {
        Self {
            bayes,
            assignment,
            ..self
        }
    }

    /// The same with a chain on the graph for the strategy `markov`, and the key from which it draws. Without a chain
    /// a robot with this strategy stays where it is.
    #[must_use]
    pub fn on_chain(self, chain: Arc<Chain>, key: [u8; 32]) -> Self {
        Self {
            chain: Some((chain, KeyedStream::new(key))),
            ..self
        }
    }

    /// `true` if the others of its team need not wait for it.
    pub fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// The node that it heads for in the end, after the next one.
    pub fn target(&self) -> Option<usize> {
        self.path.back().copied()
    }

    /// Forgets the nodes that it was to walk to: it did not get there.
    pub fn give_up(&mut self) {
        self.path.clear();
    }

    /// Returns the node after `at`, a neighbour of it; `None` if the robot stays there in this tick.
    pub fn next(&mut self, at: usize, seen: &Seen<'_>) -> Option<usize> {
        let origin = *self.origin.get_or_insert(at);
        // Two robots on the way to one node: both choose again.
        if let (Strategy::TaskAssignment, Some(target)) = (self.strategy, self.target())
            && seen.intentions.contains(&target)
        {
            self.path.clear();
        }
        if self.path.is_empty() {
            let (graph, idle, rng) = (&*self.graph, seen.idleness_s, &mut self.rng);
            let others = (seen.intentions, seen.robots);
            match self.strategy {
                Strategy::Random => self.path.extend(choices::random(graph, at, rng)),
                Strategy::ConscientiousReactive => {
                    self.path
                        .extend(choices::conscientious(graph, at, idle, rng));
                }
                Strategy::HeuristicReactive => {
                    self.path.extend(choices::heuristic(graph, at, idle, rng));
                }
                Strategy::HeuristicPathfinder => {
                    self.path.extend(choices::pathfinder(graph, at, idle, rng));
                }
                Strategy::Greedy => {
                    let alone = (&[][..], 1);
                    let node = choices::bayesian(graph, at, idle, alone, &self.bayes, rng);
                    self.path.extend(node);
                }
                Strategy::StateExchange => {
                    let node = choices::bayesian(graph, at, idle, others, &self.bayes, rng);
                    self.path.extend(node);
                }
                Strategy::TaskAssignment => {
                    let (ends, params) = ((at, origin), &self.assignment);
                    let node = choices::assignment(graph, ends, idle, seen.intentions, params, rng);
                    self.head_for(at, node?);
                }
                Strategy::Markov => {
                    let (chain, stream) = self.chain.as_mut()?;
                    self.path.push_back(chain.draw(at, stream));
                }
                Strategy::Partition | Strategy::Cyclic => {
                    let node = self.on_round(at, seen)?;
                    self.head_for(at, node);
                }
            }
        }
        self.path.pop_front()
    }

    /// Walks to a node by the shortest path.
    fn head_for(&mut self, at: usize, to: usize) {
        let mut node = at;
        while node != to {
            node = self.graph.onward(node, to);
            self.path.push_back(node);
        }
    }

    /// The next node of the robot's tour; `None` to stay. A team with another number of robots makes new tours.
    fn on_round(&mut self, at: usize, seen: &Seen<'_>) -> Option<usize> {
        let team = (seen.rank, seen.robots);
        let mut round = match self.round.take().filter(|round| round.team == team) {
            Some(round) => round,
            None => self.new_round(at, seen),
        };
        if round.order.get(round.place) == Some(&at) {
            self.is_ready = true;
            let waits = |until_s: f64| !seen.others_ready && seen.time_s < until_s;
            if round.gathers_until_s.is_some_and(waits) {
                self.round = Some(round);
                return None;
            }
            round.gathers_until_s = None;
            round.place = (round.place + 1) % round.order.len();
        }
        let next = round.order.get(round.place).copied();
        self.round = Some(round);
        next.filter(|&next| next != at)
    }

    /// The tour of a robot in its team: its part of the graph, or all of it from its own place on.
    fn new_round(&mut self, at: usize, seen: &Seen<'_>) -> Round {
        let graph = &*self.graph;
        let team = (seen.rank, seen.robots);
        if self.strategy == Strategy::Partition {
            let mut parts = parts(graph, seen.robots);
            let own = seen.rank % parts.len();
            let order = tour(graph, &parts.swap_remove(own));
            let near = |place: &usize| graph.distance_m(at, order[*place]);
            let places = 0..order.len();
            let place = places.min_by(|a, b| near(a).total_cmp(&near(b)));
            return Round {
                team,
                place: place.unwrap_or_default(),
                order,
                gathers_until_s: None,
            };
        }
        let all: Vec<usize> = (0..graph.count()).collect();
        let order = tour(graph, &all);
        let length = length_m(graph, &order);
        let (mut place, mut walked) = (0, 0.0);
        while place + 1 < order.len() && walked * (seen.robots as f64) < length * seen.rank as f64 {
            walked += graph.distance_m(order[place], order[place + 1]);
            place += 1;
        }
        self.is_ready = false;
        Round {
            team,
            order,
            place,
            gathers_until_s: Some(seen.time_s + length / self.v),
        }
    }
}
