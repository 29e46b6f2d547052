//! Record of an episode.

use std::sync::Arc;

use geometry::pose::Twist2;
use observation::action::ACTION_LENGTH;

use crate::shared::SharedData;

/// An episode as it can be executed again.
#[derive(Debug, Clone)]
pub struct Episode {
    pub(crate) shared: Arc<SharedData>,
    /// Seed of the scenario.
    pub seed: u64,
    /// Actions of all steps: steps × agents × 2 numbers; 0 of agents out of the game.
    pub actions: Vec<f32>,
    /// Commands of all steps, if actions change controllers, whose commands depend on the state: steps × agents.
    pub commands: Vec<Twist2>,
    /// Number of steps.
    pub steps: u64,
}

/// One of the two recorded episodes of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhichEpisode {
    /// The last one that ended.
    Last,
    /// The running one, up to now.
    Running,
}

impl Episode {
    pub(crate) fn new(shared: &Arc<SharedData>, seed: u64) -> Self {
        Self {
            shared: Arc::clone(shared),
            seed,
            actions: Vec::new(),
            commands: Vec::new(),
            steps: 0,
        }
    }

    /// Begins a new episode in the memory of this one.
    pub(crate) fn begin(&mut self, shared: &Arc<SharedData>, seed: u64) {
        self.shared.clone_from(shared);
        self.seed = seed;
        self.actions.clear();
        self.commands.clear();
        self.steps = 0;
    }

    /// Records the actions of a step, if it shall; `is_active` is whether the agents are in the game.
    pub(crate) fn record(&mut self, actions: &[f32], is_active: &[bool]) {
        self.steps += 1;
        if !self.shared.options.record {
            return;
        }
        let (actions, _) = actions.as_chunks::<ACTION_LENGTH>();
        let recorded = actions.iter().zip(is_active).map(|(&action, &is_active)| {
            if is_active {
                action
            } else {
                [0.0; ACTION_LENGTH]
            }
        });
        self.actions.extend(recorded.flatten());
    }
}
