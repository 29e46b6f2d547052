//! Missions back to back for a long time, watched for what grows: memory, descriptors, shared
//! memory, things left behind.
//!
//! * [`watch`]: looks at the processes of a mission while it runs;
//! * [`mission`]: what one mission held and what it left;
//! * [`growth`]: whether what was held grew from mission to mission;
//! * [`table`], [`picture`]: what a person sees of it;
//! * [`rows`]: what programs see of it, and from which it can be judged again.

pub mod growth;
pub mod mission;
pub mod picture;
pub mod rows;
pub mod table;
pub mod watch;

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use serde::Serialize;

use crate::mission::{self as flight, MissionOptions};
use crate::scenario::ResolvedScenario;
use growth::Growth;
use mission::Mission;
use rows::RowWriter;

/// What is soaked, and for how long.
#[derive(Debug, Clone)]
pub struct SoakOptions {
    /// The missions, each with its seeds: the same ones come again and again, so that what they
    /// hold can be compared.
    pub missions: Vec<ResolvedScenario>,
    /// No mission begins after this time.
    pub duration: Duration,
    /// Seed of the order of the missions.
    pub seed: u64,
    /// Set from outside (Ctrl-C): the mission that is on ends, and what was seen is reported.
    pub interrupted: Arc<AtomicBool>,
}

/// What was seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SoakReport {
    /// Every mission, in order.
    pub missions: Vec<Mission>,
    /// What became of everything that was watched.
    pub growth: Vec<Growth>,
    /// Missions that did not end as they should, or whose history was not that of the same mission
    /// before.
    pub failures: u64,
    /// What missions left behind, in all.
    pub leftovers: u64,
    /// Real time from begin to end [s].
    pub lasted_s: f64,
    /// Whether it was ended from outside.
    pub interrupted: bool,
}

impl SoakReport {
    /// What became of everything in a row of missions, in order.
    pub fn of(missions: Vec<Mission>, lasted_s: f64, interrupted: bool) -> Self {
        Self {
            growth: growth::of(&missions),
            failures: missions.iter().filter(|m| m.failure.is_some()).count() as u64,
            leftovers: missions.iter().map(|m| m.leftovers.len() as u64).sum(),
            missions,
            lasted_s,
            interrupted,
        }
    }

    /// Whether nothing grew, nothing was left behind and every mission was as it should be.
    pub fn is_flat(&self) -> bool {
        self.failures == 0 && self.leftovers == 0 && !self.growth.iter().any(|g| g.grew)
    }
}

/// How a soak went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Real time from begin to end [s].
    pub lasted_s: f64,
    /// Whether it was ended from outside.
    pub interrupted: bool,
}

/// Runs missions until the time is over; what was seen of each goes to `rows` when it is done, and
/// `told` hears of it.
///
/// # Errors
/// If `rows` cannot be written; no further mission is begun then.
pub fn soak<W: Write>(
    options: &SoakOptions,
    rows: &mut RowWriter<W>,
    mut told: impl FnMut(&Mission),
) -> Result<Flight, csv::Error> {
    let start = Instant::now();
    let mut order = ChaCha8Rng::seed_from_u64(options.seed);
    let mut digests: BTreeMap<usize, String> = BTreeMap::new();
    let mut round: Vec<usize> = Vec::new();
    let interrupted = || options.interrupted.load(Ordering::SeqCst);
    while start.elapsed() < options.duration && !interrupted() && !options.missions.is_empty() {
        if round.is_empty() {
            round = shuffled(options.missions.len(), &mut order);
        }
        let Some((index, scenario)) = round
            .pop()
            .and_then(|index| Some((index, options.missions.get(index)?)))
        else {
            break;
        };
        let begun_s = start.elapsed().as_secs_f64();
        let watch = watch::Watch::start();
        let flown = flight::run(
            scenario,
            &MissionOptions {
                without_log: true,
                quiet: true,
                interrupted: Arc::clone(&options.interrupted),
                before_end: Some(watch.last_look()),
                ..MissionOptions::default()
            },
        );
        let seen = watch.end();
        if interrupted() {
            // Cut short: nothing to compare with the others.
            break;
        }
        let mut failure = flown.as_ref().err().map(ToString::to_string);
        if let Ok(report) = &flown
            && scenario.run.mode == crate::scenario::spec::Mode::LockStep
        {
            let digest = &report.summary.digest;
            let first = digests.entry(index).or_insert_with(|| digest.clone());
            if first != digest {
                failure = Some(format!("digest {digest}, but {first} the first time"));
            }
        }
        drop(flown);
        let mission = Mission::new(
            scenario,
            begun_s,
            start.elapsed().as_secs_f64(),
            seen,
            failure,
        );
        rows.add(&mission)?;
        told(&mission);
    }
    Ok(Flight {
        lasted_s: start.elapsed().as_secs_f64(),
        interrupted: interrupted(),
    })
}

/// The numbers below `count` in a random order: in every round each mission comes once.
fn shuffled(count: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let mut numbers: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        numbers.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_has_each_mission_once_and_the_seed_decides_the_order() {
        let order = |seed| shuffled(10, &mut ChaCha8Rng::seed_from_u64(seed));
        let mut sorted = order(1);
        sorted.sort_unstable();
        assert_eq!(sorted, (0..10).collect::<Vec<_>>());
        assert_eq!(order(1), order(1));
        assert_ne!(order(1), order(2));
    }
}
