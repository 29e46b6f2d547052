//! What happens in a world.

use core::time::Duration;

use geometry::map::ObstacleId;

/// Something that happened, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldEvent {
    /// Simulated time: the end of the step in which it happened.
    pub time: Duration,
    /// Number of that step, from 1; 0 before the first.
    pub tick: u64,
    /// What happened.
    pub kind: EventKind,
}

/// What happened. Robots are named by their index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind {
    /// Police caught an evader.
    Captured {
        /// The evader.
        evader: usize,
        /// The nearest Police robot (of equally near ones the first) within the radius.
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
    /// A robot came to touch something.
    ContactBegan {
        /// The robot; of two robots the one with the lower index.
        robot: usize,
        /// What it touches.
        with: ContactWith,
    },
    /// A robot no longer touches something.
    ContactEnded {
        /// The robot; of two robots the one with the lower index.
        robot: usize,
        /// What it touched.
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
        /// What it did.
        action: ObstacleAction,
        /// The map's revision since.
        revision: u64,
    },
    /// An obstacle came to stand on a robot and pushed it aside.
    PushedOut {
        /// The robot.
        robot: usize,
        /// How far it was pushed (m).
        distance: f64,
    },
    /// An obstacle came to stand on a robot, and no place near was free: the robot cannot move.
    Trapped {
        /// The robot.
        robot: usize,
    },
    /// A trapped robot is free again.
    Released {
        /// The robot.
        robot: usize,
    },
    /// The mission is over.
    GameOver {
        /// Why.
        reason: GameOver,
    },
}

/// What a robot touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactWith {
    /// An obstacle or the edge of the map.
    Wall,
    /// The robot with this index.
    Robot(usize),
}

/// What an obstacle did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObstacleAction {
    /// It appeared.
    Appeared,
    /// It disappeared.
    Disappeared,
    /// It moved.
    Moved,
}

/// Why a mission is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GameOver {
    /// Every evader is caught or gone, and every robot with a goal has arrived.
    Decided,
    /// The time limit.
    TimeLimit,
}
