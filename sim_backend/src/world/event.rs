//! Events of a world.

use core::time::Duration;

use geometry::map::ObstacleId;

/// An event with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldEvent {
    /// Simulated time: the end of the step of the event.
    pub time: Duration,
    /// Number of that step, from 1; 0 before the first.
    pub tick: u64,
    /// Kind of event.
    pub kind: EventKind,
}

/// Kind of event. Robots are given by their index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind {
    /// A pursuer caught an evader.
    Captured {
        /// The evader.
        evader: usize,
        /// The nearest hostile pursuer (of equally near ones the first) within the radius.
        by: usize,
        /// Distance of their centres (m).
        distance: f64,
    },
    /// An evader reached an exit.
    Escaped {
        /// The evader.
        robot: usize,
        /// Index of the exit in [`World::exits`](super::World::exits).
        exit: usize,
    },
    /// A robot reached its goal.
    Arrived {
        /// The robot.
        robot: usize,
    },
    /// An evader or a robot with a goal ran out of time.
    TimedOut {
        /// The robot.
        robot: usize,
    },
    /// A robot began to touch an obstacle or robot.
    ContactBegan {
        /// The robot; of two robots the one with the lower index.
        robot: usize,
        /// Other side of the contact.
        with: ContactWith,
    },
    /// A robot no longer touches an obstacle or robot.
    ContactEnded {
        /// The robot; of two robots the one with the lower index.
        robot: usize,
        /// Other side of the contact.
        with: ContactWith,
    },
    /// A command was not finite and the robot was stopped; reported once until a valid one comes.
    InvalidCommand {
        /// The robot.
        robot: usize,
    },
    /// An obstacle appeared, disappeared or moved.
    ObstacleApplied {
        /// The obstacle.
        id: ObstacleId,
        /// Action of the obstacle.
        action: ObstacleAction,
        /// Revision of the map after it.
        revision: u64,
    },
    /// An obstacle appeared on a robot and pushed it aside.
    PushedOut {
        /// The robot.
        robot: usize,
        /// Distance of the push (m).
        distance: f64,
    },
    /// An obstacle appeared on a robot without a free place nearby: the robot cannot move.
    Trapped {
        /// The robot.
        robot: usize,
    },
    /// A trapped robot is free again.
    Released {
        /// The robot.
        robot: usize,
    },
    /// A robot that has not arrived at its goal has stood for
    /// [`STANDSTILL`](super::STANDSTILL); reported once per standstill.
    Stands {
        /// The robot.
        robot: usize,
        /// Duration of the standstill (s).
        seconds: f64,
    },
    /// The mission has ended.
    GameOver {
        /// Reason.
        reason: GameOver,
    },
}

/// Other side of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactWith {
    /// An obstacle or the edge of the map.
    Wall,
    /// The robot with this index.
    Robot(usize),
}

/// Action of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObstacleAction {
    /// It appeared.
    Appeared,
    /// It disappeared.
    Disappeared,
    /// It moved.
    Moved,
}

/// Reason for the end of a mission.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GameOver {
    /// Every evader is caught or gone, and every robot with a goal has arrived.
    Decided,
    /// The time limit was reached.
    TimeLimit,
}
