//! Breaks things on purpose: processes of real runs are killed, stopped and slowed down at
//! moments that a seed draws, and after every fault the promises are checked.
//!
//! * [`fault`]: what can be done to whom, drawn from a seed;
//! * [`mission`]: one run as its own program, with its own runtime directory;
//! * [`inject`]: does it;
//! * `posts`: how far the world was when an orchestrator was killed;
//! * [`promises`]: what must hold afterwards, and what did not;
//! * `stops`: how soon robots stood whose planner had failed;
//! * [`table`]: what a person sees of it.

pub mod fault;
pub mod inject;
pub mod mission;
mod posts;
pub mod promises;
mod stops;
pub mod table;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use serde::Serialize;

use crate::census::CensusError;
use crate::scenario::ResolvedScenario;
use fault::{Fault, FaultKind, Policy};
use mission::{Baseline, Course};

/// Times that a fault may come too late for its mission before it is given up.
const ATTEMPTS: u32 = 5;

/// What is done.
#[derive(Debug, Clone)]
pub struct ChaosOptions {
    /// The mission.
    pub scenario: ResolvedScenario,
    /// Seed of the faults.
    pub seed: u64,
    /// How many faults.
    pub faults: u64,
    /// The kinds to draw from; each as often as the others.
    pub kinds: Vec<FaultKind>,
    /// What the scenario's processes do when they fail; drawn if there is more than one.
    pub policies: Vec<Policy>,
    /// Missions by the clock run so many times as fast as reality.
    pub real_time: f64,
    /// Where logs of missions that broke a promise are kept.
    pub keep: Option<PathBuf>,
    /// Set from outside (Ctrl-C): ends after the fault that is on.
    pub interrupted: Arc<AtomicBool>,
}

impl ChaosOptions {
    /// Names of the processes that something can be done to, the simulator first.
    fn targets(&self) -> Vec<String> {
        let names = self.scenario.processes.iter().map(|p| p.name.clone());
        std::iter::once(mission::SIMULATOR.to_owned())
            .chain(names)
            .collect()
    }
}

/// A fault and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of the fault, from 0.
    pub number: u64,
    /// The fault.
    #[serde(flatten)]
    pub fault: Fault,
    /// Whether it was done; else its mission was over every time.
    pub injected: bool,
    /// Promises that were broken, in words.
    pub broken: Vec<String>,
    /// Real time from the fault until the mission was over [s].
    pub over_after_s: f64,
    /// Real time from a failure until the process was there again [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back_after_s: Option<f64>,
    /// Simulated time from the failure of a planner until its robots stood still [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped_after_s: Option<f64>,
    /// What the log lacks of the time before the orchestrator was killed [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_s: Option<f64>,
}

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChaosReport {
    /// Every fault.
    pub outcomes: Vec<Outcome>,
    /// Faults that were done.
    pub injected: u64,
    /// Promises that were broken.
    pub broken: u64,
    /// Real time [s].
    pub lasted_s: f64,
    /// Whether it was ended from outside.
    pub interrupted: bool,
}

/// Why nothing can be broken.
#[derive(Debug, thiserror::Error)]
pub enum ChaosError {
    /// The mission does not work when nothing is done to it.
    #[error("{scenario}, left alone, {what}: {stderr}")]
    Baseline {
        /// The scenario.
        scenario: String,
        /// What happened.
        what: String,
        /// Its last words.
        stderr: String,
    },
    /// A program cannot be started, or a file not be made.
    #[error("{what}: {source}")]
    System {
        /// What was attempted.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The machine cannot be looked at.
    #[error(transparent)]
    Census(#[from] CensusError),
}

/// Injects the faults one after the other, each into a mission of its own; `told` hears of each.
///
/// # Errors
/// [`ChaosError`] if missions do not even work when they are left alone, or the machine refuses.
pub fn chaos(
    options: &ChaosOptions,
    mut told: impl FnMut(&Outcome),
) -> Result<ChaosReport, ChaosError> {
    let start = Instant::now();
    let mut baselines: BTreeMap<(Course, Policy), Baseline> = BTreeMap::new();
    let mut outcomes = Vec::new();
    let interrupted = || options.interrupted.load(Ordering::SeqCst);
    for number in 0..options.faults {
        if interrupted() {
            break;
        }
        // A stream per fault: one fault can be done again alone.
        let mut random = ChaCha8Rng::seed_from_u64(options.seed);
        random.set_stream(number);
        let fault = Fault::draw(options, &mut random);
        let key = (fault.course, fault.policy);
        let baseline = match baselines.entry(key) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(mission::baseline(options, key)?),
        };
        let mut outcome = None;
        for attempt in 0..ATTEMPTS {
            // What comes too late once comes earlier the next time.
            let moment = fault.moment * 0.7_f64.powi(attempt as i32);
            let tried = promises::put_to_the_test(options, number, &fault, moment, baseline)?;
            let done = tried.injected || interrupted() || !tried.broken.is_empty();
            outcome = Some(tried);
            if done {
                break;
            }
        }
        if let Some(outcome) = outcome {
            told(&outcome);
            outcomes.push(outcome);
        }
    }
    Ok(ChaosReport {
        injected: outcomes.iter().filter(|o| o.injected).count() as u64,
        broken: outcomes.iter().map(|o| o.broken.len() as u64).sum(),
        outcomes,
        lasted_s: start.elapsed().as_secs_f64(),
        interrupted: interrupted(),
    })
}
