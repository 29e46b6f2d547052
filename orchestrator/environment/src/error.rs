//! Errors of environments.

use config::Diagnostics;
use mission::MissionError;
use mission::in_process::placement::PlacementError;
use observation::error::{LayoutError, WriteError};
use planner_view::of_world::OfWorldError;
use sim_backend::world::WorldError;

/// Error of environments.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// An option is out of its range.
    #[error("{option} = {given}: expected {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its value.
        given: String,
        /// Accepted values.
        expected: &'static str,
    },
    /// A name of the agents means no robots.
    #[error("agents: {0}")]
    Agents(#[from] PlacementError),
    /// An agent has no such observation.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// No agent has a way to make progress on.
    #[error("reward progress: expected an agent with a goal, or an evader and an exit")]
    NoWay,
    /// No process makes the beliefs of an observation.
    #[error(
        "observation belief: no process of the scenario makes beliefs: expected one of kind perception"
    )]
    NoBeliefs,
    /// The process of an agent has a period or links, in whose place a learner steps in every tick and sees the world.
    #[error("process {0} of an agent: expected neither `period` nor [[links]] from or to it")]
    Linked(String),
    /// A seed has no valid scenario.
    #[error("{0}")]
    Scenario(#[from] Diagnostics),
    /// A world cannot be built.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A process of the scenario failed.
    #[error(transparent)]
    Mission(#[from] MissionError),
    /// A map has no ways.
    #[error(transparent)]
    Map(#[from] OfWorldError),
    /// An observation cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A variant of the scenario does not fit to the arrays or to the threads.
    #[error("other values of the scenario change {0}: expected new environments with these values")]
    Fixed(&'static str),
    /// An array has another length than the shape.
    #[error("{array} has {given} elements: expected {expected}")]
    Length {
        /// Name of the array.
        array: &'static str,
        /// Its length.
        given: usize,
        /// Length of the shape.
        expected: usize,
    },
    /// An action is not finite.
    #[error("actions of instance {instance}: {given}: expected finite numbers")]
    Action {
        /// Index of the instance.
        instance: usize,
        /// The number.
        given: f32,
    },
    /// There are no episodes before the first reset, nor after an error.
    #[error("the environments are not reset: expected a reset of all instances first")]
    NotReset,
    /// [`Environments::interruption`](crate::Environments::interruption) ended a reset or a step.
    #[error("the environments were interrupted: expected a reset of all instances")]
    Interrupted,
    /// The instance does not exist.
    #[error("instance {given}: expected an index below {instances}")]
    Instance {
        /// The index.
        given: usize,
        /// Number of instances.
        instances: usize,
    },
    /// The episode of an instance has ended, and no reset has begun the next one.
    #[error("instance {instance}: its episode has ended: expected a reset")]
    Ended {
        /// Index of the instance.
        instance: usize,
    },
    /// The environments record no actions.
    #[error("the environments record no actions (record = false): expected environments that do")]
    NotRecorded,
    /// The instance has completed no episode yet.
    #[error("instance {instance} has completed no episode: expected the running one")]
    NoEpisode {
        /// The index.
        instance: usize,
    },
    /// A forked process has no threads of the environments.
    #[error(
        "the environments were made in another process: expected environments made in the process that uses them"
    )]
    OtherProcess,
    /// A thread cannot be started, or ended unexpectedly.
    #[error("a thread of the environments {0}")]
    Thread(String),
}

impl EnvironmentError {
    /// Returns `true` if the caller asked for something invalid, `false` if a run failed.
    pub fn is_refusal(&self) -> bool {
        match self {
            Self::Mission(error) => error.is_refusal(),
            Self::World(_)
            | Self::Write(_)
            | Self::Interrupted
            | Self::OtherProcess
            | Self::Thread(_) => false,
            _ => true,
        }
    }
}
