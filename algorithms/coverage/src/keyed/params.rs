//! Parameters of keyed coverage.

use parameters::{Parameters, above, between};

/// Maximum number of candidates per choice.
const MAX_CANDIDATES: usize = 4096;

parameters::table! {
    /// Parameters of the choice of sub-goals.
    pub struct KeyedParams {
        /// Side of the cells of the coverage map; at most the radius of the disc that the robot covers.
        pub cell: f64 [above(0).unit("m")] = 0.1,
        /// Number of orders drawn per sub-goal, of which the best is followed; 1.4 draws one or two,
        /// depending on the key. The trade-off: more cover faster and are easier to predict.
        pub choices: f64 [between(1, 4)] = 1.4,
        /// Number of candidate points per order.
        pub candidates: usize [between(1, MAX_CANDIDATES)] = 128,
        /// Share of the reachable cells at which a round ends and all cells count as fresh again.
        pub round_at: f64 [above(0).at_most(1)] = 0.99,
    }
}

impl Parameters for KeyedParams {}
