//! Parameters of the dominance regions.

use parameters::{Parameters, above};

parameters::table! {
    /// Resolution of dominance.
    #[derive(Copy)]
    pub struct DominanceParams {
        /// Side of a cell, rounded to whole cells of the map. Cost grows with its inverse
        /// square.
        pub pitch: f64 [above(0).unit("m")] = 0.2,
    }
}

impl Parameters for DominanceParams {}
