//! Environments as a learner uses them.

use std::sync::Arc;

use environment::{Arrays, Environments, Options};
use scenario::{Loader, MapCache, Template};

/// A scenario with these overrides.
pub fn template(name: &str, overrides: &[&str]) -> Template {
    let mut draft = Loader::new(kinds::KINDS).draft(name).unwrap();
    for argument in overrides {
        draft.apply("--set", argument);
    }
    draft.template(&mut MapCache::default()).unwrap()
}

/// Environments of a scenario, and their arrays.
pub struct Learner {
    pub environments: Environments,
    pub arrays: Arrays,
    random: u32,
}

impl Learner {
    pub fn new(template: Template, options: Options) -> Self {
        let environments = Environments::new(template, options, Arc::default()).unwrap();
        let arrays = Arrays::new(environments.shape());
        Self {
            environments,
            arrays,
            random: 1,
        }
    }

    pub fn reset(&mut self, seed: Option<u64>) {
        self.environments
            .reset(seed, &mut self.arrays.as_mut())
            .unwrap();
    }

    /// Does a step with random actions, which lead forward.
    pub fn step(&mut self) {
        let mut number = || {
            self.random = self
                .random
                .wrapping_mul(1_664_525)
                .wrapping_add(1_013_904_223);
            (self.random >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let actions = 0..self.environments.shape().actions();
        let actions: Vec<f32> = actions
            .map(|k| {
                if k % 2 == 0 {
                    0.7 + 0.3 * number()
                } else {
                    number()
                }
            })
            .collect();
        self.environments
            .step(&actions, &mut self.arrays.as_mut())
            .unwrap();
    }
}

/// Options with these agents and observations.
pub fn options(agents: &[&str], observation: &str) -> Options {
    Options {
        agents: agents.iter().map(|&name| name.to_owned()).collect(),
        observation: observation.parse().unwrap(),
        ..Options::default()
    }
}
