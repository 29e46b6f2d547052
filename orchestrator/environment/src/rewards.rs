//! Events of agents, and rewards from them.

use robot::team::Team;
use sim_backend::world::{ContactWith, EventKind, World};

use crate::error::EnvironmentError;

/// Number of kinds of events.
pub const EVENTS: usize = 6;

/// Names of the events, in the order of [`Arrays::events`](crate::Arrays::events).
pub const EVENT_NAMES: [&str; EVENTS] =
    ["escape", "caught", "capture", "lost", "arrival", "contact"];

/// Weights of the rewards. The reward of an agent in a step is the sum of its events times their weights, `time` times the
/// length of the step (s) while it is in the game, and `progress` times its progress (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RewardWeights {
    /// The agent reached an exit.
    pub escape: f64,
    /// A pursuer caught the agent.
    pub caught: f64,
    /// An evader that is hostile to the agent was caught, by whichever pursuer.
    pub capture: f64,
    /// An evader that is hostile to the agent reached an exit.
    pub lost: f64,
    /// The agent reached its goal.
    pub arrival: f64,
    /// The agent began to touch an obstacle or a robot.
    pub contact: f64,
    /// A second in the game (1/s).
    pub time: f64,
    /// A metre by which the shortest way to the agent's goal, or that of an evader without one to an exit, became shorter
    /// (1/m). It is 0 for a step before or after which there is no such way, or the agent is out of the game.
    pub progress: f64,
}

impl Default for RewardWeights {
    /// 1 for what the rules call success, −1 for the opponents' success, 0 for contacts, time and progress.
    fn default() -> Self {
        Self {
            escape: 1.0,
            caught: -1.0,
            capture: 1.0,
            lost: -1.0,
            arrival: 1.0,
            contact: 0.0,
            time: 0.0,
            progress: 0.0,
        }
    }
}

impl RewardWeights {
    /// Returns the weights of the events, in the order of [`EVENT_NAMES`].
    fn of_events(&self) -> [f64; EVENTS] {
        [
            self.escape,
            self.caught,
            self.capture,
            self.lost,
            self.arrival,
            self.contact,
        ]
    }

    /// Returns the reward of an agent in a step of `dt` (s).
    pub(crate) fn reward(&self, events: &[f32; EVENTS], was_active: bool, dt: f64) -> f64 {
        let weights = self.of_events();
        let events = events.iter().zip(weights);
        let sum: f64 = events
            .map(|(&count, weight)| f64::from(count) * weight)
            .sum();
        sum + if was_active { self.time * dt } else { 0.0 }
    }

    pub(crate) fn check(&self) -> Result<(), EnvironmentError> {
        let weights = self
            .of_events()
            .into_iter()
            .chain([self.time, self.progress]);
        let names = EVENT_NAMES.into_iter().chain(["time", "progress"]);
        for (option, weight) in names.zip(weights) {
            if !weight.is_finite() {
                return Err(EnvironmentError::Option {
                    option,
                    given: weight.to_string(),
                    expected: "a finite number",
                });
            }
        }
        Ok(())
    }
}

/// Adds the events of the last step of a world to the counts of an agent.
pub fn count(world: &World, robot: usize, team: Team, counts: &mut [f32; EVENTS]) {
    let robots = world.robots();
    let is_hostile = |other: usize| {
        let other = robots.get(other);
        other.is_some_and(|other| other.team.is_hostile_to(team))
    };
    let [escape, caught, capture, lost, arrival, contact] = counts;
    for event in world.events() {
        let counted = match event.kind {
            EventKind::Escaped { robot: other, .. } if other == robot => &mut *escape,
            EventKind::Escaped { robot: other, .. } if is_hostile(other) => &mut *lost,
            EventKind::Captured { evader, .. } if evader == robot => &mut *caught,
            EventKind::Captured { evader, .. } if is_hostile(evader) => &mut *capture,
            EventKind::Arrived { robot: other } if other == robot => &mut *arrival,
            EventKind::ContactBegan { robot: first, with }
                if first == robot || with == ContactWith::Robot(robot) =>
            {
                &mut *contact
            }
            _ => continue,
        };
        *counted += 1.0;
    }
}
