//! Turn rates that differ from run to run, each by one rule of `docs/reference/determinism.md` that it breaks.

use std::time::SystemTime;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Terms of a sum, and threads that add up parts of a longer one.
const TERMS: u32 = 64;
/// Terms that a thread adds up: long enough to be interrupted, also where all threads share a core.
const PART: u32 = 1000;

/// Broken rule.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Breach {
    /// No rule is broken: the checks have nothing to find.
    #[default]
    None,
    /// A clock of the machine.
    Clock,
    /// Iteration over a hash map, whose order another process does not have.
    HashMap,
    /// The sine of the C library, which picks a variant by processor.
    NativeSine,
    /// A sum of partial sums in the order in which threads finish.
    ThreadOrder,
}

impl Breach {
    /// Returns a turn rate (rad/s) below 1 in absolute value. Scaled by powers of two, so that the last bit of a sum
    /// stays.
    pub fn turn_rate(self, time_s: f64) -> f64 {
        match self {
            Self::None => terms().sum::<f64>() / 16.0,
            Self::Clock => {
                let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
                f64::from(since.unwrap_or_default().subsec_nanos()) / (1_u64 << 32) as f64
            }
            Self::HashMap => sum_of_hash_map() / 16.0,
            Self::NativeSine => sum_of_native_sines(time_s) / f64::from(TERMS),
            Self::ThreadOrder => sum_of_threads() / 16.0,
        }
    }
}

/// Numbers whose sum depends on the order in its last bits.
fn terms() -> impl Iterator<Item = f64> {
    (1..=TERMS).map(|k| 1.0 / f64::from(k))
}

#[allow(clippy::disallowed_types, reason = "the rule to be broken")]
fn sum_of_hash_map() -> f64 {
    let map: std::collections::HashMap<usize, f64> = terms().enumerate().collect();
    map.values().sum()
}

#[allow(clippy::disallowed_methods, reason = "the rule to be broken")]
fn sum_of_native_sines(time_s: f64) -> f64 {
    (1..=TERMS).map(|k| (f64::from(k) * time_s).sin()).sum()
}

fn sum_of_threads() -> f64 {
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        for thread in 0..TERMS {
            let sender = sender.clone();
            let part = thread * PART + 1..=(thread + 1) * PART;
            scope.spawn(move || sender.send(part.map(|k| 1.0 / f64::from(k)).sum::<f64>()));
        }
        drop(sender);
        receiver.iter().sum()
    })
}
