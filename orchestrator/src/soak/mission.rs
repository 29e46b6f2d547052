//! What one mission of a soak held, and what it left.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::watch::{Held, Seen};
use crate::census;
use crate::mission::spaces::{self, Found};
use crate::scenario::kinds::{KINDS, find};
use crate::scenario::{Program, ResolvedScenario};
use crate::statistics::Spread;

/// Name under which the orchestrator's own figures stand.
pub const ORCHESTRATOR: &str = "orchestrator";

/// Samples of a process from which on its life has quarters to speak of.
const ENOUGH: usize = 40;

/// How long what is on its way out may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// What a process held during a mission.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Use {
    /// Times it was looked at.
    pub samples: usize,
    /// Memory of its own when time had ended; in the middle of what was seen of a process that was
    /// gone by then [bytes].
    pub memory_bytes: u64,
    /// Most descriptors.
    pub descriptors: u64,
    /// Its memory in the second, third and last quarter of its life (medians) [bytes]; absent if it did
    /// not run for long, or remembers what it saw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quarters_bytes: Option<[u64; 3]>,
}

/// A mission.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mission {
    /// Name of its scenario.
    pub scenario: String,
    /// Its seed.
    pub seed: u64,
    /// Real time from the beginning of the soak to its own [s].
    pub begun_s: f64,
    /// Real time that it took [s].
    pub lasted_s: f64,
    /// What every process held, and the orchestrator after the mission.
    pub processes: BTreeMap<String, Use>,
    /// Most pieces of shared memory at once.
    pub segments: u64,
    /// Processes, shared memory and directories that it left behind.
    pub leftovers: Vec<String>,
    /// What went wrong, if anything did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Mission {
    /// A mission that has just ended.
    pub(super) fn new(
        scenario: &ResolvedScenario,
        begun_s: f64,
        ended_s: f64,
        seen: Seen,
        failure: Option<String>,
    ) -> Self {
        let leftovers = leftovers(&seen.roots);
        let mut processes: BTreeMap<String, Use> = seen
            .processes
            .into_iter()
            .map(|(name, held)| {
                let at_end = seen.at_end.get(&name).copied();
                let mut held = Use::of(&held, at_end);
                held.quarters_bytes.take_if(|_| remembers(scenario, &name));
                (name, held)
            })
            .collect();
        // What has been seen of the mission is not its own, nor what looking at it took.
        if let Ok(us) = census::member(std::process::id() as i32) {
            let now = Use {
                samples: 1,
                memory_bytes: us.memory_bytes,
                descriptors: us.descriptors,
                quarters_bytes: None,
            };
            processes.insert(ORCHESTRATOR.to_owned(), now);
        }
        Self {
            scenario: scenario.name.clone(),
            seed: scenario.run.seed,
            begun_s,
            lasted_s: ended_s - begun_s,
            processes,
            segments: seen.segments,
            leftovers,
            failure,
        }
    }
}

impl Use {
    pub(super) fn of(held: &Held, at_end: Option<u64>) -> Self {
        let samples = held.memory.len();
        let quarter = |number: usize| {
            let part = samples * number / 4..samples * (number + 1) / 4;
            middle(held.memory.get(part).unwrap_or_default())
        };
        Self {
            samples,
            memory_bytes: at_end.unwrap_or_else(|| middle(&held.memory)),
            descriptors: held.descriptors.iter().copied().max().unwrap_or(0),
            quarters_bytes: (samples >= ENOUGH).then(|| [quarter(1), quarter(2), quarter(3)]),
        }
    }
}

/// Whether the memory of a process rises by what it is for.
fn remembers(scenario: &ResolvedScenario, name: &str) -> bool {
    let spec = scenario.processes.iter().find(|p| p.name == name);
    spec.is_some_and(|spec| match &spec.program {
        Program::Kind(kind) => find(KINDS, kind).is_some_and(|kind| kind.remembers),
        Program::Command(_) => false,
    })
}

/// The median; 0 without values.
fn middle(values: &[u64]) -> u64 {
    Spread::of(values.iter().map(|&v| v as f64)).map_or(0, |s| s.median as u64)
}

/// What is left of a mission that has ended: nothing, as it should be.
fn leftovers(roots: &BTreeSet<PathBuf>) -> Vec<String> {
    let deadline = Instant::now() + PATIENCE;
    loop {
        let mut left = Vec::new();
        for root in roots {
            for member in census::members_of(root).unwrap_or_default() {
                left.push(format!("process {} ({})", member.name, member.pid));
            }
            for segment in census::segments_of(root).unwrap_or_default() {
                left.push(format!("/dev/shm/{segment}"));
            }
            if root.exists() {
                left.push(root.display().to_string());
            }
        }
        if left.is_empty() || Instant::now() >= deadline {
            for found in spaces::clean().unwrap_or_default() {
                if let Found::Removed { root, .. } | Found::Failed(root, _) = found {
                    let name = root.display().to_string();
                    if !left.contains(&name) {
                        left.push(name);
                    }
                }
            }
            return left;
        }
        // Whoever is killed at the end may take a moment to go.
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(memory: impl Iterator<Item = u64>) -> Held {
        let memory: Vec<u64> = memory.collect();
        Held {
            descriptors: vec![7; memory.len()],
            memory,
        }
    }

    #[test]
    fn what_grows_while_it_runs_is_told_from_what_warms_up() {
        // Warm after the first quarter.
        let warm = held((0..40).map(|i| if i < 8 { i * 1000 } else { 10_000 }));
        assert_eq!(
            Use::of(&warm, None).quarters_bytes,
            Some([10_000, 10_000, 10_000])
        );
        let grows = held((0..40).map(|i| 10_000 + i * 1000));
        assert_eq!(
            Use::of(&grows, None).quarters_bytes,
            Some([24_500, 34_500, 44_500])
        );
        assert_eq!(Use::of(&grows, None).memory_bytes, 29_500);
        assert_eq!(Use::of(&grows, Some(49_000)).memory_bytes, 49_000);
        assert_eq!(Use::of(&grows, None).descriptors, 7);
    }

    #[test]
    fn of_a_short_life_nothing_is_said() {
        let short = held((0..39).map(|i| i * 1000));
        assert_eq!(Use::of(&short, None).quarters_bytes, None);
        assert_eq!(Use::of(&Held::default(), None).memory_bytes, 0);
    }
}
