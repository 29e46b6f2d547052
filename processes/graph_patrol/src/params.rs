//! Parameters of a patrol of a graph.

use avoidance::waypoint_driver::DriverParams;
use parameters::{Parameters, ParamsError, above, within};
use patrol_graph::{AssignmentParams, BayesParams, GraphParams, MarkovParams, Strategy};

parameters::table! {
    /// Parameters of a [`GraphPatrol`](crate::GraphPatrol).
    ///
    /// ```toml
    /// strategy = "state_exchange"
    /// graph = { nodes = [[1, 1], [9, 1], [9, 9]], edges = [[0, 1], [1, 2]] }
    /// ```
    pub struct GraphPatrolParams {
        /// The graph; without nodes it is the Voronoi diagram of the free space of the map.
        pub graph: GraphParams,
        /// Distance between the nodes of a graph from the map.
        pub spacing: f64 [above(0).unit("m")] = 5.0,
        /// Choice of the next node.
        pub strategy: Strategy,
        /// Parameters of the strategies `greedy` and `state_exchange`.
        pub bayes: BayesParams,
        /// Parameters of the strategy `task_assignment`.
        pub assignment: AssignmentParams,
        /// Parameters of the strategy `markov`.
        pub markov: MarkovParams,
        /// Distance within which a robot visits a node.
        pub visit: f64 [above(0).unit("m")] = 0.5,
        /// Driver to waypoints.
        pub driver: DriverParams,
    }
}

impl Parameters for GraphPatrolParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.graph.check_relations().map_err(within("graph"))?;
        self.markov.check_relations().map_err(within("markov"))
    }
}
