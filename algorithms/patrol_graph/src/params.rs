//! Strategies of patrols, and their parameters.

use chaotic_maps::Key;
use parameters::{Parameters, ParamsError, above, at_least};

parameters::choice! {
    /// Strategy of a patrol: the choice of the next node.
    pub enum Strategy {
        /// Any neighbour, with equal probabilities.
        Random,
        /// The neighbour with the longest idleness (Machado et al., *Multi-agent patrolling: an empirical analysis of
        /// alternative architectures*, 2002).
        ConscientiousReactive,
        /// The neighbour with the best sum of idleness and nearness, each as a share of the best neighbour's (Almeida et al., *Recent
        /// advances on multi-agent patrolling*, 2004).
        HeuristicReactive,
        /// The node of the whole graph with the best such sum, along edges that are short and lead to idle nodes (HPCC: Almeida
        /// et al., 2004).
        HeuristicPathfinder,
        /// The neighbour with the greatest gain by Bayes' rule (GBS: Portugal and Rocha, *Distributed multi-robot patrol: a
        /// scalable and fault-tolerant framework*, 2013), without regard to others.
        Greedy,
        /// The same, less where others head for (SEBS: Portugal and Rocha, 2013).
        #[default]
        StateExchange,
        /// The node of the whole graph with the greatest utility: idleness less distance (DTA-Greedy: Farinelli, Iocchi and
        /// Nardi, *Distributed on-line dynamic task assignment for multi-robot patrolling*, 2017).
        TaskAssignment,
        /// Each robot walks around its own part of the graph (MSP: Portugal and Rocha, 2010).
        Partition,
        /// All robots follow each other around the whole graph, at equal distances (Chevaleyre, *Theoretical analysis of the
        /// multi-agent patrolling problem*, 2004).
        Cyclic,
        /// A neighbour by the probabilities of a Markov chain, drawn from a key: no attack of a given duration is caught less often
        /// than its floor (Duan, Paccagnan and Bullo, *Stochastic strategies for robotic surveillance as Stackelberg games*, 2021).
        Markov,
    }
}

parameters::table! {
    /// Parameters of the Bayesian strategies `greedy` and `state_exchange`.
    #[derive(Copy)]
    pub struct BayesParams {
        /// Probability to move for a gain of 0.
        pub g1: f64 [above(0).at_most(1)] = 0.1,
        /// Idleness per length from which on the probability is 1. By default the value of `patrolling_sim` for its map `grid` and four
        /// robots, 11.15 s per cell of 0.075 m.
        pub g2: f64 [above(0).unit("s/m")] = 150.0,
        /// Length as which shorter edges count.
        pub edge_min: f64 [above(0).unit("m")] = 0.1,
    }
}

impl Parameters for BayesParams {}

parameters::table! {
    /// Parameters of the strategy `task_assignment`. The default is that of `patrolling_sim` for its map `grid`, 0.5 s per
    /// cell of 0.075 m.
    #[derive(Copy)]
    pub struct AssignmentParams {
        /// Idleness that outweighs a metre of the path to a node.
        pub distance_weight: f64 [at_least(0).unit("s/m")] = 6.7,
        /// Idleness that outweighs a metre between a node and the place at which the robot began.
        pub origin_weight: f64 [at_least(0).unit("s/m")] = 2.0,
    }
}

impl Parameters for AssignmentParams {}

parameters::table! {
    /// Parameters of the strategy `markov`.
    #[derive(Copy)]
    pub struct MarkovParams {
        /// Duration of the attacks against which the chain is optimised.
        pub attack_s: f64 [above(0).unit("s")] = 120.0,
        /// Key of the draws, a `keyed` one. It is that of a team: the first robot of the team uses it, each other one derives
        /// its own from it. If absent, each robot has one from the seed of the run.
        pub key: Option<Key>,
    }
}

impl Parameters for MarkovParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        match Key::secret(self.key, 0) {
            Ok(_) => Ok(()),
            Err(error) => Err(ParamsError::naming(format!("`key`: {error}"))),
        }
    }
}
