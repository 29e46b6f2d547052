//! Chains of the strategy `markov`, each optimised once.

use core::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use patrol_chain::{Chain, ChainError};
use patrol_graph::{Attacks, PatrolGraph};
use robot::spec::RobotModel;

use crate::params::GraphPatrolParams;

/// The last chain: the robots of a team have the same.
static LAST: Mutex<Option<(Attacks, Arc<Chain>)>> = Mutex::new(None);

/// The attacks against which a robot walks a graph. Drives count from standstill to standstill, after half a turn.
///
/// # Errors
/// [`ChainError`] for an attack that is too short, or times out of range.
pub(crate) fn attacks(
    params: &GraphPatrolParams,
    graph: &PatrolGraph,
    model: &RobotModel,
) -> Result<Attacks, ChainError> {
    let v = model.v_max * params.driver.go_to.speed_fraction;
    let omega = model.omega_max;
    let turn_s = PI / omega
        + model
            .angular_acceleration
            .map_or(0.0, |change| omega / change);
    let start_s = model.acceleration.map_or(0.0, |change| v / change);
    Attacks::new(graph, params.markov.attack_s, v, turn_s + start_s)
}

/// The chain against these attacks.
///
/// # Errors
/// As [`Attacks::chain`].
pub(crate) fn chain(attacks: Attacks) -> Result<Arc<Chain>, ChainError> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, chain)) = last.as_ref().filter(|(known, _)| *known == attacks) {
        return Ok(chain.clone());
    }
    let chain = Arc::new(attacks.chain()?);
    *last = Some((attacks, chain.clone()));
    Ok(chain)
}
