//! Parameters of the pursuit of intruders.

use parameters::{Parameters, at_least};
use pursuit_evasion::pursuit::PursuerParams;

parameters::table! {
    /// Parameters of pursuits.
    #[derive(Copy)]
    pub struct PursueParams {
        /// Time without a sighting after which an intruder is lost, and its guard returns to the patrol.
        pub lost_s: f64 [at_least(0).unit("s")] = 10.0,
        /// Tactics of a guard in pursuit.
        pub tactics: PursuerParams,
    }
}

impl Parameters for PursueParams {}
