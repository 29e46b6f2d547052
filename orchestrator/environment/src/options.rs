//! Options of environments.

use core::str::FromStr;
use std::collections::BTreeMap;

use observation::action::ActionKind;
use observation::parts::Parts;
use scenario::kind::ConfiguredKind;
use scenario::spec::MAX_TICKS;

use crate::error::EnvironmentError;
use crate::rewards::RewardWeights;

/// Maximum number of instances.
const MAX_INSTANCES: usize = 1 << 16;
/// Maximum number of threads.
const MAX_THREADS: usize = 1024;

/// Begin of the next episode after the end of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Autoreset {
    /// The next step begins the next episode, whatever its action.
    NextStep,
    /// The same step begins the next episode.
    #[default]
    SameStep,
    /// A reset must begin the next episode.
    Disabled,
}

impl FromStr for Autoreset {
    type Err = EnvironmentError;

    fn from_str(text: &str) -> Result<Self, EnvironmentError> {
        match text {
            "NextStep" => Ok(Self::NextStep),
            "SameStep" => Ok(Self::SameStep),
            "Disabled" => Ok(Self::Disabled),
            _ => Err(EnvironmentError::Option {
                option: "autoreset_mode",
                given: text.to_owned(),
                expected: "NextStep, SameStep or Disabled",
            }),
        }
    }
}

/// Options of environments.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Number of instances, 1 to 2^16; their observations have at most 2^26 numbers.
    pub instances: usize,
    /// Names of the robots, teams or processes that the learner steers; at least one.
    pub agents: Vec<String>,
    /// Contents of the observations.
    pub observation: Parts,
    /// Meaning of the actions.
    pub action: ActionKind,
    /// Seed of all episodes, if a reset does not give another one.
    pub seed: u64,
    /// Begin of the next episode after the end of one.
    pub autoreset: Autoreset,
    /// Number of ticks of a step, 1 to 10^8: the action holds, rewards and events add up, and the observation is that
    /// after the last tick.
    pub ticks_per_action: u32,
    /// Number of threads, 1 to 1024. Results do not depend on it.
    pub threads: usize,
    /// Weights of the rewards.
    pub rewards: RewardWeights,
    /// Records actions, so that episodes can be executed again.
    pub record: bool,
    /// Kinds that run in the place of external programs, by the name of the process.
    pub programs: BTreeMap<String, ConfiguredKind>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            instances: 1,
            agents: Vec::new(),
            observation: Parts {
                state: true,
                ..Parts::default()
            },
            action: ActionKind::default(),
            seed: 0,
            autoreset: Autoreset::default(),
            ticks_per_action: 1,
            threads: 1,
            rewards: RewardWeights::default(),
            record: true,
            programs: BTreeMap::new(),
        }
    }
}

impl Options {
    /// Checks the ranges.
    pub(crate) fn check(&self) -> Result<(), EnvironmentError> {
        let refused = |option, given: String, expected| EnvironmentError::Option {
            option,
            given,
            expected,
        };
        if !(1..=MAX_INSTANCES).contains(&self.instances) {
            let given = self.instances.to_string();
            return Err(refused("instances", given, "1 to 2^16"));
        }
        if !(1.0..=MAX_TICKS).contains(&f64::from(self.ticks_per_action)) {
            let given = self.ticks_per_action.to_string();
            return Err(refused("ticks_per_action", given, "1 to 10^8"));
        }
        if !(1..=MAX_THREADS).contains(&self.threads) {
            let given = self.threads.to_string();
            return Err(refused("threads", given, "1 to 1024"));
        }
        if self.agents.is_empty() {
            let expected = "names of robots, teams or processes";
            return Err(refused("agents", "[]".into(), expected));
        }
        self.rewards.check()
    }
}
