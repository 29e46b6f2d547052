//! Results of a step: one array per quantity, written in place.

use core::ops::Range;

use observation::action::ACTION_LENGTH;

use crate::error::EnvironmentError;
use crate::rewards::EVENTS;

/// Shape of the arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Number of instances.
    pub instances: usize,
    /// Number of agents of an instance.
    pub agents: usize,
    /// Length of the observation of an agent: that of the longest one; others end with zeros.
    pub observation: usize,
}

impl Shape {
    /// Returns the number of elements of the actions: (instances, agents, 2).
    pub fn actions(&self) -> usize {
        self.instances * self.agents * ACTION_LENGTH
    }

    /// Returns the shape of fewer instances.
    pub(crate) fn with_instances(self, instances: usize) -> Self {
        Self { instances, ..self }
    }
}

macro_rules! arrays {
    ($($(#[$doc:meta])* $name:ident: $type:ty = $width:expr;)*) => {
        /// Results of all instances. Their dimensions are given in brackets; the first one is the instance.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Arrays {
            $($(#[$doc])* pub $name: Vec<$type>,)*
        }

        /// Borrowed [`Arrays`], for callers that own the memory.
        #[derive(Debug)]
        pub struct ArraysMut<'a> {
            $($(#[$doc])* pub $name: &'a mut [$type],)*
        }

        impl Arrays {
            /// Allocates arrays of zeros.
            pub fn new(shape: Shape) -> Self {
                Self {
                    $($name: vec![<$type>::default(); shape.instances * $width(&shape)],)*
                }
            }

            /// Borrows the arrays.
            pub fn as_mut(&mut self) -> ArraysMut<'_> {
                ArraysMut { $($name: &mut self.$name,)* }
            }
        }

        impl ArraysMut<'_> {
            /// Checks the lengths.
            pub(crate) fn check(&self, shape: &Shape) -> Result<(), EnvironmentError> {
                $({
                    let (given, expected) = (self.$name.len(), shape.instances * $width(shape));
                    if given != expected {
                        return Err(EnvironmentError::Length { array: stringify!($name), given, expected });
                    }
                })*
                Ok(())
            }

            /// Borrows the rows of an instance.
            pub(crate) fn row(&mut self, instance: usize, shape: &Shape) -> ArraysMut<'_> {
                ArraysMut {
                    $($name: {
                        let width = $width(shape);
                        &mut self.$name[instance * width..(instance + 1) * width]
                    },)*
                }
            }

            /// Copies the rows of the instances in `range` from arrays that contain only these.
            pub(crate) fn copy_from(&mut self, range: &Range<usize>, from: &Arrays, shape: &Shape) {
                $({
                    let width = $width(shape);
                    self.$name[range.start * width..range.end * width].copy_from_slice(&from.$name);
                })*
            }
        }
    };
}

arrays! {
    /// Observations after the step; where the step has begun an episode, its first ones (agents, observation).
    observations: f32 = |s: &Shape| s.agents * s.observation;
    /// Last observations of an episode whose end began the next one in the same step; unchanged otherwise (agents,
    /// observation).
    final_observations: f32 = |s: &Shape| s.agents * s.observation;
    /// Rewards of the step (agents).
    rewards: f64 = |s: &Shape| s.agents;
    /// Sum of the rewards of all agents in the step.
    reward_sums: f64 = |_: &Shape| 1;
    /// Numbers of events in the step, in the order of [`EVENT_NAMES`](crate::EVENT_NAMES) (agents, 6).
    events: f32 = |s: &Shape| s.agents * EVENTS;
    /// Status of the agents at the end of the step, before a reset: 0 active, 1 caught, 2 escaped, 3 arrived, 4 timed
    /// out (agents).
    statuses: u8 = |s: &Shape| s.agents;
    /// `true` if the episode ended in the step: the mission is decided, or no agent is in the game.
    terminated: bool = |_: &Shape| 1;
    /// `true` if the time limit of the rules ended the episode.
    truncated: bool = |_: &Shape| 1;
    /// Sums of the rewards of the episode, up to and including the step (agents).
    returns: f64 = |s: &Shape| s.agents;
    /// Number of steps of the episode, up to and including this one.
    lengths: u64 = |_: &Shape| 1;
    /// Seed of the running episode, that of a scenario.
    seeds: u64 = |_: &Shape| 1;
}
